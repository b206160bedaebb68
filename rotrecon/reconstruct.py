"""The stages in their order: from a frame and a drawing to a measured solid and the tool that fits it."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Cloud, Floats, Indices, blocks
from rotrecon.axis import FittedAxis, SpaceSections, cut_in_space, fit_axis, span_along
from rotrecon.axis_proposal import propose_axis
from rotrecon.circles import SectionCircles, SectionState, base_points, circumcircles
from rotrecon.drawing import CrossSegments, Drawing, DrawingError, cut_sections
from rotrecon.frame import Frame
from rotrecon.outcome import Candidate, FailureReason, Fit, FitFailure
from rotrecon.primitives import Primitive
from rotrecon.radii import SHAPES, Shape, choose, fit_radii, rank
from rotrecon.section_fit import as_candidates, fit_solid, why_no_axis
from rotrecon.segmentation import Segmentation, segment
from rotrecon.settings import Settings
from rotrecon.tools import NoTool, Reading, ToolProposal, propose_tool
from rotrecon.workspace import available


@dataclass(frozen=True, eq=False)
class Cut:
    """The circles of one cut through the object, and the axis through their centres."""

    circles: SectionCircles
    axis: FittedAxis | None


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """Every intermediate of one reconstruction, so that whatever is shown computes nothing again.

    Camera coordinates, but for `solid` and `tool`. A stage that was not reached is None.
    """

    frame: Frame
    drawing: Drawing
    settings: Settings
    segments: CrossSegments
    segmentation: Segmentation
    first_cut: Cut
    """Through lines of pixels, as drawn (paper 3.1)."""
    fit: Fit | FitFailure
    sections: SpaceSections | None = None
    """The same pixels, sorted into sections perpendicular to the first axis in space."""
    second_cut: Cut | None = None
    candidates: tuple[Candidate, ...] = ()
    first_cut_radius_m: float | None = None
    """The radius that the first cut alone gives for the same kind of solid."""
    solid: Primitive | None = None
    """The fitted solid in base coordinates."""
    tool: ToolProposal | NoTool = NoTool(())


def reconstruct(frame: Frame, drawing: Drawing, settings: Settings) -> Reconstruction:
    """Measure the object that a drawing points at, by the paper's method.

    Raises DrawingError for a drawing that cannot be used on this frame; what the data cannot hold is a FitFailure.
    The drawing of the result has an axis, proposed where none was drawn.
    """
    drawing = _with_axis(frame, drawing, settings)
    segments = cut_sections(drawing.area, drawing.stroke, (frame.camera.width, frame.camera.height))
    segmentation = segment(*usable_depth(frame, segments), segments.inside, settings)
    first = _cut(*base_points(frame.points_m, segments.pixel, segmentation.kept), settings)
    reachable = bool(segmentation.history.any())
    result = Reconstruction(
        frame, drawing, settings, segments, segmentation, first, fit=why_no_axis(first.circles, reachable, settings)
    )
    if first.axis is None or len(first.circles.state) < settings.minimum_axis_px:
        return result
    pixel = segments.pixel[segmentation.kept]
    sections, settled = cut_until_settled(frame.points_m, pixel, first.circles, first.axis, settings)
    second = _without(settled, drawing.excluded_sections, settings)
    result = replace(result, sections=sections, second_cut=second, fit=why_no_axis(second.circles, True, settings))
    return result if second.axis is None else _with_solid(result, first, second, second.axis, sections)


def _with_axis(frame: Frame, drawing: Drawing, settings: Settings) -> Drawing:
    """The drawing with the axis that was drawn, or one that is proposed; DrawingError where nothing stands out."""
    if drawing.axis is not None:
        return drawing
    proposed = propose_axis(frame, drawing.area, settings)
    if isinstance(proposed, FitFailure):
        raise DrawingError(proposed.advice)
    return replace(drawing, axis=proposed)


def usable_depth(frame: Frame, segments: CrossSegments) -> tuple[Cloud, Bools]:
    """Depth (S, W) of every cell, and where it is known and within the arm's limits."""
    depth_m = frame.points_m.reshape(-1, 3)[segments.pixel, 2]
    usable = segments.inside & np.isfinite(depth_m)
    if not usable.any():
        raise DrawingError("the area holds no depth; draw it where the depth map has values")
    cloud_m = frame.points_m.reshape(-1, 3)
    usable[usable] = np.concatenate(
        [available(cloud_m[pixel], frame.T_base_camera, frame.workspace) for pixel in blocks(segments.pixel[usable])]
    )
    return depth_m, usable


def _cut(points_m: Floats, count: Indices, settings: Settings) -> Cut:
    """Circles through the base points (S, 3, 3) of sections, and their axis."""
    circles = circumcircles(points_m, count, settings)
    return Cut(circles, fit_axis(circles, settings))


def cut_until_settled(
    cloud_m: Cloud, pixel: Indices, first: SectionCircles, axis: FittedAxis, settings: Settings
) -> tuple[SpaceSections, Cut]:
    """Pixels (M,) of a cloud (H, W, 3) cut across an axis in space, and again while the axis so found still turns.

    As many sections as the `first` cut has, over the length that its circles cover. A cut tilted by t gives radii
    wrong by about t^2 / 2.
    """
    circles, cuts_left = first, settings.cuts_in_space
    while True:
        sections = cut_in_space(cloud_m, pixel, axis, span_along(axis, circles), len(first.state))
        cut, cuts_left = _cut(*sections.base_points(), settings), cuts_left - 1
        if cut.axis is None or cuts_left == 0 or axis.turn_to(cut.axis) < settings.axis_settled_rad:
            return sections, cut
        axis, circles = cut.axis, cut.circles


def _without(cut: Cut, excluded: frozenset[int], settings: Settings) -> Cut:
    """A cut less the sections that the operator took out: last, so that they keep the numbers he knows them by."""
    state = cut.circles.state.copy()
    numbers = [section for section in excluded if 0 <= section < len(state)]
    if not numbers:
        return cut
    state[numbers] = SectionState.EXCLUDED
    circles = replace(cut.circles, state=state)
    return Cut(circles, fit_axis(circles, settings))


def _with_solid(
    result: Reconstruction, first: Cut, second: Cut, axis: FittedAxis, sections: SpaceSections
) -> Reconstruction:
    """The reconstruction with its solid, or the reason why the kind asked for does not exist."""
    circles, settings, kind = second.circles, result.settings, result.drawing.kind
    along = axis.along(circles.center_m)
    curves = (fit_radii(shape, along, circles.radius_m, circles.used, settings) for shape in SHAPES)
    ranked = rank([curve for curve in curves if curve], along, circles.used, settings)
    result = replace(result, candidates=as_candidates(ranked))
    chosen = choose(ranked, kind, settings)
    if chosen is None:
        best = ranked[0].radii.shape
        advice = f"the sections speak for a {best} rather than a {kind}; choose that, or let the program decide"
        return replace(result, fit=FitFailure(FailureReason.NOT_THIS_KIND, advice))
    fit = fit_solid(chosen.radii, kind, axis, circles, sections, settings)
    if isinstance(fit, FitFailure):
        return replace(result, fit=fit)
    T_base_camera = result.frame.T_base_camera
    solid = fit.solid.moved(T_base_camera)
    return replace(
        result,
        fit=fit,
        first_cut_radius_m=_radius_from(first, chosen.radii.shape, settings),
        solid=solid,
        tool=_tool(fit, solid, T_base_camera[:3, 3], settings),
    )


def _tool(fit: Fit, solid: Primitive, camera_center_m: Floats, settings: Settings) -> ToolProposal | NoTool:
    """The tool for a solid in base coordinates; none for a size that is doubtful."""
    if fit.doubts:
        return NoTool(fit.doubts)
    return propose_tool((Reading(solid),), camera_center_m, fit.concave, settings.tools)


def _radius_from(cut: Cut, shape: Shape, settings: Settings) -> float | None:
    """The radius, at the middle of its length, that one cut alone gives for a shape."""
    assert cut.axis is not None
    along = cut.axis.along(cut.circles.center_m)
    radii = fit_radii(shape, along, cut.circles.radius_m, cut.circles.used, settings)
    return None if radii is None else radii.radius_at_middle(along)

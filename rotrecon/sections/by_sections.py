"""The paper's method: a solid from the circles of its sections (paper 3.3 to 3.5)."""

from dataclasses import replace

from rotrecon.arrays import Floats
from rotrecon.axis import FittedAxis, SpaceSections
from rotrecon.outcome import FailureReason, Fit, FitFailure
from rotrecon.reading import Reading
from rotrecon.reconstruction import Cut, Reconstruction
from rotrecon.sections.radii import SHAPES, Shape, choose, fit_radii, rank
from rotrecon.sections.section_cuts import cut_until_settled, without
from rotrecon.sections.section_fit import as_candidates, fit_solid, why_no_axis
from rotrecon.settings import Settings
from rotrecon.tools import NoTool, ToolProposal, propose_tool


def by_sections(segmented: Reconstruction) -> Reconstruction:
    """The reconstruction of a segmented object, with its solid or the reason why there is none."""
    first, settings, drawing = segmented.first_cut, segmented.settings, segmented.drawing
    if first.axis is None or len(first.circles.state) < settings.minimum_axis_px:
        return segmented
    pixel = segmented.segments.pixel[segmented.segmentation.kept]
    cloud_m = segmented.frame.points_m
    sections, settled = cut_until_settled(cloud_m, pixel, first.circles, first.axis, settings)
    second = without(settled, drawing.excluded_sections, settings)
    result = replace(segmented, sections=sections, second_cut=second, fit=why_no_axis(second.circles, True, settings))
    return result if second.axis is None else _with_solid(result, first, second, second.axis, sections)


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
    readings = (Reading(solid),)
    return replace(
        result,
        fit=fit,
        first_cut_radius_m=_radius_from(first, chosen.radii.shape, settings),
        solid=solid,
        tool=_tool(fit, readings, T_base_camera[:3, 3], result),
        readings=readings,
    )


def _tool(
    fit: Fit, readings: tuple[Reading, ...], camera_center_m: Floats, result: Reconstruction
) -> ToolProposal | NoTool:
    """The tool for a solid in base coordinates; none for a size that is doubtful."""
    if fit.doubts:
        return NoTool(fit.doubts)
    settings, place = result.settings, result.drawing.contact
    return propose_tool(readings, camera_center_m, fit.concave, settings.tools, place, settings.dangerous)


def _radius_from(cut: Cut, shape: Shape, settings: Settings) -> float | None:
    """The radius, at the middle of its length, that one cut alone gives for a shape."""
    assert cut.axis is not None
    along = cut.axis.along(cut.circles.center_m)
    radii = fit_radii(shape, along, cut.circles.radius_m, cut.circles.used, settings)
    return None if radii is None else radii.radius_at_middle(along)

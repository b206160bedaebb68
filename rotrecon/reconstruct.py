"""The stages in their order: from a frame and a drawing to a measured solid and the tool that fits it."""

from dataclasses import replace

import numpy as np
from threadpoolctl import ThreadpoolController  # pyright: ignore[reportMissingTypeStubs]

from rotrecon.arrays import Bools, Cloud, blocks
from rotrecon.by_rays import by_rays
from rotrecon.calibration import with_calibration_error
from rotrecon.circles import base_points
from rotrecon.drawing import CrossSegments, Drawing, DrawingError, cut_sections
from rotrecon.frame import Frame
from rotrecon.outcome import Fit, FitFailure, Intervals
from rotrecon.primitives import Frustum, Primitive
from rotrecon.rays.patch import clear_depth
from rotrecon.reconstruction import Reconstruction
from rotrecon.sections.by_sections import by_sections
from rotrecon.sections.section_cuts import cut
from rotrecon.sections.section_fit import why_no_axis
from rotrecon.segmentation import segment
from rotrecon.settings import Settings
from rotrecon.stroke.axis_proposal import propose_axis
from rotrecon.stroke.correction import corrected
from rotrecon.workspace import available

THREADS = ThreadpoolController()
MUCH_LESS_SURE = 2.5
"""Width of a size's interval, over that of a first measurement, with which a second one is not believed."""


def reconstruct(frame: Frame, drawing: Drawing, settings: Settings) -> Reconstruction:
    """Measure the object that a drawing points at, by the method that the settings name.

    Raises DrawingError for a drawing that cannot be used on this frame; what the data cannot hold is a FitFailure.
    The drawing of the result has the axis that was measured along: the drawn one, or where it was careless that put
    right; one that is proposed where none was drawn.
    """
    drawing = _with_axis(frame, drawing, settings)
    result = _measured(frame, drawing, settings)
    if settings.method == "paper" or not isinstance(result.fit, Fit):
        return result
    stroke = corrected(drawing, result.fit, frame.camera)
    if stroke is None:
        return result
    again = _measured(frame, replace(drawing, axis=stroke), settings)
    return again if _bears_out(again, result.fit) else result


def _bears_out(again: Reconstruction, first: Fit) -> bool:
    """Whether a second measurement found the same kind of thing, and either doubts it no more or knows its size better.

    One that knows much less of its size has lost what the first rests on. Where several views have borne out the first,
    which then hardly hangs on the stroke, a second that is outside its interval has lost its way.
    """
    if not isinstance(again.fit, Fit) or again.fit.intervals is None or first.intervals is None:
        return False
    width, first_width = again.fit.intervals.relative_width, first.intervals.relative_width
    if width > MUCH_LESS_SURE * first_width or (len(again.fit.doubts) > len(first.doubts) and width > first_width):
        return False
    if again.frame.views and not _within(again.fit.solid, first.intervals):
        return False
    kinds = {again.fit.solid.kind, first.solid.kind}
    return len(kinds) == 1 or kinds == {"cylinder", "rod"}


def _within(solid: Primitive, intervals: Intervals) -> bool:
    """Whether the half angle of a cone, whose diameter hangs on where its middle is, or else the diameter is inside."""
    if isinstance(solid, Frustum) and intervals.half_angle_rad is not None:
        low, high = intervals.half_angle_rad
        return low <= solid.half_angle_rad <= high
    low, high = intervals.diameter_m
    return low <= 2 * float(solid.radius_at(0.0)) <= high


def _measured(frame: Frame, drawing: Drawing, settings: Settings) -> Reconstruction:
    """All stages along the stroke of a drawing."""
    segments = cut_sections(drawing.area, drawing.stroke, (frame.camera.width, frame.camera.height))
    depth_m, usable = usable_depth(frame, segments)
    if settings.method == "robust":
        depth_m = clear_depth(frame.depth_m, segments.pixel)
        usable &= np.isfinite(depth_m)
    segmentation = segment(depth_m, usable, segments.inside, settings)
    first = cut(*base_points(frame.points_m, segments.pixel, segmentation.kept), settings)
    why = why_no_axis(first.circles, bool(segmentation.history.any()), settings)
    segmented = Reconstruction(frame, drawing, settings, segments, segmentation, first, fit=why)
    if settings.method == "paper":
        return by_sections(segmented)
    # matrices of a few columns are multiplied sooner by one thread than shared out between several
    with THREADS.limit(limits=1, user_api="blas"):  # pyright: ignore[reportUnknownMemberType]
        return with_calibration_error(by_rays(segmented, depth_m))


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

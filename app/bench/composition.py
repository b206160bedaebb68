"""The paper's method put together anew from the program's own stages, so that one step can be replaced at a time."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from app.bench.least_squares import least_squares_circles
from rotrecon.arrays import Bools, Indices
from rotrecon.axis import Axis, FittedAxis, cut_in_space, fit_axis, span_along
from rotrecon.circles import SectionCircles, base_points, circumcircles
from rotrecon.drawing import Drawing, cut_sections
from rotrecon.frame import Frame
from rotrecon.reconstruct import usable_depth
from rotrecon.sections.radii import SHAPE_OF_KIND, axis_length_radius, fit_radii
from rotrecon.sections.section_cuts import cut_until_settled
from rotrecon.segmentation import segment
from rotrecon.settings import Settings

Mask = Callable[[Bools, Indices], Bools]
"""The object's pixels (S, W), from those that 3.2 keeps (S, W) and the index (S, W) of each pixel in the frame."""


@dataclass(frozen=True)
class Steps:
    """What takes the place of the paper's steps; left alone, it is the paper's method."""

    mask: Mask | None = None
    axis: Axis | None = None
    """For the second cut."""
    least_squares: bool = False
    """Circles of the second cut through all points of a section."""
    reject: bool = True
    """Drop centres and radii that deviate by more than the mean deviation."""


@dataclass(frozen=True)
class Radii:
    """The radius that each variant of the method gives; NaN where it gives none."""

    first_cut_m: float = np.nan
    second_cut_m: float = np.nan
    axis_length_m: float = np.nan
    """Equation (16), of a sphere."""


def compose(frame: Frame, drawing: Drawing, settings: Settings, steps: Steps) -> Radii:
    """The radii of an object whose kind the drawing names; with `Steps()` those that the paper's method finds."""
    pixel, kept = _object_pixels(frame, drawing, settings, steps)
    tolerance = settings if steps.reject else replace(settings, distance_floor_m=np.inf)
    first = circumcircles(*base_points(frame.points_m, pixel, kept), settings)
    first_axis = fit_axis(first, tolerance)
    if first_axis is None:
        return Radii()
    if steps.axis is None:
        sections, _ = cut_until_settled(frame.points_m, pixel[kept], first, first_axis, settings)
    else:
        ends_m = span_along(steps.axis, first)
        sections = cut_in_space(frame.points_m, pixel[kept], steps.axis, ends_m, len(first.state))
    second = circumcircles(*sections.base_points(), settings)
    if steps.least_squares:
        second = least_squares_circles(second, sections)
    second_axis = (
        fit_axis(second, tolerance)
        if steps.axis is None
        else FittedAxis(steps.axis.point_m, steps.axis.direction, second.used)
    )
    if second_axis is None:
        return Radii(_radius(first, first_axis, drawing, tolerance))
    return Radii(
        _radius(first, first_axis, drawing, tolerance),
        _radius(second, second_axis, drawing, tolerance),
        _axis_length(second, second_axis, drawing),
    )


def _object_pixels(frame: Frame, drawing: Drawing, settings: Settings, steps: Steps) -> tuple[Indices, Bools]:
    """Index (S, W) of the pixels of the cross segments, and which (S, W) are the object's."""
    segments = cut_sections(drawing.area, drawing.stroke, (frame.camera.width, frame.camera.height))
    depth_m, usable = usable_depth(frame, segments)
    kept = segment(depth_m, usable, segments.inside, settings).kept
    return segments.pixel, kept if steps.mask is None else steps.mask(kept, segments.pixel) & usable


def _radius(circles: SectionCircles, fitted: FittedAxis, drawing: Drawing, tolerance: Settings) -> float:
    assert drawing.kind is not None
    along = fitted.along(circles.center_m)
    radii = fit_radii(SHAPE_OF_KIND[drawing.kind], along, circles.radius_m, circles.used, tolerance)
    return np.nan if radii is None else radii.radius_at_middle(along)


def _axis_length(circles: SectionCircles, fitted: FittedAxis, drawing: Drawing) -> float:
    """Equation (16) over the centres that lie on the axis."""
    return axis_length_radius(circles.center_m[fitted.on_axis]) if drawing.kind == "sphere" else np.nan

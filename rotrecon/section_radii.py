"""The sections across a fitted axis, with the radius that the depths of each one speak for."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Cloud, Floats, Indices, freeze
from rotrecon.axis import Axis, SpaceSections, cut_in_space
from rotrecon.circles import SectionCircles, SectionState, circumcircles
from rotrecon.rays.ball import Ball
from rotrecon.rays.losses import MEDIAN_LOSS, TO_SIGMA
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import RayFit
from rotrecon.rays.surfaces import Surface
from rotrecon.settings import Settings
from rotrecon.turned.parts import Part, parts_of
from rotrecon.turned.profile import profile_of
from rotrecon.turned.turned import Turned

INNER = 0.85
"""Share of the radius within which depths say how far out a section's surface is; farther out they are flattened."""
ODD_WIDTHS = 1.3
"""Widths of its interval by which the radius of an odd section is off."""
ODD_RADIUS = 0.1
"""Share of the radius within which it is never odd."""


@dataclass(frozen=True, eq=False)
class SectionRadii:
    """S sections, their circles about the axis, and the limits of their radii."""

    sections: SpaceSections
    circles: SectionCircles
    heights_m: Floats
    """(S,) along the axis, from its point."""
    parts: tuple[Part, ...]
    """Consecutive cylinders, cones and spheres that the radii fall into; none of a ball."""
    low_m: Floats
    """(S,) 95 % limits of the radius; NaN where there is none."""
    high_m: Floats

    def __post_init__(self) -> None:
        freeze(self)

    def excluding(self, numbers: list[int]) -> "SectionRadii":
        """The same with sections that the operator took out."""
        state = self.circles.state.copy()
        state[numbers] = SectionState.EXCLUDED
        return replace(self, circles=replace(self.circles, state=state))


def section_radii(
    fit: RayFit, axis: Axis, patch: Patch, agreeing: Bools, cloud_m: Cloud, count: int, settings: Settings
) -> SectionRadii:
    """`count` sections through the pixels of a patch (N,) that agree with a fit; `cloud_m` (H, W, 3) is the frame's."""
    surface = fit.surface
    pixels = patch.frame_pixels(np.flatnonzero(agreeing).astype(np.int32))
    height = axis.along(cloud_m.reshape(-1, 3)[pixels].astype(np.float64))
    low, high = (float(end) for end in (height.min(), height.max()))
    margin = max((high - low) / (2 * count), 1e-6)
    sections = cut_in_space(cloud_m, pixels, axis, (low - margin, high + margin), count)
    heights: Floats = low - margin + (np.arange(count, dtype=np.float64) + 0.5) * sections.pitch_m
    shape_m = _shape(surface, heights)
    circles = circumcircles(*sections.base_points(), settings)
    radius, low_m, high_m, parts = _radii(sections, heights, shape_m, fit, patch, settings)
    state = circles.state.copy()
    state[state == SectionState.COLLINEAR] = SectionState.USED
    state[(state == SectionState.USED) & ~np.isfinite(radius)] = SectionState.TOO_FEW_PIXELS
    with np.errstate(invalid="ignore"):
        odd = np.abs(radius - shape_m) > np.maximum(ODD_WIDTHS * (high_m - low_m), ODD_RADIUS * shape_m)
    state[(state == SectionState.USED) & odd] = SectionState.ODD_RADIUS
    radius[state == SectionState.EMPTY] = np.nan
    circles = replace(circles, state=state, radius_m=radius, center_m=axis.point_m + heights[:, None] * axis.direction)
    return SectionRadii(sections, circles, heights, parts, low_m, high_m)


def _shape(surface: Surface, heights_m: Floats) -> Floats:
    """Radius (S,) of a surface at heights (S,) along its axis."""
    if isinstance(surface, Ball):
        return np.sqrt(np.maximum(surface.radius_m**2 - heights_m**2, 0.0))
    if isinstance(surface, Turned):
        return surface.curve(heights_m)[0]
    return surface.radius_m + surface.slope * heights_m


def _radii(
    sections: SpaceSections, heights: Floats, shape_m: Floats, fit: RayFit, patch: Patch, settings: Settings
) -> tuple[Floats, Floats, Floats, tuple[Part, ...]]:
    """Radii (S,) with their limits, and the parts they fall into."""
    if isinstance(fit.surface, Ball):
        radius, sigma = _distances(sections, shape_m, fit, settings.minimum_section_pixels)
        return radius, radius - 1.96 * sigma, radius + 1.96 * sigma, ()
    profile = profile_of(fit, patch, heights)
    return profile.radius_m.copy(), profile.low_m, profile.high_m, parts_of(profile)


def _distances(sections: SpaceSections, shape_m: Floats, fit: RayFit, fewest: int) -> tuple[Floats, Floats]:
    """Median distance (S,) of each section's inner points from the axis, and its standard deviation (S,)."""
    number: Indices = np.repeat(np.arange(len(shape_m), dtype=np.int32), np.diff(sections.start))
    place = sections.in_plane(sections.points_of(np.ones(len(shape_m), dtype=np.bool_)).astype(np.float64))
    inner = np.abs(place[:, 0]) < INNER * shape_m[number]
    number, distance = number[inner], np.hypot(place[inner, 0], place[inner, 1])
    count = np.bincount(number, minlength=len(shape_m)).astype(np.int32)
    radius = _medians(number, distance, count)
    sigma = _medians(number, np.abs(distance - radius[number]), count) * TO_SIGMA * MEDIAN_LOSS
    independent = np.maximum(count * np.sqrt(fit.likeness.independent_share), 1.0)
    few = count < fewest
    return np.where(few, np.nan, radius), np.where(few, np.nan, sigma / np.sqrt(independent))


def _medians(number: Indices, values: Floats, count: Indices) -> Floats:
    """Lower median (S,) of the values (n,) of each number, of which there are `count` (S,); NaN for none."""
    ordered = values[np.lexsort((values, number))]
    place = np.cumsum(count) - count + np.maximum(count - 1, 0) // 2
    return np.where(count > 0, np.append(ordered, np.nan)[np.minimum(place, len(ordered))], np.nan)

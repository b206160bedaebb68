"""Surfaces as they are drawn, at no known distance: where depth says little, the drawing still says where to look."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import CrossSegments
from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.limbs import OUTLINE_REACH, OUTLINE_SECTIONS, limbs_of
from rotrecon.rays.patch import Patch
from rotrecon.rays.surfaces import Surface, turn_of
from rotrecon.sections.radii import Shape

DRAWN_MARGIN_PX = 6.0
"""Distance of a drawn area from the outline: nobody draws closer."""
DRAWN_SHARE, DRAWN_PX = 0.12, 2.5
"""Half widths may be off the drawing's by this share or so many px before other starts are tried."""
WIDEST = 95.0
"""Percentile of the widths of something that stands for where it is widest."""
LONGEST_BALL = 1.5
"""Lengths of an area over its width, at most, of what may be a ball: a steady hand draws as long as wide."""
LEAST_HALF_WIDTH_PX = 3.0
"""Of what an area may be drawn round."""


def drawn(shape: Shape, patch: Patch, segments: CrossSegments, distance_m: float) -> Surface:
    """A cylinder, cone or sphere that fills the drawn area but for a margin, square to the line of sight."""
    rows, offset, half_px = _sections(segments)
    place = segments.origin_px + rows[:, None] * segments.along + offset[:, None] * segments.across
    if shape == "sphere":
        return _ball(patch, place, half_px, distance_m)
    slope = float(np.polyfit(rows, half_px, 1)[0])
    lean, middle = np.polyfit(rows, offset, 1)
    ends = segments.origin_px + rows[[0, -1], None] * segments.along
    ends = ends + (lean * rows[[0, -1]] + middle)[:, None] * segments.across
    start, end = patch.camera.unproject(ends, np.ones(2))
    center = (start + end) / 2
    center *= distance_m / np.linalg.norm(center)
    along = end / np.linalg.norm(end) - start / np.linalg.norm(start)
    along -= (along @ center) * center / distance_m**2
    radius_m = float(np.median(half_px)) / patch.focal_px * distance_m
    tapers = shape == "cone"
    turn = turn_of(along / np.linalg.norm(along), -center)
    return Lateral(center, turn, radius_m, slope if tapers else 0.0, patch.focal_px, tapers)


def may_be_ball(segments: CrossSegments) -> bool:
    """Whether what is drawn is not too long for a ball that is as wide."""
    rows, _, half_px = _sections(segments)
    return float(np.ptp(rows)) < LONGEST_BALL * 2 * float(half_px.max() + DRAWN_MARGIN_PX)


def as_wide_as_drawn(
    surface: Surface, camera: PinholeCamera, segments: CrossSegments, length_m: float, leeway: float
) -> bool:
    """Whether the outline of a surface, beside a stroke along `length_m` of it, is as wide as what is drawn.

    `leeway` is how many times the usual it may be off.
    """
    if isinstance(surface, Ball):
        part, seen_px = WIDEST, np.array([surface.radius_m / surface.center_m[2] * camera.focal_px])
    else:
        part, seen_px = 50.0, _half_outline_px(surface, camera, segments, length_m)
    if len(seen_px) == 0:
        return False
    drawn_px = float(np.percentile(_sections(segments)[2], part))
    return abs(float(np.median(seen_px)) - drawn_px) < leeway * max(DRAWN_SHARE * drawn_px, DRAWN_PX)


def _half_outline_px(surface: Lateral, camera: PinholeCamera, segments: CrossSegments, length_m: float) -> Floats:
    """Distances (n,) of the outline from the middle of it, beside the stroke."""
    heights_m = np.linspace(-OUTLINE_REACH, OUTLINE_REACH, OUTLINE_SECTIONS) * length_m
    limbs = limbs_of(surface, camera, heights_m)
    row = (limbs.point_px - segments.origin_px) @ segments.along
    beside = (row >= 0) & (row <= len(segments.pixel))
    middle, end = camera.project(surface.center_m + np.outer([0.0, length_m / 2], surface.direction))
    along = (end - middle) / np.linalg.norm(end - middle)
    offset = limbs.point_px[beside] - middle
    return np.abs(offset[:, 0] * along[1] - offset[:, 1] * along[0])


def _sections(segments: CrossSegments) -> tuple[Floats, Floats, Floats]:
    """Number (n,), offset of the middle from the stroke, and half width less the margin, of each section."""
    some = segments.inside.any(axis=1)
    width = segments.inside[some].sum(axis=1).astype(np.float64)
    first = segments.inside[some].argmax(axis=1) + segments.first_offset_px
    half_px = np.maximum(width / 2 - DRAWN_MARGIN_PX, LEAST_HALF_WIDTH_PX)
    return np.flatnonzero(some).astype(np.float64), first + (width - 1) / 2, half_px


def _ball(patch: Patch, place_px: Floats, half_px: Floats, distance_m: float) -> Ball:
    """The ball in the middle of sections of half widths (n,) at places (n, 2)."""
    middle = patch.camera.unproject((place_px[:1] + place_px[-1:]) / 2, np.ones(1))[0]
    radius_m = float(np.percentile(half_px, WIDEST)) / patch.focal_px * distance_m
    return Ball(distance_m * middle / np.linalg.norm(middle), radius_m, patch.focal_px)

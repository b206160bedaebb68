"""The central axis through the section centres, and the sections cut anew perpendicular to it (paper 3.4)."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Cloud, Floats, Indices, freeze
from rotrecon.circles import SectionCircles
from rotrecon.primitives import basis_across
from rotrecon.settings import Settings

ELONGATION = 2.0
"""Least ratio of the two largest variances of centres that are drawn out along a line; a heap of them has about 1."""
BELOW_ONE = 0.999
"""Where the last point of a section stands, so that it does not count as the next section's first."""


@dataclass(frozen=True, eq=False)
class Axis:
    """A line in camera coordinates, pointing the way the operator drew it."""

    point_m: Floats
    """(3,)"""
    direction: Floats
    """(3,) unit."""

    def __post_init__(self) -> None:
        freeze(self)

    def along(self, points_m: Floats) -> Floats:
        """Signed distance (...) of points (..., 3) from `point_m` along the axis."""
        return (points_m - self.point_m) @ self.direction

    def turn_to(self, other: "Axis") -> float:
        """Angle between two axes, rad."""
        return float(np.arccos(np.clip(self.direction @ other.direction, -1, 1)))

    def distance(self, points_m: Floats) -> Floats:
        """Distance (...) of points (..., 3) from the axis."""
        return np.linalg.norm(np.cross(points_m - self.point_m, self.direction), axis=-1)


@dataclass(frozen=True, eq=False)
class FittedAxis(Axis):
    """An axis, and which of the S section centres it rests on."""

    on_axis: Bools
    """(S,) False where there is no centre, or it lies farther from the axis than the mean."""


def fit_axis(circles: SectionCircles, settings: Settings) -> FittedAxis | None:
    """The axis through the centres of the circles.

    Total least squares in space takes the place of the two projections of paper (10), which cannot hold an axis along
    Oy or Oz. Centres farther than the mean distance, (11) and (12), are dropped once and the line fitted again.
    None when there are too few circles, or their centres are not drawn out along a line.
    """
    used = circles.used
    if used.sum() < settings.minimum_sections:
        return None
    first = _line_through(circles.center_m[used])
    if first is None:
        return None
    distance = first.distance(circles.center_m)
    limit = max(float(distance[used].mean()), settings.distance_floor_m)
    on_axis = used & (distance <= limit)
    second = _line_through(circles.center_m[on_axis])
    return None if second is None else FittedAxis(second.point_m, second.direction, on_axis)


def _line_through(centers_m: Floats) -> Axis | None:
    """Line of total least squares through points (N, 3) in the order of the stroke; None for a round heap of points."""
    middle = centers_m.mean(axis=0)
    offset = centers_m - middle
    spread, vectors = np.linalg.eigh(offset.T @ offset)
    if spread[2] <= ELONGATION * spread[1]:
        return None
    direction = vectors[:, 2]
    order = np.arange(len(centers_m)) - (len(centers_m) - 1) / 2
    return Axis(middle, direction if order @ (offset @ direction) >= 0 else -direction)


@dataclass(frozen=True, eq=False)
class SpaceSections:
    """Segmented points sorted into S sections perpendicular to an axis in space."""

    axis: Axis
    """The axis they are perpendicular to."""
    across: Floats
    """(3,) unit vector of a section's own x; its y points toward the camera."""
    toward_camera: Floats
    """(3,) unit."""
    pitch_m: float
    """Distance from one section to the next."""
    start: Indices
    """(S + 1,) section s holds the points from start[s] to start[s + 1]."""
    pixel: Indices
    """(M,) index into the flattened frame, ordered by section and by x within it."""
    cloud_m: Cloud
    """(H, W, 3) the frame's points, which are not held twice."""

    def __post_init__(self) -> None:
        freeze(self)

    def _points(self, pixel: Indices) -> Cloud:
        return self.cloud_m.reshape(-1, 3)[pixel]

    def base_points(self) -> tuple[Floats, Indices]:
        """First, middle and last point (S, 3, 3) of each section, brought into one plane, and the counts (S,)."""
        count = np.diff(self.start).astype(np.int32)
        rank = np.stack([np.zeros_like(count), (count - 1) // 2, count - 1], axis=1)
        points = np.full((len(count), 3, 3), np.nan)
        filled = count > 0
        points[filled] = self._points(self.pixel[(self.start[:-1, None] + rank)[filled]])
        along = self.axis.along(points)
        shift = along.mean(axis=1, keepdims=True) - along
        return points + shift[..., None] * self.axis.direction, count

    def points_of(self, sections: Bools) -> Cloud:
        """Points (n, 3) of the chosen (S,) sections, camera coordinates."""
        return self._points(self.pixel[np.repeat(sections, np.diff(self.start))])

    def pixels_in(self, section: int) -> Indices:
        """Index (n,) into the flattened frame of the pixels of one section, from one side to the other."""
        return self.pixel[self.start[section] : self.start[section + 1]]

    def points_in(self, section: int) -> Cloud:
        """Points (n, 3) of one section, camera coordinates."""
        return self._points(self.pixels_in(section))

    def in_plane(self, points_m: Cloud | Floats) -> Floats:
        """Points (..., 2) in a section's own plane, metres from the axis: across, and toward the camera."""
        offset = points_m - self.axis.point_m
        return np.stack([offset @ self.across, offset @ self.toward_camera], axis=-1)

    def residuals_m(self, section: int, circles: SectionCircles) -> Floats:
        """How far the points (n,) of one section lie outside its circle, in its own plane."""
        to_center = self.in_plane(self.points_in(section)) - self.in_plane(circles.center_m[section])
        return np.linalg.norm(to_center, axis=-1) - circles.radius_m[section]

    def section_at(self, origin_m: Floats, direction: Floats) -> int | None:
        """The section of the point that lies nearest to a sight line, camera coordinates (3,); None without points."""
        if len(self.pixel) == 0:
            return None
        across = np.cross(self._points(self.pixel) - origin_m, direction)
        nearest = int(np.argmin(np.einsum("ij,ij->i", across, across)))
        return int(np.searchsorted(self.start, nearest, side="right")) - 1


def span_along(axis: Axis, circles: SectionCircles) -> tuple[float, float]:
    """How far along an axis the used circles reach, half a section beyond the outermost centres."""
    along = axis.along(circles.center_m)[circles.used]
    margin = float(np.ptp(along)) / (2 * len(along))
    return float(along.min()) - margin, float(along.max()) + margin


def cut_in_space(cloud_m: Cloud, pixel: Indices, axis: Axis, ends_m: tuple[float, float], count: int) -> SpaceSections:
    """Sort pixels (M,) of a cloud (H, W, 3) into `count` sections between two distances along the axis."""
    across, toward_camera = basis_across(axis.direction, -axis.point_m)
    place = _section_and_place(cloud_m.reshape(-1, 3)[pixel], axis, across, ends_m, count)
    order = np.argsort(place)
    start = np.searchsorted(place, np.arange(count + 1), sorter=order)
    pixel = pixel[order[start[0] : start[-1]]]
    pitch_m = (ends_m[1] - ends_m[0]) / count
    return SpaceSections(axis, across, toward_camera, pitch_m, (start - start[0]).astype(np.int32), pixel, cloud_m)


def _section_and_place(points_m: Cloud, axis: Axis, across: Floats, ends_m: tuple[float, float], count: int) -> Floats:
    """Number of the section of each point (M, 3), plus its place across it from 0 to below 1; changes the points."""
    low, high = ends_m
    points_m -= axis.point_m.astype(np.float32)
    section = (points_m @ axis.direction.astype(np.float32) - low) * (count / (high - low))
    x = points_m @ across.astype(np.float32)
    x -= x.min(initial=0.0)
    x *= BELOW_ONE / max(float(x.max(initial=0.0)), np.finfo(np.float32).tiny)
    return np.add(np.floor(section, out=section), x, dtype=np.float64)

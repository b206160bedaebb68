"""How far along its axis a surface is really there, and whether the object was seen to end."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.patch import Patch
from rotrecon.turned.turned import radius_at

INNER = 0.8
"""Share of the radius beside the axis within which depth is asked: farther out matching smears it."""
AGREES, NEARLY = 4.0, 8.0
"""Sigmas within which a depth speaks for the surface, and within which it is not far off: where a surface leaves this
one slowly, it does so as far before the first limit as between the two."""
SLOW_PX = 10.0
"""Farther apart than this the two limits are those of different parts."""
DROP_PX = 2.0
"""Rows of the surface that must speak against it, more than for it, for its end; fewer are noise."""
OPEN_PX = 1.0
"""Nearer to the area's border than this no end can be seen."""
EDGE_SIGMA_PX = 0.29
"""Standard deviation of an end that lies anywhere within a pixel, 1 over the root of 12."""
WINDOW_SIGMA = 0.3
"""The same, over the length at which errors are alike: windows carry depth over an edge (measured on stereo noise)."""
COVER_ANGLES_RAD = np.linspace(-0.9, 0.9, 9)
"""Places round the visible side at which a height is asked whether it lies in the area."""
FEWEST_PIXELS = 12
"""Fewer that agree are no surface."""
MOST_STEPS = 4000
"""Places along an axis that are asked whether they lie in the area: more than any picture has rows."""
FARTHEST_PX = 1e6
"""Stands for places far outside any picture."""
NORMAL_95 = 1.96


@dataclass(frozen=True)
class Extent:
    """From where to where along its axis a surface is supported: heights from its centre, m."""

    low_m: float
    high_m: float
    low_open: bool
    """Whether it goes on beyond the area or the picture there."""
    high_open: bool
    low_interval_m: tuple[float, float] | None
    """95 %; None for an open end."""
    high_interval_m: tuple[float, float] | None

    @property
    def length_m(self) -> float:
        """From end to end."""
        return self.high_m - self.low_m

    @property
    def length_interval_m(self) -> tuple[float, float] | None:
        """95 %; None where an end is open."""
        if self.low_interval_m is None or self.high_interval_m is None:
            return None
        less = np.hypot(self.low_interval_m[1] - self.low_m, self.high_m - self.high_interval_m[0])
        more = np.hypot(self.low_m - self.low_interval_m[0], self.high_interval_m[1] - self.high_m)
        return (max(self.length_m - float(less), 0.0), self.length_m + float(more))


class _Walk(NamedTuple):
    """How far the support goes outward."""

    end_m: float
    next_m: float
    """Where the first depth after it speaks against the surface; infinite when none does."""


def extent_of(surface: Lateral, patch: Patch, sigma: float, correlation_px: float) -> Extent | None:
    """How far a fitted surface is supported, from the part beside the stroke on; None when that part is not there.

    `sigma` is that of the fit's residuals, in standard deviations of the noise; `correlation_px` how far they are
    alike. From the start the support goes outward as long as the pixels at which
    the surface would be seen have its depth, more for than against it (X-drop extension, Altschul et al. 1990).
    """
    depth_m, hit = surface.meet(patch.rays)
    x, _, height = surface.turn @ (patch.rays * depth_m - surface.center_m[:, None])
    radius = radius_at(surface, height)
    seen = np.flatnonzero(hit & (depth_m > 0) & (np.abs(x) < INNER * radius))
    height = height[seen]
    off = np.abs(patch.noise.steps(patch.depth_m[seen]) - patch.noise.steps(depth_m[seen])) / sigma
    at_stroke = patch.drawn[seen] & (off < AGREES)
    if at_stroke.sum() < FEWEST_PIXELS:
        return None
    start_m = float(np.median(height[at_stroke]))
    order = np.argsort(height)
    height, off = height[order] - start_m, off[order]
    first = int(np.searchsorted(height, 0.0))
    high = _end(surface, patch, (start_m, 1), height[first:], off[first:], correlation_px)
    low = _end(surface, patch, (start_m, -1), -height[:first][::-1], off[:first][::-1], correlation_px)
    return Extent(low[0], high[0], low[1] is None, high[1] is None, low[1], high[1])


def _end(
    surface: Lateral, patch: Patch, start: tuple[float, int], outward_m: Floats, off: Floats, correlation_px: float
) -> tuple[float, tuple[float, float] | None]:
    """Height of the end from a start one way (1 up, -1 down), and its interval, None if it is open."""
    start_m, way = start
    width_px = 2 * INNER * _radius_of(surface, start_m) * patch.focal_px / _depth_at(surface, start_m)
    walk = _walk(outward_m, off, AGREES, DROP_PX * width_px)
    pitch_m = _pitch(surface, patch, start_m + way * walk.end_m)
    border_m = _border(surface, patch, start_m, way, float(outward_m[-1]) if len(outward_m) else 0.0, pitch_m)
    if walk.end_m > border_m - OPEN_PX * pitch_m:
        return start_m + way * min(walk.end_m, border_m), None
    slow_m = _walk(outward_m, off, NEARLY, DROP_PX * width_px).end_m - walk.end_m
    slow_m = float(np.clip(slow_m, 0.0, SLOW_PX * pitch_m))
    reach_m = NORMAL_95 * pitch_m * float(np.hypot(EDGE_SIGMA_PX, WINDOW_SIGMA * correlation_px))
    end_m = walk.end_m - slow_m
    outer_m = max(end_m + slow_m / 2, min(walk.next_m, border_m) - slow_m / 2) + reach_m
    interval = (start_m + way * (end_m - slow_m / 2 - reach_m), start_m + way * outer_m)
    return start_m + way * end_m, (min(interval), max(interval))


def _walk(outward_m: Floats, off: Floats, limit: float, drop: float) -> _Walk:
    """The best sum of pixels for less pixels against, before it falls by more than `drop`; unknown depth is neither."""
    against = off >= limit
    score = np.cumsum((off < limit).astype(np.float64) - against)
    best = np.maximum.accumulate(np.maximum(score, 0.0))
    fallen = np.flatnonzero(best - score > drop)
    last = int(fallen[0]) + 1 if len(fallen) else len(score)
    if last == 0 or best[last - 1] == 0:
        return _Walk(0.0, 0.0)
    index = int(np.argmax(score[:last]))
    later = np.flatnonzero(against[index + 1 :])
    following = float(outward_m[index + 1 + later[0]]) if len(later) else np.inf
    return _Walk(float(outward_m[index]), following)


def _border(surface: Lateral, patch: Patch, start_m: float, way: int, farthest_m: float, pitch_m: float) -> float:
    """How far outward half of the visible side is still inside the area."""
    steps = int(min(2 * farthest_m / pitch_m + 2, MOST_STEPS)) if pitch_m > 0 and np.isfinite(farthest_m) else 2
    outward_m = np.linspace(0.0, farthest_m, steps) if np.isfinite(farthest_m) else np.zeros(2)
    height = start_m + way * outward_m
    across, toward, axis = surface.turn
    round_about = np.sin(COVER_ANGLES_RAD)[:, None] * across - surface.side * np.cos(COVER_ANGLES_RAD)[:, None] * toward
    on_axis = surface.center_m + height[:, None] * axis
    points = on_axis[:, None] + np.maximum(radius_at(surface, height), 0.0)[:, None, None] * round_about
    place_px = np.clip(patch.camera.project(points.reshape(-1, 3)), -FARTHEST_PX, FARTHEST_PX)
    pixel = patch.pixel_of(place_px).reshape(len(outward_m), -1)
    share = ((pixel >= 0) & patch.area[pixel]).mean(axis=1)
    # an object wider than the area is never covered by half
    covered = share >= min(0.5, max(float(share[0]), 1.0 / len(COVER_ANGLES_RAD))) / (1.0 if share[0] >= 0.5 else 2.0)
    return float(outward_m[-1] if covered.all() else outward_m[int(np.argmin(covered))])


def _pitch(surface: Lateral, patch: Patch, height_m: float) -> float:
    """Height along the axis that a pixel covers, on the visible side's middle."""
    height = height_m + _radius_of(surface, height_m) * np.array([-0.01, 0.01])
    ridge = -surface.side * np.maximum(radius_at(surface, height), 0.0)[:, None] * surface.turn[1]
    place_px = patch.camera.project(surface.center_m + height[:, None] * surface.direction + ridge)
    return float(np.ptp(height) / np.linalg.norm(place_px[1] - place_px[0]))


def _radius_of(surface: Lateral, height_m: float) -> float:
    return float(radius_at(surface, np.array([height_m]))[0])


def _depth_at(surface: Lateral, height_m: float) -> float:
    return float(surface.center_m[2] + height_m * surface.direction[2])

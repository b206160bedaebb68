"""Where a turned surface starts: an axis and a rough profile, from the segmented points alone."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.extent import Extent
from rotrecon.rays.coarse_fit import OUTLINE_SCALE
from rotrecon.rays.fitting import Measurement, Outlines, Prediction, refine
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.losses import TO_SIGMA, cauchy
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import spread
from rotrecon.rays.starts import Ridge, robust_line
from rotrecon.rays.surfaces import Surface, turn_of
from rotrecon.turned.looks import medians
from rotrecon.turned.smoothness import UNBENT, Smoothness
from rotrecon.turned.turned import AXIS_PARAMETERS, Turned, turned_from

TILTS_RAD = np.deg2rad([0.0, -35.0, 35.0])
"""How far the axis is turned toward the camera from the line nearest along the stroke: the right one is found from any
start within 25 degrees of it, and from most within 45."""
POINTS, SCOUTS = 500, 250
"""Of the segmented ones, for the best start, and for all of them."""
ROUGH_KNOTS = 10
ROUNDS, ITERATIONS = 2, 5
CLOSE = 0.5
"""Share of the radius within which a point may be of the surface."""
STIFF_SHARE = 0.05
"""Scale of the bends of a rough profile over the radius."""
INNER = 0.7
"""Share of the radius within which points say how far out the surface is, before anything is fitted."""
HEIGHT_QUANTILES = (0.01, 0.99)
"""Of the segmented points' heights: the profile's ends where nobody has said any better."""
STEP = 0.5
"""Of the width: a step in depth from one row of pixels to the next that is no part of one object."""
FEWEST_PIXELS = 5
"""Fewer say nothing of a height."""


@dataclass(frozen=True, eq=False)
class Points:
    """Points near a turned surface, compared by their distance from it: no ray has to meet it yet."""

    points_m: Floats
    """(3, N)"""
    sigma_m: Floats
    """(N,)"""

    def __post_init__(self) -> None:
        freeze(self)

    def __len__(self) -> int:
        return len(self.sigma_m)

    def predict(self, surface: Surface) -> Prediction:
        """Distances of the points, which were to be none. Raises TypeError for a surface that is not turned."""
        if not isinstance(surface, Turned):
            raise TypeError("only a turned surface has a profile")
        x, y, height = surface.turn @ (self.points_m - surface.center_m[:, None])
        out = np.maximum(np.hypot(x, y), 1e-9)
        radius, slope = surface.curve(height)
        scale = 1.0 / (np.sqrt(1.0 + slope**2) * self.sigma_m)
        lever = height + slope * out
        axis = np.stack([x, y, x * lever, y * lever]) / out
        return Prediction(np.concatenate([axis, surface.basis(height)]), scale, (out - radius) * scale)

    def chosen(self, index: Indices | Bools) -> "Points":
        """Some of the points."""
        return replace(self, points_m=self.points_m[:, index], sigma_m=self.sigma_m[index])


def turned_start(
    patch: Patch,
    edge: Ridge,
    lateral: Lateral | None,
    held: Bools,
    extent: Extent | None,
    outlines: Outlines,
    knots: int,
) -> Turned | None:
    """A rough turned surface, from the axis of a lateral one or from axes at several slants behind the stroke.

    An object in parts pulls a single cylinder or cone askew, so that this is no more than one of the starts, unless
    its turns are `held` (2,), it is seen from inside or an extent of it is asked for. None where little is segmented.
    """
    pixels = spread(np.flatnonzero(patch.kept & np.isfinite(patch.depth_m)).astype(np.int32), POINTS)
    depth_m = patch.depth_m[pixels]
    points = Points(patch.rays[:, pixels] * depth_m, patch.noise.sigma_m(depth_m))
    starts = [] if lateral is None else [lateral]
    if lateral is None or (extent is None and lateral.side < 0 and not held.any()):
        starts += _slanted(longest_run(edge), patch.focal_px)
    profiles = [rough_profile(start, points.points_m, extent, ROUGH_KNOTS) for start in starts]
    scouts = points.chosen(spread(np.arange(len(points), dtype=np.int32), SCOUTS))
    followed = [_followed(profile, scouts, outlines, held) for profile in profiles if profile is not None]
    if not followed:
        return None
    rough = min(followed, key=lambda one: one[0])[1]
    for _ in range(ROUNDS):
        # about a better axis the points have other heights
        again = rough_profile(rough, points.points_m, extent, ROUGH_KNOTS)
        rough = _followed(again or rough, points, outlines, held)[1]
    at = np.linspace(rough.low_m, rough.high_m, 4 * knots)
    return turned_from(rough, at, rough.curve(at)[0], knots)


def _slanted(edge: Ridge, focal_px: float) -> list[Lateral]:
    """Cylinders behind a ridge, as wide as that, their axes turned toward the camera or away from it."""
    if len(edge.width_m) < FEWEST_PIXELS:
        return []
    middle, along = robust_line(edge.points_m)
    toward = turn_of(along, -middle)[1]
    radius_m = float(np.median(edge.width_m)) / 2
    turns = [turn_of(np.cos(tilt) * along + np.sin(tilt) * toward, -middle) for tilt in TILTS_RAD]
    return [Lateral(middle - radius_m * turn[1], turn, radius_m, 0.0, focal_px, tapers=False) for turn in turns]


def longest_run(edge: Ridge) -> Ridge:
    """The longest part of a ridge without a step in depth that only another object makes."""
    if len(edge.width_m) == 0:
        return edge
    step_m = np.abs(np.diff(edge.points_m[:, 2]))
    limit_m = STEP * np.minimum(edge.width_m[1:], edge.width_m[:-1])
    breaks = np.concatenate([[0], np.flatnonzero(step_m > limit_m) + 1, [len(edge.width_m)]])
    longest = int(np.argmax(np.diff(breaks)))
    run = slice(int(breaks[longest]), int(breaks[longest + 1]))
    return Ridge(edge.points_m[run], edge.width_m[run])


def _followed(start: Turned, points: Points, outlines: Outlines, held: Bools) -> tuple[float, Turned]:
    """Cost and surface after a round over the outline and the points that are close to a start."""
    size_m = float(np.median(start.curve(np.linspace(start.low_m, start.high_m, ROUGH_KNOTS))[0]))
    close = points.chosen(_close(start, points.points_m))
    measurements: list[Measurement] = [close, Smoothness(STIFF_SHARE * size_m)]
    measurements += [outline for outline, _ in outlines]
    scale = max(TO_SIGMA * float(np.median(np.abs(close.predict(start).residual))), 1.0) if len(close) else 1.0
    edges = [(max(OUTLINE_SCALE * scale, 1.0), share) for _, share in outlines]
    units = start.units(start.high_m - start.low_m)
    free = np.ones(len(units), dtype=np.bool_)
    free[2:AXIS_PARAMETERS] = ~held
    surface = refine(start, measurements, [(scale, 1.0), UNBENT, *edges], cauchy, free, units, ITERATIONS).surface
    assert isinstance(surface, Turned)
    cost = float(cauchy(points.predict(surface).residual)[0].mean())
    cost += sum(float(cauchy(outline.predict(surface).residual)[0].mean()) for outline, _ in outlines)
    return cost, surface


def _close(surface: Turned, points_m: Floats) -> Bools:
    """Which points (3, N) may be of the surface: the background, which the segmentation may hold too, pulls it away."""
    x, y, height = surface.turn @ (points_m - surface.center_m[:, None])
    radius = surface.curve(height)[0]
    near = np.abs(np.hypot(x, y) - radius) < CLOSE * radius
    return near & (height > surface.low_m - CLOSE * radius) & (height < surface.high_m + CLOSE * radius)


def rough_profile(lateral: Lateral, points_m: Floats, extent: Extent | None, knots: int) -> Turned | None:
    """Through the median distances of points (3, N) from an axis; None where they are too few."""
    x, y, height = lateral.turn @ (points_m - lateral.center_m[:, None])
    out = np.hypot(x, y)
    inner = (np.abs(x) < INNER * out) & (-lateral.side * y > 0)
    if inner.sum() < FEWEST_PIXELS:
        return None
    height, out = height[inner], out[inner]
    low, high = (extent.low_m, extent.high_m) if extent else np.quantile(height, HEIGHT_QUANTILES)
    if high <= low:
        return None
    within = (height >= low) & (height <= high)
    place = np.minimum((height[within] - low) / (high - low) * knots, knots - 1).astype(np.int32)
    radius = medians(out[within], place, knots, FEWEST_PIXELS)
    known = np.isfinite(radius)
    if known.sum() < 2:
        return None
    at = np.linspace(low, high, 4 * knots)
    middle = low + (np.arange(knots) + 0.5) * (high - low) / knots
    return turned_from(lateral, at, np.interp(at, middle[known], radius[known]), knots)

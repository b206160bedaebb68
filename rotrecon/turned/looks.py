"""Depths, and edges of an outline, by the height along an axis that each looks at."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.noise import RayNoise
from rotrecon.rays.fitting import Outlines
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.lines import Lines
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import spread
from rotrecon.rays.traces import GRAZING_PX
from rotrecon.turned.look_rays import grouped_medians, met_cones
from rotrecon.turned.turned import Turned, radius_at, turned_from

INNER = 0.7
"""Share of the radius within which points say roughly how far out the surface is."""
GUARD = 0.95
"""Of the radius: farther out a ray's depth hardly depends on it in any straight way."""
CLOSE, CLOSE_SIGMA = 0.5, 5.0
"""Share of the radius, and standard deviations more, within which a depth may be of the surface."""
SURPLUS = 4
"""As many times the depths that are wanted are looked at: not all are of the surface."""
FEWEST_PIXELS = 6
"""Fewer say nothing of a height."""
SMALLEST_M = 1e-6
"""A radius is never less: what is divided by it must stay finite."""
FAR = 1e6
"""Residual of a ray that has no say: no scale takes it for noise."""


@dataclass(frozen=True, eq=False)
class Looks:
    """N depths that look at one of n heights each."""

    surface: Turned
    guard: float
    """Share of the radius beside the axis beyond which rays have no say."""
    lines: Lines
    pixels: Indices
    """(N,) of the patch."""
    share: float
    """Of all depths that look there, which these are."""
    steps: Floats
    """(N,) depth in standard deviations of its noise."""
    noise: RayNoise
    place: Indices
    """(N,) which of the heights."""
    count: int
    """n."""
    height: Floats
    """(N,) that was seen."""
    radius: Floats
    """(N,) of the surface there."""
    slope: Floats
    """(N,)"""
    offset: Floats
    """(N,) how much farther out than the surface each depth lies; NaN away from the middle."""

    def __post_init__(self) -> None:
        freeze(self)

    def rows(self, change_m: Floats) -> tuple[Floats, Floats]:
        """Residuals (N,), in standard deviations of the noise, and derivatives (5, N) of the predicted.

        By the axis' four parameters and the radius of the height, where the radii (n,) are changed.
        """
        change = change_m[self.place]
        unknown = np.isnan(change)
        radius = np.maximum(self.radius + np.where(unknown, 0.0, change), SMALLEST_M)
        lines, surface = self.lines, self.surface
        columns, depth, root, grazing = met_cones(
            lines.origin,
            lines.turned,
            np.stack([lines.square, lines.mixed, self.height, radius, self.slope]),
            surface.side,
            2 * GRAZING_PX / surface.focal_px,
            1 - self.guard**2,
        )
        columns *= -surface.side / (root * self.noise.sigma_m(depth))
        return np.where(grazing | unknown, FAR, self.steps - self.noise.steps(depth)), columns


@dataclass(frozen=True, eq=False)
class Grazes:
    """N rays seen to graze a surface at one of n heights each."""

    lines: Lines
    sigma_m: Floats
    """(N,) at their depth."""
    place: Indices
    height: Floats
    """(N,) at which each is nearest to the surface."""
    radius: Floats
    slope: Floats

    def __post_init__(self) -> None:
        freeze(self)

    def rows(self, change_m: Floats) -> tuple[Floats, Floats]:
        """The same of how far they pass outside."""
        change = np.nan_to_num(change_m[self.place])
        radius = np.maximum(self.radius + change, SMALLEST_M)
        square, mixed, _ = self.lines.quadratic(self.height, radius, self.slope)
        depth = -mixed / square
        x, y = self.lines.aside(depth)
        there = radius + self.slope * (self.lines.height(depth) - self.height)
        columns = _columns(self.lines, depth, self.height, radius, self.slope) / (radius * self.sigma_m)
        return (there**2 - x**2 - y**2) / (2 * radius * self.sigma_m), columns


def _columns(lines: Lines, depth: Floats, height: Floats, radius: Floats, slope: Floats) -> Floats:
    """(5, N) derivatives of half of x^2 + y^2 - r(h)^2 by the axis' parameters and the radius."""
    x, y = lines.aside(depth)
    lever = height + slope * radius
    return np.stack([-x, -y, -x * lever, -y * lever, -radius])


def looks_at(surface: Lateral, patch: Patch, heights_m: Floats, guard: float, most: int | None = None) -> Looks:
    """The depths in the area that may be of a surface, by the heights (n,), rising, that they are nearest to.

    Rays that pass farther beside the axis than `guard` times the radius will have no say. `most` are taken, evenly,
    where there are more. A depth's height is that at which it was seen: right whatever the surface's radius there.
    """
    turned = surface if isinstance(surface, Turned) else _as_turned(surface, heights_m)
    every = np.flatnonzero(patch.area & np.isfinite(patch.depth_m)).astype(np.int32)
    pixels = every if most is None else spread(every, SURPLUS * most)
    share = len(pixels) / max(len(every), 1)
    depth_m = patch.depth_m[pixels]
    x, y, height = _beside(turned, patch.rays.take(pixels, axis=1) * depth_m)
    radius, slope = turned.curve(height)
    off = np.hypot(x, y) - radius
    close = np.abs(off) < CLOSE * radius + CLOSE_SIGMA * patch.noise.sigma_m(depth_m)
    chosen = np.flatnonzero(close & (-turned.side * y > 0) & _within(height, heights_m)).astype(np.int32)
    if most is not None and len(chosen) > most:
        share *= most / len(chosen)
        chosen = spread(chosen, most)
    inner = np.abs(x) < INNER * np.hypot(x, y)
    return Looks(
        surface=turned,
        guard=min(guard, GUARD),
        lines=Lines.of(turned, patch.rays.take(pixels[chosen], axis=1)),
        pixels=pixels[chosen],
        share=share,
        steps=patch.noise.steps(depth_m[chosen]),
        noise=patch.noise,
        place=_place(height[chosen], heights_m),
        count=len(heights_m),
        height=height[chosen],
        radius=radius[chosen],
        slope=slope[chosen],
        offset=np.where(inner, off, np.nan)[chosen],
    )


def grazes_at(surface: Turned, outlines: Outlines, heights_m: Floats) -> Grazes | None:
    """The edges of outlines, with their independent shares, by the heights (n,) that they are nearest to."""
    if not outlines:
        return None
    rays = np.concatenate([outline.rays for outline, _ in outlines], axis=1)
    sigma_px = np.concatenate([outline.sigma_px / np.sqrt(share) for outline, share in outlines])
    _, depth = surface.gap(rays)
    height = Lines.of(surface, rays).height(depth)
    kept = _within(height, heights_m) & (depth > 0)
    rays, height = rays[:, kept], height[kept]
    radius, slope = surface.curve(height)
    sigma_m = (sigma_px * depth)[kept] / surface.focal_px
    return Grazes(Lines.of(surface, rays), sigma_m, _place(height, heights_m), height, radius, slope)


def medians(values: Floats, place: Indices, count: int, fewest: int) -> Floats:
    """(count,) medians of the known of values (N,) by their place (N,); NaN where there are fewer than so many."""
    known = np.isfinite(values)
    return grouped_medians(values[known], place[known], count, fewest)


def _beside(surface: Turned, points_m: Floats) -> tuple[Floats, Floats, Floats]:
    """Offsets across and toward the camera, and heights (N,), of points (3, N)."""
    turned = surface.turn @ (points_m - surface.center_m[:, None])
    return turned[0], turned[1], turned[2]


def _within(height: Floats, heights_m: Floats) -> Bools:
    """Which heights (N,) are no farther from the first and last of rising ones (n,) than half way to the next."""
    first, last = 1.5 * heights_m[0] - 0.5 * heights_m[1], 1.5 * heights_m[-1] - 0.5 * heights_m[-2]
    return (height > first) & (height < last)


def _place(height: Floats, heights_m: Floats) -> Indices:
    """(N,) which of the rising heights (n,) each is nearest to."""
    return np.rint(np.interp(height, heights_m, np.arange(len(heights_m)))).astype(np.int32)


def _as_turned(surface: Lateral, heights_m: Floats) -> Turned:
    ends = heights_m[[0, -1]]
    return turned_from(surface, ends, radius_at(surface, ends), 4)

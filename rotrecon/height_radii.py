"""The radius of each height about an axis, from the depths and the outline at that height alone."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.fitting import Outline, robust_scale, tukey
from rotrecon.noise import RayNoise
from rotrecon.patch import Patch
from rotrecon.ray_fit import spread
from rotrecon.surfaces import Lateral
from rotrecon.turned import Lines, Turned, turned_from

INNER = 0.7
"""Share of the radius within which points say roughly how far out the surface is."""
GUARD = 0.95
"""Of the radius: farther out a ray's depth hardly depends on it in any straight way."""
CLOSE, CLOSE_SIGMA = 0.5, 5.0
"""Share of the radius, and standard deviations more, within which a depth may be of the surface."""
SURPLUS = 4
"""As many times the depths that are wanted are looked at: not all are of the surface."""
ROUNDS = 3
"""Reweightings: each at least halves what is left."""
FEWEST_PIXELS = 6
"""Fewer say nothing of a height."""
AGREES, SOUND_SHARE = 3.0, 0.8
"""Sigmas within which a depth agrees with its height's radius, and the share of them that must."""
SMALLEST_M, LEAST_SIGMA = 1e-6, 1e-9
"""Exact depth has no noise, but what is divided by it must stay finite."""
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
        """Residuals (N,), in standard deviations of the noise, and derivatives (5, N) of the predicted by the axis' four
        parameters and the radius of the height, where the radii (n,) are changed."""
        change = change_m[self.place]
        unknown = np.isnan(change)
        radius = np.maximum(self.radius + np.where(unknown, 0.0, change), SMALLEST_M)
        depth, root, _ = self.surface.meet(self.lines, self.height, radius, self.slope)
        square, _, _ = self.lines.quadratic(self.height, radius, self.slope)
        grazing = root**2 < (1 - self.guard**2) * np.abs(square) * radius**2
        scale = -self.surface.side / (root * self.noise.sigma_m(depth))
        columns = _columns(self.lines, depth, self.height, radius, self.slope) * scale
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


@dataclass(frozen=True, eq=False)
class Sums:
    """Normal equations of an axis (4 parameters) and n radii, of which each measurement knows one."""

    axis: Floats
    """(4, 4)"""
    axis_pull: Floats
    """(4,)"""
    mixed: Floats
    """(4, n)"""
    own: Floats
    """(n,)"""
    own_pull: Floats
    """(n,)"""

    def __post_init__(self) -> None:
        freeze(self)

    @staticmethod
    def of(residual: Floats, columns: Floats, weight: Floats, place: Indices, count: int) -> "Sums":
        """Of weighted (N,) residuals (N,) and their derivatives (5, N)."""
        weighted = columns * weight
        own = columns[-1]
        return Sums(
            axis=weighted[:-1] @ columns[:-1].T,
            axis_pull=weighted[:-1] @ residual,
            mixed=np.stack([np.bincount(place, column * own, count) for column in weighted[:-1]]),
            own=np.bincount(place, weighted[-1] * own, count),
            own_pull=np.bincount(place, weighted[-1] * residual, count),
        )

    def plus(self, other: "Sums") -> "Sums":
        """These and others."""
        return Sums(
            self.axis + other.axis,
            self.axis_pull + other.axis_pull,
            self.mixed + other.mixed,
            self.own + other.own,
            self.own_pull + other.own_pull,
        )

    def of_axis(self) -> tuple[Floats, Floats]:
        """Gradient (4,) and information (4, 4) of the axis, whatever the radii are (Schur complement)."""
        follows = self.mixed / np.maximum(self.own, 1e-300)
        return self.axis_pull - follows @ self.own_pull, self.axis - follows @ self.mixed.T


@dataclass(frozen=True, eq=False)
class HeightRadii:
    """How the radius of each height differs from a surface's, and what is left then."""

    change_m: Floats
    """(n,) NaN where too little is seen."""
    sound: Bools
    """(n,) which heights have one radius that most of their depths agree on: an edge or a flat end has none."""
    sums: Sums
    """Of the sound heights, the outline's with the depths'."""
    residual: Floats
    """(N,) of the depths, in standard deviations of the noise; far off at rays that have no say."""
    sigma: float
    """Of the residuals of those that fit."""

    def __post_init__(self) -> None:
        freeze(self)


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
    x, y, height = _beside(turned, patch.rays[:, pixels] * depth_m)
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
        lines=Lines.of(turned, patch.rays[:, pixels[chosen]]),
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


def grazes_at(surface: Turned, outlines: tuple[tuple[Outline, float], ...], heights_m: Floats) -> Grazes | None:
    """The edges of outlines, with their independent shares, by the heights (n,) that they are nearest to."""
    if not outlines:
        return None
    rays = np.concatenate([outline.rays for outline, _ in outlines], axis=1)
    sigma_px = np.concatenate([outline.sigma_px / np.sqrt(share) for outline, share in outlines])
    depth = surface.tangency(rays).depth_m
    height = Lines.of(surface, rays).height(depth)
    kept = _within(height, heights_m) & (depth > 0)
    rays, height = rays[:, kept], height[kept]
    radius, slope = surface.curve(height)
    sigma_m = (sigma_px * depth)[kept] / surface.focal_px
    return Grazes(Lines.of(surface, rays), sigma_m, _place(height, heights_m), height, radius, slope)


def height_radii(looks: Looks, grazes: Grazes | None, independent: float) -> HeightRadii:
    """The radii that explain the depths, and the outline, at each height best, by the redescending loss.

    `independent` is the share of the depths that err independently, against which the outline is weighed.
    """
    change, every = _first(looks), np.ones(looks.count, dtype=np.bool_)
    for _ in range(ROUNDS):
        sums, _, _ = _summed(looks, grazes, change, independent, every)
        change = change + sums.own_pull / np.maximum(sums.own, 1e-300)
    residual, _ = looks.rows(change)
    sigma = _sigma(residual)
    agree, asked = np.abs(residual) < AGREES * sigma, residual < FAR
    agreeing, of = (np.bincount(looks.place[which], minlength=looks.count) for which in (agree, asked))
    sound = np.isfinite(change) & (agreeing >= FEWEST_PIXELS) & (agreeing > SOUND_SHARE * of)
    return HeightRadii(change, sound, *_summed(looks, grazes, change, independent, sound))


def _summed(
    looks: Looks, grazes: Grazes | None, change_m: Floats, independent: float, sound: Bools
) -> tuple[Sums, Floats, float]:
    """Normal equations of the sound (n,) heights, residuals (N,) of the depths and their sigma, at changed radii (n,)."""
    residual, columns = looks.rows(change_m)
    sigma = _sigma(residual)
    weight = tukey(residual / sigma)[1] * sound[looks.place] * independent / sigma**2
    sums = Sums.of(residual, columns, weight, looks.place, looks.count)
    if grazes is not None:
        off, columns = grazes.rows(change_m)
        weight = tukey(off)[1] * sound[grazes.place]
        sums = sums.plus(Sums.of(off, columns, weight, grazes.place, looks.count))
    return sums, residual, sigma


def _sigma(residual: Floats) -> float:
    """Of the residuals (N,) that fit, of rays that have a say."""
    asked = residual[residual < FAR]
    return max(robust_scale(asked), LEAST_SIGMA) if len(asked) else LEAST_SIGMA


def _first(looks: Looks) -> Floats:
    """(n,) median offset of each height; NaN where too few are seen."""
    known = np.isfinite(looks.offset)
    order = np.argsort(looks.place[known], kind="stable")
    number = np.bincount(looks.place[known], minlength=looks.count)
    groups = np.split(looks.offset[known][order], np.cumsum(number)[:-1])
    return np.array([float(np.median(one)) if len(one) >= FEWEST_PIXELS else np.nan for one in groups])


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
    return turned_from(surface, ends, surface.radius_m + surface.slope * ends, 4)

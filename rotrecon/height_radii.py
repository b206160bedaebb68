"""The radius of each height about an axis that is held, from the depths of that height alone, along the rays."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.fitting import robust_scale, tukey
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
ROUNDS = 4
"""Reweightings: each at least halves what is left."""
FEWEST_PIXELS = 6
"""Fewer say nothing of a height."""
AGREES, SOUND_SHARE = 3.0, 0.8
"""Sigmas within which a depth agrees with its height's radius, and the share of them that must."""
SMALLEST_M, LEAST_SIGMA = 1e-6, 1e-9
"""Exact depth has no noise, but what is divided by it must stay finite."""
FAR = 1e6
"""Residual of a ray that grazes: no scale takes it for noise."""


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


@dataclass(frozen=True, eq=False)
class HeightRadii:
    """How the radius of each height differs from a surface's, and what is left then."""

    change_m: Floats
    """(n,) NaN where too little is seen."""
    sound: Bools
    """(n,) which heights have one radius that most of their depths agree on: an edge or a flat end has none."""
    residual: Floats
    """(N,) what is left, in standard deviations of the noise; far off at rays that graze."""
    columns: Floats
    """(5, N) derivatives of the predicted by the axis' four parameters and by the radius of the height."""
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
    pixels = np.flatnonzero(patch.area & np.isfinite(patch.depth_m)).astype(np.int32)
    place_m: Floats = turned.turn @ (patch.rays[:, pixels] * patch.depth_m[pixels] - turned.center_m[:, None])
    middle = (heights_m[1:] + heights_m[:-1]) / 2
    within = (place_m[2] > 2 * heights_m[0] - middle[0]) & (place_m[2] < 2 * heights_m[-1] - middle[-1])
    seen = within & (-turned.side * place_m[1] > 0)
    pixels, x, y = pixels[seen], place_m[0][seen], place_m[1][seen]
    height: Floats = place_m[2][seen]
    out = np.hypot(x, y)
    radius, slope = turned.curve(height)
    off = out - radius
    close = np.abs(off) < CLOSE * radius + CLOSE_SIGMA * patch.noise.sigma_m(patch.depth_m[pixels])
    chosen = np.flatnonzero(close).astype(np.int32)
    every = len(chosen)
    if most is not None:
        chosen = spread(chosen, most)
    pixels = pixels[chosen]
    height = height[chosen]
    return Looks(
        surface=turned,
        guard=min(guard, GUARD),
        lines=Lines.of(turned, patch.rays[:, pixels]),
        pixels=pixels,
        share=len(chosen) / max(every, 1),
        steps=patch.noise.steps(patch.depth_m[pixels]),
        noise=patch.noise,
        place=np.rint(np.interp(height, heights_m, np.arange(len(heights_m)))).astype(np.int32),
        count=len(heights_m),
        height=height,
        radius=radius[chosen],
        slope=slope[chosen],
        offset=np.where(np.abs(x) < INNER * out, off, np.nan)[chosen],
    )


def _as_turned(surface: Lateral, heights_m: Floats) -> Turned:
    ends = heights_m[[0, -1]]
    return turned_from(surface, ends, surface.radius_m + surface.slope * ends, 4)


def height_radii(looks: Looks) -> HeightRadii:
    """The radii that explain the depths of each height best, by the redescending loss."""
    found = _residuals(looks, _first(looks))
    for _ in range(ROUNDS):
        weighted = tukey(found.residual / found.sigma)[1] * found.columns[-1]
        info = np.bincount(looks.place, weighted * found.columns[-1], looks.count)
        pull = np.bincount(looks.place, weighted * found.residual, looks.count)
        found = _residuals(looks, found.change_m + pull / np.maximum(info, 1e-300))
    asked = found.residual < FAR
    agree = np.abs(found.residual) < AGREES * found.sigma
    of, count = (
        np.bincount(looks.place[agree], minlength=looks.count),
        np.bincount(looks.place[asked], minlength=looks.count),
    )
    sound = np.isfinite(found.change_m) & (of >= FEWEST_PIXELS) & (of > SOUND_SHARE * count)
    return replace(found, sound=sound)


def _first(looks: Looks) -> Floats:
    """(n,) median offset of each height; NaN where too few are seen."""
    known = np.isfinite(looks.offset)
    order = np.argsort(looks.place[known], kind="stable")
    number = np.bincount(looks.place[known], minlength=looks.count)
    groups = np.split(looks.offset[known][order], np.cumsum(number)[:-1])
    return np.array([float(np.median(one)) if len(one) >= FEWEST_PIXELS else np.nan for one in groups])


def _residuals(looks: Looks, change_m: Floats) -> HeightRadii:
    """Residuals and derivatives where the radius of each height is changed (n,)."""
    surface, lines = looks.surface, looks.lines
    change = change_m[looks.place]
    unknown = np.isnan(change)
    radius = np.maximum(looks.radius + np.where(unknown, 0.0, change), SMALLEST_M)
    depth, root, _ = surface.meet(lines, looks.height, radius, looks.slope)
    a = np.abs(lines.quadratic(looks.height, radius, looks.slope)[0])
    x, y = lines.aside(depth)
    lever = looks.height + looks.slope * radius
    scale = -surface.side / (root * looks.noise.sigma_m(depth))
    columns = np.stack([-x, -y, -x * lever, -y * lever, -radius]) * scale
    grazing = root**2 < (1 - looks.guard**2) * a * radius**2
    residual = np.where(grazing | unknown, FAR, looks.steps - looks.noise.steps(depth))
    judged = residual[residual < FAR]
    sigma = max(robust_scale(judged), LEAST_SIGMA) if len(judged) else LEAST_SIGMA
    return HeightRadii(change_m, np.isfinite(change_m), residual, columns, sigma)

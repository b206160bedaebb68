"""Where an object's outline runs in the picture, to a fraction of a pixel, near where depth says it is."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotrecon.arrays import Bools, Bytes, Cloud, Floats, Indices, freeze
from rotrecon.edges.edge_lines import BEYOND_PX, Line, Stretch, find_line
from rotrecon.edges.edge_model import Profiles
from rotrecon.edges.edge_steps import SYSTEMATIC_SHARE, Steps, find_steps
from rotrecon.edges.light import LightSpline

ACROSS_PX = np.array([-5, -4, -3, -2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2, 3, 4, 5])
"""Samples across an edge: half a pixel apart where it may be, one where texture is learnt, and no farther off, where
other things begin."""
DEEP_PX, SHADED_SHARE = np.arange(-14.0, -5.0), 0.8
"""Samples farther inside, and up to which share of the half width: they tell how the object is shaded."""
PROFILE_PX = float(ACROSS_PX[-1])
LEAST_HALF_WIDTH_PX = 3.5
"""Of an object that has a colour of its own between its edges."""
LEAST_POINTS = 12
"""Fewer points say too little of what is a line and what a texture."""
LEAST_LENGTH_PX = 8.0
"""Of a stretch: twice the distance over which steps are averaged."""
LEAST_SUPPORT = 0.33
"""Of a line to be trusted: half the lines through texture alone have less."""
RUNNER_UP_SHARE = 0.52
"""Of the support, what a second line may have beside one that is trusted."""
SPREAD_REACHES = 1.5
"""Reaches within which one line is about as likely as another, unless more is known: depths may have drifted."""
LEAST_FOUND = 0.6
"""Share of the points with an edge on a line to be trusted."""
MOVED_PX, MOVES, FARTHEST_PX = 0.2, 6, 2.5
"""A line farther inside its steps is moved onto them, and they are looked for again, so many times at most and no
farther from where it began. Not inward: what shading there is on the object would draw it on and on."""
LARGEST_SIGMA_PX = 0.5
"""Of a line to be trusted: more says nothing that depth does not know."""


@dataclass(frozen=True)
class Side:
    """What the edges of one stretch of the outline are worth together."""

    support: float
    """From 0 to 1: how strong the edges on its line are, on average, over the strongest ones near it."""
    runner_up: float
    """The same of the best other line: a shadow, a print, or else this one is."""
    found: float
    """Share with an edge of its points that are well inside the picture; 0 if the line may be another's."""
    sigma_px: float
    """Standard error of its mean offset."""
    blur_px: float
    """Standard deviation of the picture's blur there."""

    @property
    def alike_px(self) -> float:
        """Standard deviation of what all its edges err by alike; it is in `sigma_px`."""
        return SYSTEMATIC_SHARE * self.blur_px

    @property
    def trusted(self) -> bool:
        """Whether this is the outline, and no other line could be it."""
        return self.found >= LEAST_FOUND and self.sigma_px <= LARGEST_SIGMA_PX


NOTHING = Side(0.0, 0.0, 0.0, np.inf, np.nan)
"""Where there is too little to look at."""


@dataclass(frozen=True, eq=False)
class Edges:
    """Edges near the predicted points of an outline."""

    offset_px: Floats
    """(N,) signed distance from the predicted point along its normal, outward; NaN: none, one off the line, or a line
    that another could be instead."""
    sigma_px: Floats
    """(N,) standard error, so large that points taken as independent have their side's own error together."""
    contrast: Floats
    """(N,) distance of the object's colour from the background's, in standard deviations of their textures."""
    sides: tuple[Side, ...]
    """In the order of their numbers."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class _Crop:
    """The part of a picture that profiles may reach."""

    image: Bytes
    picture: Cloud
    """The same as numbers."""
    low_px: NDArray[np.int64]
    """(2,) its first column and row in the whole."""

    @cached_property
    def light(self) -> LightSpline:
        """Its linear light."""
        return LightSpline.of(self.image)

    @staticmethod
    def of(image: Bytes, point_px: Floats, reach_px: float) -> "_Crop":
        """Round points (N, 2)."""
        border = reach_px + BEYOND_PX + PROFILE_PX + 1
        low = np.floor(point_px.min(axis=0) - border).astype(np.int64).clip(0, None)
        high = np.ceil(point_px.max(axis=0) + border).astype(np.int64) + 1
        crop = image[low[1] : high[1], low[0] : high[0]]
        return _Crop(crop, crop.astype(np.float32), low)


def find_edges(
    image: Bytes,
    point_px: Floats,
    normal_px: Floats,
    reach_px: float,
    half_width_px: ArrayLike,
    side: NDArray[np.integer[Any]] | None = None,
    spread_px: float | None = None,
) -> Edges:
    """The outline of an object in a picture (H, W, 3), sRGB, near predicted points (N, 2) in order along it.

    `normal_px` (N, 2) are unit vectors away from the object, `half_width_px` (N,) is half the object's width there,
    `reach_px` is how far the prediction may be off. `side` (N,) numbers the stretches, each of which is one smooth line
    close to parallel to its points: the two limbs of a cylinder, or all of a ball's circle. Its `Side` says whether
    what was found there is the outline. A line `spread_px` off the prediction, by default more than the reach, is half
    as likely to be it as one nearer. Points 1 to 2 px apart are enough. ValueError for shapes that do not fit, and for
    a reach that is not positive.
    """
    half_width = np.broadcast_to(np.asarray(half_width_px, dtype=np.float64), len(point_px))
    numbers = np.zeros(len(point_px), dtype=np.int64) if side is None else side
    if not (point_px.shape == normal_px.shape == (len(numbers), 2)):
        raise ValueError("points and normals must be (N, 2), and sides (N,)")
    if reach_px <= 0:
        raise ValueError("the reach must be positive")
    usable = _usable(image, point_px, normal_px, half_width, reach_px)
    groups = [np.flatnonzero(numbers == number) for number in np.unique(numbers)]
    read = [
        rows for rows in (group[usable[group]].astype(np.int32) for group in groups) if _long_enough(point_px[rows])
    ]
    crop = _Crop.of(image, point_px, reach_px)
    sides = dict.fromkeys(numbers.tolist(), NOTHING)
    clear: list[tuple[Indices, Stretch, Line]] = []
    for rows in read:
        stretch = Stretch(point_px[rows] - crop.low_px, normal_px[rows], half_width[rows])
        line = find_line(crop.picture, stretch, reach_px, spread_px or SPREAD_REACHES * reach_px)
        sides[int(numbers[rows[0]])] = replace(NOTHING, support=line.support, runner_up=line.runner_up)
        if line.support >= LEAST_SUPPORT and line.runner_up <= RUNNER_UP_SHARE * line.support:
            clear.append((rows, stretch, line))
    found = np.full((3, len(point_px)), np.nan)
    for (rows, _, line), steps in zip(clear, _steps(crop, clear), strict=True):
        found[:, rows] = steps.offset_px, steps.sigma_px, steps.contrast
        share = float(np.isfinite(steps.offset_px).mean())
        sides[int(numbers[rows[0]])] = Side(line.support, line.runner_up, share, steps.mean_sigma_px, steps.blur_px)
    return Edges(*found, sides=tuple(sides[number] for number in sorted(sides)))


def _usable(image: Bytes, point_px: Floats, normal_px: Floats, half_width_px: Floats, reach_px: float) -> Bools:
    """Which points (N,) have their whole profile in the picture, and an object wide enough inside."""
    most = reach_px + BEYOND_PX + PROFILE_PX
    ends = np.stack([point_px - most * normal_px, point_px + most * normal_px])
    within = (ends >= 0) & (ends <= np.array(image.shape[1::-1]) - 1)
    return within.all(axis=(0, 2)) & (half_width_px >= LEAST_HALF_WIDTH_PX)


def _long_enough(point_px: Floats) -> bool:
    length = np.linalg.norm(np.diff(point_px, axis=0), axis=1).sum()
    return len(point_px) >= LEAST_POINTS and length >= LEAST_LENGTH_PX


def _steps(crop: _Crop, clear: list[tuple[Indices, Stretch, Line]]) -> list[Steps]:
    """The steps near the lines, looked for again where these turn out to be off: shading is steepest inside a limb."""
    first_px = [line.offset_px for _, _, line in clear]
    steps = find_steps(_profiles(crop, clear))
    for _ in range(MOVES):
        lines_px = [one.line_px.clip(px, px + FARTHEST_PX) for one, px in zip(steps, first_px, strict=True)]
        moved_px = [np.abs(px - line.offset_px) for px, (_, _, line) in zip(lines_px, clear, strict=True)]
        if max((float(np.median(px)) for px in moved_px), default=0.0) < MOVED_PX:
            break
        clear = [
            (rows, stretch, replace(line, offset_px=px))
            for px, (rows, stretch, line) in zip(lines_px, clear, strict=True)
        ]
        steps = find_steps(_profiles(crop, clear))
    return steps


def _profiles(crop: _Crop, clear: list[tuple[Indices, Stretch, Line]]) -> list[Profiles]:
    """The colours across the line of every stretch."""
    profiles: list[Profiles] = []
    for _, stretch, line in clear:
        half_width_px = float(stretch.half_width_px.min())
        across, deep = ACROSS_PX[-half_width_px <= ACROSS_PX], DEEP_PX[-SHADED_SHARE * half_width_px <= DEEP_PX]
        light, inside = (
            crop.light.across(stretch.point_px, stretch.normal_px, line.offset_px, places) for places in (across, deep)
        )
        profiles.append(Profiles(stretch, line, across, light, deep, inside))
    return profiles

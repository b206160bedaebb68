"""An object in parts: as few cylinders, cones and spheres on one axis as the profile of its radii allows."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.turned.profile import NORMAL_95, Profile
from rotrecon.turned.runs import cheapest_runs, line_misfits

PartKind = Literal["cylinder", "cone", "sphere"]
KINDS: tuple[PartKind, ...] = ("cylinder", "cone", "sphere")
FREE = {"cylinder": 1, "cone": 2, "sphere": 2}
"""Numbers that each kind is free to choose."""
BREAK_COST, NUMBER_COST = 3.0, 1.0
"""Of a further part and of a further number, over the logarithm of the count of independent heights (modified Bayesian
information criterion, Zhang and Siegmund 2007: a break may lie anywhere, and the best of many places is found)."""
CAUTION = 8.0
"""Twice the logarithm of the odds, 1 to 55, against a further part or number before anything is seen."""
FEWEST = 5
"""Heights in a part: fewer may be the edge between two."""
MOST_SKIPPED, SKIP_COST = 4, 10.0
"""Heights that may be left out where a part begins or the last one ends, at an edge that pixels straddle; and the price
of each, that of 3.2 standard deviations."""
SMOOTHED = 2
"""Heights to each side, of whose median a stray one is no part."""
STRAY = 5.0
"""Standard deviations from that median beyond which one is stray."""
MEETING = 2.5
"""Heights from a break within which the two parts that meet there say better where that is."""
TO_SIGMA = 1.4826


@dataclass(frozen=True)
class Part:
    """A piece of a cylinder, a cone or a sphere about the axis; heights from the surface's centre."""

    kind: PartKind
    low_m: float
    high_m: float
    radius_m: float
    """Of a sphere its own, of others that at the middle of their length."""
    radius_interval_m: tuple[float, float]
    """95 %"""
    slope: float = 0.0
    """Of a cone: the tangent of its half angle, positive where it widens with the height."""
    slope_interval: tuple[float, float] | None = None
    """95 %, of a cone."""
    center_m: float | None = None
    """Height of a sphere's centre."""


@dataclass(frozen=True, eq=False)
class _Heights:
    """The n heights that count."""

    height: Floats
    radius: Floats
    variance: Floats
    """(n,) of each radius by itself, as if the heights were independent."""
    common: Floats
    """(n,) variance of what moves all radii together."""
    lean: float
    """Standard deviation of a slope that all have."""
    alike: float
    """How many neighbours err together."""
    pitch_m: float

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class _Curve:
    """A part's curve: radius at its middle and slope, or a sphere's centre and radius, with their covariance."""

    kind: PartKind
    middle_m: float
    numbers: Floats
    """(2,)"""
    covariance: Floats
    """(2, 2)"""

    def __post_init__(self) -> None:
        freeze(self)

    def radius_at(self, height_m: Floats) -> Floats:
        """Radii (N,) at heights (N,)."""
        if self.kind == "sphere":
            return np.sqrt(np.maximum(self.numbers[1] ** 2 - (height_m - self.numbers[0]) ** 2, 0.0))
        return self.numbers[0] + self.numbers[1] * (height_m - self.middle_m)


def parts_of(profile: Profile) -> tuple[Part, ...]:
    """The consecutive parts of the least cost along a profile, by dynamic programming; none without enough heights.

    A part costs the squared deviations of its radii over their variance, and a price for each number and each break.
    """
    heights = _counted(profile)
    if heights is None:
        return ()
    price = float(np.log(max(len(heights.height) / heights.alike, 2.0)))
    costs = np.stack([_misfit(kind, heights) + (FREE[kind] - 1) * (NUMBER_COST * price + CAUTION) for kind in KINDS])
    runs = _cheapest(costs.min(axis=0), BREAK_COST * price + CAUTION, SKIP_COST / heights.alike)
    best = costs.argmin(axis=0)
    curves = [_curve(KINDS[int(best[first, last])], heights, first, last) for first, last in runs]
    borders = [float(heights.height[first]) - heights.pitch_m / 2 for first, _ in runs[:1]]
    for (below, above), (lower, upper) in zip(pairwise(runs), pairwise(curves), strict=True):
        borders.append(_border(heights, (below[1] - 1, above[0]), lower, upper))
    borders += [float(heights.height[last - 1]) + heights.pitch_m / 2 for _, last in runs[-1:]]
    return tuple(_part(curve, low, high, heights) for curve, (low, high) in zip(curves, pairwise(borders), strict=True))


def _counted(profile: Profile) -> _Heights | None:
    """The heights of a profile without stray ones, with variances as large as the radii themselves show."""
    known = np.flatnonzero(profile.known)
    if len(known) < FEWEST:
        return None
    height, radius, own = profile.height_m[known], profile.radius_m[known], profile.own_m[known]
    pitch_m = float(np.median(np.diff(height)))
    alike = max(profile.alike_m / pitch_m, 1.0)
    own = own * _roughness(radius, own, int(np.ceil(alike)))
    padded = np.pad(radius, SMOOTHED, mode="edge")
    around = np.median(np.lib.stride_tricks.sliding_window_view(padded, 2 * SMOOTHED + 1), axis=1)
    kept = np.abs(radius - around) < STRAY * own
    if kept.sum() < FEWEST:
        return None
    reach = (profile.high_m - profile.low_m)[known] / (2 * NORMAL_95)
    common = np.maximum(reach**2 - profile.own_m[known] ** 2, 0.0)
    return _Heights(height[kept], radius[kept], alike * own[kept] ** 2, common[kept], profile.lean, alike, pitch_m)


def _roughness(radius: Floats, own: Floats, lag: int) -> float:
    """How much larger than own (n,) the deviations of radii (n,) from straight over two lags are, at least 1."""
    if len(radius) < 2 * lag + FEWEST:
        return 1.0
    bends = (radius[2 * lag :] - 2 * radius[lag:-lag] + radius[: -2 * lag]) / own[lag:-lag]
    return max(TO_SIGMA * float(np.median(np.abs(bends))) / float(np.sqrt(6.0)), 1.0)


def _misfit(kind: PartKind, heights: _Heights) -> Floats:
    """(n + 1, n + 1) least sum of squared deviations of the heights from the first of a run to before its last."""
    x, r = heights.height - heights.height.mean(), heights.radius
    if kind == "sphere":
        # r^2 + h^2 = 2 h h0 + (R^2 - h0^2) is linear in the centre's height and in the bracket
        return line_misfits(x, r**2 + x**2, 1.0 / (4 * r**2 * heights.variance), np.inf, True, FEWEST)
    # a slope that the axis' own error may have put there costs a cylinder as much as it is unlikely
    lean = heights.lean if kind == "cylinder" else np.inf
    return line_misfits(x, r - r.mean(), 1.0 / heights.variance, lean, False, FEWEST)


def _cheapest(cost: Floats, price: float, skip: float) -> list[tuple[int, int]]:
    """The cheapest runs, first and one past the last, of costs (n + 1, n + 1); each but the first has a price.

    A few heights before a run, and after the last, may be left out for `skip` each.
    """
    count = len(cost)
    best, before, first = cheapest_runs(cost, price, skip, MOST_SKIPPED)
    ends = np.arange(max(count - 1 - MOST_SKIPPED, 0), count)
    at = int(ends[np.argmin(best[ends] + skip * (count - 1 - ends))])
    runs: list[tuple[int, int]] = []
    while at > 0 and np.isfinite(best[at]):
        runs.append((int(first[at]), at))
        at = int(before[at])
    return runs[::-1]


def _curve(kind: PartKind, heights: _Heights, first: int, last: int) -> _Curve:
    """The curve of a kind through a run, by least squares."""
    height, radius, variance = (one[first:last] for one in (heights.height, heights.radius, heights.variance))
    weight, middle = 1.0 / variance, float(height[[0, -1]].mean())
    x = height - middle
    if kind == "cylinder":
        covariance = np.array([[1.0 / weight.sum(), 0.0], [0.0, 0.0]])
        return _Curve(kind, middle, np.array([np.average(radius, weights=weight), 0.0]), covariance)
    if kind == "cone":
        terms = np.stack([np.ones_like(x), x])
        covariance = np.asarray(np.linalg.pinv((terms * weight) @ terms.T, hermitian=True), dtype=np.float64)
        return _Curve(kind, middle, covariance @ (terms * weight) @ radius, covariance)
    terms = np.stack([np.ones_like(x), 2 * x]) / (2 * radius)
    covariance = np.asarray(np.linalg.pinv((terms * weight) @ terms.T, hermitian=True), dtype=np.float64)
    bracket, center = covariance @ (terms * weight) @ ((radius**2 + x**2) / (2 * radius))
    size = np.sqrt(max(bracket + center**2, 0.0))
    change = np.array([[0.0, 1.0], [0.5 / size, center / size]])
    return _Curve(kind, middle, np.array([middle + center, size]), change @ covariance @ change.T)


def _border(heights: _Heights, between: tuple[int, int], below: _Curve, above: _Curve) -> float:
    """Height at which one part gives way to the next: where they meet, if that is near, or half way between."""
    low, high = float(heights.height[between[0]]), float(heights.height[between[1]])
    reach = MEETING * heights.pitch_m
    height = np.linspace(low - reach, high + reach, 201)
    apart = below.radius_at(height) - above.radius_at(height)
    crossings = height[:-1][np.diff(np.sign(apart)) != 0]
    middle = (low + high) / 2
    return middle if len(crossings) == 0 else float(crossings[np.argmin(np.abs(crossings - middle))])


def _part(curve: _Curve, low_m: float, high_m: float, heights: _Heights) -> Part:
    inside = (heights.height >= low_m) & (heights.height <= high_m)
    common = float(heights.common[inside].mean()) if inside.any() else float(heights.common.mean())
    if curve.kind == "sphere":
        radius = float(curve.numbers[1])
        reach = NORMAL_95 * float(np.sqrt(curve.covariance[1, 1] + common))
        return Part("sphere", low_m, high_m, radius, (radius - reach, radius + reach), center_m=float(curve.numbers[0]))
    radius = float(curve.radius_at(np.array([(low_m + high_m) / 2]))[0])
    reach = NORMAL_95 * float(np.sqrt(curve.covariance[0, 0] + common))
    if curve.kind == "cylinder":
        return Part("cylinder", low_m, high_m, radius, (radius - reach, radius + reach))
    slope, lean = float(curve.numbers[1]), NORMAL_95 * float(np.sqrt(curve.covariance[1, 1] + heights.lean**2))
    return Part("cone", low_m, high_m, radius, (radius - reach, radius + reach), slope, (slope - lean, slope + lean))

"""The radius of each height about an axis, from the depths and the outline at that height alone."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.rays.losses import TO_SIGMA, robust_scale, tukey
from rotrecon.turned.looks import FAR, FEWEST_PIXELS, Grazes, Looks, medians

ROUNDS = 3
"""Reweightings: each at least halves what is left."""
AGREES, SOUND_SHARE = 3.0, 0.8
"""Sigmas within which a depth agrees with its height's radius, and the share of them that must."""
LEAST_SIGMA = 1e-9
"""Exact depth has no noise, but what is divided by it must stay finite."""


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
            mixed=np.stack([_totals(column * own, place, count) for column in weighted[:-1]]),
            own=_totals(weighted[-1] * own, place, count),
            own_pull=_totals(weighted[-1] * residual, place, count),
        )

    def times(self, share: float) -> "Sums":
        """A share of these."""
        return Sums(
            share * self.axis, share * self.axis_pull, share * self.mixed, share * self.own, share * self.own_pull
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
    """Of the sound heights."""
    residual: Floats
    """(N,) of the depths, in standard deviations of the noise; far off at rays that have no say."""
    sigma: float
    """Of the residuals of those that fit."""

    def __post_init__(self) -> None:
        freeze(self)


def height_radii(looks: Looks) -> HeightRadii:
    """The radii that explain the depths at each height best, by the redescending loss."""
    change = medians(looks.offset, looks.place, looks.count, FEWEST_PIXELS)
    for _ in range(ROUNDS):
        residual, columns = looks.rows(change)
        weighted = tukey(residual / _sigma(residual))[1] * columns[-1]
        info = _totals(weighted * columns[-1], looks.place, looks.count)
        change = change + _totals(weighted * residual, looks.place, looks.count) / np.maximum(info, 1e-300)
    residual, columns = looks.rows(change)
    sigma = _sigma(residual)
    agree, asked = np.abs(residual) < AGREES * sigma, residual < FAR
    agreeing, of = (np.bincount(looks.place[which], minlength=looks.count) for which in (agree, asked))
    sound = np.isfinite(change) & (agreeing >= FEWEST_PIXELS) & (agreeing > SOUND_SHARE * of)
    weight = tukey(residual / sigma)[1] * sound[looks.place] / sigma**2
    sums = Sums.of(residual, columns, weight, looks.place, looks.count)
    return HeightRadii(change, sound, sums, residual, sigma)


def with_outline(found: HeightRadii, independent: float, grazes: Grazes | None) -> HeightRadii:
    """The same with so large a share of the depths independent, and with an outline.

    Which heights are sound, and what the noise is, the depths say alone: about an axis that is off the two contradict.
    """
    sums = found.sums.times(independent)
    if grazes is not None:
        sums = sums.plus(_of_outline(grazes, found.change_m, found.sound))
    return replace(found, sums=sums, change_m=found.change_m + sums.own_pull / np.maximum(sums.own, 1e-300))


def _of_outline(grazes: Grazes, change_m: Floats, sound: Bools) -> Sums:
    """Normal equations of an outline; while it is far from where it belongs, it is believed as little as it fits."""
    off, columns = grazes.rows(change_m)
    scale = max(TO_SIGMA * float(np.median(np.abs(off))), 1.0) if len(off) else 1.0
    weight = tukey(off / scale)[1] * sound[grazes.place] / scale**2
    return Sums.of(off, columns, weight, grazes.place, len(sound))


def _sigma(residual: Floats) -> float:
    """Of the residuals (N,) that fit, of rays that have a say."""
    asked = residual[residual < FAR]
    return max(robust_scale(asked), LEAST_SIGMA) if len(asked) else LEAST_SIGMA


def _totals(values: Floats, place: Indices, count: int) -> Floats:
    """(count,) sums of values (N,) by their place (N,)."""
    return np.bincount(place, values, count).astype(np.float64)

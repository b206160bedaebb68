"""Many outcomes as the few figures that the tables hold."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.bench.accuracy.outcome import Outcome
from rotrecon.arrays import Floats

FAR_OFF = 0.1
"""Relative error above which a size counts as a failure."""


@dataclass(frozen=True)
class Errors:
    """Of what was measured, percent; NaN where nothing was."""

    bias: float
    rms: float


@dataclass(frozen=True)
class Coverage:
    """What 95 % intervals are worth."""

    count: int
    """Intervals."""
    covered: float
    """Share of them that hold the truth; NaN without any."""
    half_width: float
    """Median, percent."""
    percentile_95: float
    """Of the absolute errors, percent."""

    @property
    def wide(self) -> float:
        """Median half width over the 95th percentile: about 1 if honest."""
        return self.half_width / self.percentile_95


def errors(values: Floats) -> Errors:
    """Of relative errors (N,)."""
    known = 100 * values[np.isfinite(values)]
    if len(known) == 0:
        return Errors(np.nan, np.nan)
    return Errors(float(known.mean()), float(np.sqrt((known**2).mean())))


def rms_percent(values: Sequence[float]) -> float:
    """Root mean square of relative figures, percent."""
    return errors(np.array(values)).rms


def coverage(values: Floats, intervals: Floats) -> Coverage:
    """Of relative errors (N,) and their intervals (N, 2), both less the truth."""
    intervals = intervals.reshape(-1, 2)
    given = np.isfinite(intervals).all(axis=1)
    low, high = intervals[given].T
    if not given.any():
        return Coverage(0, np.nan, np.nan, np.nan)
    return Coverage(
        int(given.sum()),
        float(((low <= 0) & (high >= 0)).mean()),
        100 * float(np.median((high - low) / 2)),
        100 * float(np.percentile(np.abs(values[given]), 95)),
    )


def radii(outcomes: Sequence[Outcome]) -> Floats:
    """Relative errors (N,)."""
    return np.array([outcome.radius for outcome in outcomes])


def half_angles(outcomes: Sequence[Outcome]) -> Floats:
    """Relative errors (N,)."""
    return np.array([outcome.half_angle for outcome in outcomes])


def radius_coverage(outcomes: Sequence[Outcome]) -> Coverage:
    """Of the diameter's intervals."""
    stated = np.array([outcome.stated for outcome in outcomes])
    return coverage(stated, np.array([outcome.radius_interval for outcome in outcomes]))


def half_angle_coverage(outcomes: Sequence[Outcome]) -> Coverage:
    """Of the half angle's intervals."""
    return coverage(half_angles(outcomes), np.array([outcome.half_angle_interval for outcome in outcomes]))


def refused_share(outcomes: Sequence[Outcome]) -> float:
    """Share without a size."""
    return float(np.mean([outcome.refused for outcome in outcomes])) if outcomes else np.nan


def far_off_count(outcomes: Sequence[Outcome]) -> int:
    """How many sizes are more than a tenth off."""
    return int((np.abs(radii(outcomes)) > FAR_OFF).sum())

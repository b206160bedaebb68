"""How depth errs along the ray: the sensor's own statement of it, or what its own frame shows."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Cloud, Floats
from rotrecon.compiled import COUNT, MATRIX, compiled
from rotrecon.frame import DepthCameraNoise, DepthNoise, StereoNoise

LAGS_PX = np.array([1, 2, 3, 4, 6, 8])
"""Distances at which depth is compared with itself: errors of matched depth are alike over 5 to 12 px."""
CORRELATIONS_PX = np.array([0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0])
"""Correlation lengths that are told apart."""
QUIET_QUANTILE, QUIET_SIGMA = 0.4, 0.5244
"""Share of the differences that are taken to be noise alone, and its quantile of a normal distribution's magnitude: the
rest may be edges and outliers."""
FEWEST_DIFFERENCES = 50
"""Fewer say nothing of a lag."""
SMALLEST_STEP = 1e-9
"""Of inverse depth, 1/m: exact depth has no noise, but what is divided by it must stay finite."""


@dataclass(frozen=True)
class RayNoise:
    """Standard deviation of depth along z, sigma_z = floor_m + growth_per_m z^2, and how far its errors are alike.

    A stereo camera, which errs in disparity, has no floor and growth sigma_d / (f b).
    """

    floor_m: float
    growth_per_m: float
    correlation_px: float
    """Distance at which the autocorrelation is down to 1/e; 0 for errors that are independent."""
    stated: bool
    """By the scene; else estimated from its frame."""

    def sigma_m(self, depth_m: Floats | float) -> Floats:
        """Standard deviation (...) of depths (...)."""
        return self.floor_m + self.growth_per_m * np.square(np.asarray(depth_m, dtype=np.float64))

    def steps(self, depth_m: Floats) -> Floats:
        """Depths (...) counted in their own standard deviations: the integral of dz / sigma(z).

        Of a stereo camera it is negative disparity over its sigma, in which errors are the same at every depth.
        """
        if self.floor_m == 0.0:
            return -1.0 / self.growth_per_m / depth_m
        if self.growth_per_m == 0.0:
            return depth_m / self.floor_m
        root = np.sqrt(self.growth_per_m / self.floor_m)
        return np.arctan(root * depth_m) / (root * self.floor_m)


def noise_of(noise: DepthNoise | None, depth_m: Cloud, focal_px: float) -> RayNoise:
    """The noise of a patch (h, w) of a depth map, NaN where it is not valid.

    Its size is the scene's if that states one; it is estimated as a stereo camera's if not. How far errors are alike
    is always estimated. See `structure`.
    """
    sigma, correlation_px = structure(1.0 / depth_m.astype(np.float64))
    if isinstance(noise, DepthCameraNoise):
        return RayNoise(noise.sigma0_m, noise.sigma2_per_m, correlation_px, True)
    if isinstance(noise, StereoNoise):
        return RayNoise(0.0, noise.disparity_sigma_px / (focal_px * noise.baseline_m), correlation_px, True)
    return RayNoise(0.0, sigma, correlation_px, False)


def structure(values: Floats) -> tuple[float, float]:
    """Standard deviation and correlation length, px, of the noise on a smooth surface (h, w), NaN where unknown.

    Second differences over a lag l have the variance s^2 (6 - 8 r(l) + 2 r(2 l)) + a l^4, the autocorrelation
    r(l) = exp(-(l / c)^2) being the noise's and a l^4 the surface's; c, s and a are those that fit best.
    """
    variance = np.array([_second_difference_variance(values, lag) for lag in LAGS_PX])
    known = np.isfinite(variance)
    if known.sum() < 2 or variance[known].max() <= 0:
        return SMALLEST_STEP, 0.0
    lags, variance = LAGS_PX[known], np.maximum(variance[known], SMALLEST_STEP**2)
    best = (np.inf, 0.0, 0.0)
    for correlation in CORRELATIONS_PX:
        spread = 6.0 - 8.0 * _alike(lags, correlation) + 2.0 * _alike(2 * lags, correlation)
        noise, cost = _fit_structure(spread, lags.astype(np.float64) ** 4, variance)
        if cost < best[0]:
            best = (cost, noise, float(correlation))
    return max(float(np.sqrt(best[1])), SMALLEST_STEP), best[2]


def _fit_structure(spread: Floats, surface: Floats, variance: Floats) -> tuple[float, float]:
    """Noise variance, not negative, in variance = noise spread + a surface, by relative least squares; and its cost."""
    terms = np.stack([spread, surface], axis=1) / variance[:, None]
    solution, *_ = np.linalg.lstsq(terms, np.ones(len(variance)), rcond=None)
    if solution[1] < 0:
        solution = np.array([terms[:, 0].sum() / (terms[:, 0] ** 2).sum(), 0.0])
    solution = np.maximum(solution, 0.0)
    return float(solution[0]), float(((terms @ solution - 1.0) ** 2).sum())


def _alike(lag_px: Floats, correlation_px: float) -> Floats:
    return np.exp(-np.square(lag_px / correlation_px)) if correlation_px > 0 else np.zeros(len(lag_px))


def _second_difference_variance(values: Floats, lag: int) -> float:
    """Of quiet places, both ways; NaN when there are too few."""
    magnitude = _second_differences(np.ascontiguousarray(values), lag)
    if len(magnitude) < FEWEST_DIFFERENCES:
        return np.nan
    place = int(QUIET_QUANTILE * len(magnitude))
    return float(np.partition(magnitude, place)[place] / QUIET_SIGMA) ** 2


@compiled(MATRIX, COUNT)
def _second_differences(values: Floats, lag: int) -> Floats:
    """Magnitudes (N,) of the known second differences over a lag, down and across."""
    height, width = values.shape
    found, count = np.empty(2 * height * width), 0
    for row in range(height):
        for column in range(width):
            here = values[row, column]
            if lag <= row < height - lag:
                change = abs(values[row + lag, column] - 2 * here + values[row - lag, column])
                found[count] = change
                count += np.isfinite(change)
            if lag <= column < width - lag:
                change = abs(values[row, column + lag] - 2 * here + values[row, column - lag])
                found[count] = change
                count += np.isfinite(change)
    return found[:count]

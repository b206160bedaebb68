"""Depth of several pairs in the reference's pixels made one: what agrees is averaged, what disagrees is dropped."""

from collections.abc import Sequence

import numpy as np

from rotrecon.arrays import Cloud, Floats

AGREEING_SIGMAS = 3.0
"""Standard deviations of their difference that two depths of one surface may lie apart."""

SHARED = 0.5
"""Share of a disparity's variance that is the reference picture's: both pictures are as noisy."""


def fuse(inverse_depths: Sequence[Cloud], sigmas: Sequence[float]) -> Cloud:
    """Inverse depth (h, w), 1/m, of several pairs in the same pixels, NaN where there is none.

    `sigmas` are their standard deviations. In each pixel the largest group that agrees with one of its members is
    averaged, weighed by inverse variances; a pixel that one pair alone sees is kept, and one in which no two agree is
    not. The errors share the reference's picture: their mean errs by more than that of independent ones.
    """
    if len(inverse_depths) == 1:
        return inverse_depths[0]
    stack = np.stack(inverse_depths)
    variance = np.square(np.asarray(sigmas, dtype=np.float32))
    most = np.zeros(stack.shape[1:], dtype=np.float32)
    fused = np.full(stack.shape[1:], np.nan, dtype=np.float32)
    with np.errstate(invalid="ignore"):
        for pivot in np.argsort(variance):
            reach = AGREEING_SIGMAS * np.sqrt(variance + variance[pivot])
            agrees = np.abs(stack - stack[pivot]) <= reach[:, None, None]
            weight = agrees / variance[:, None, None]
            better = agrees.sum(axis=0) > most
            mean = np.nansum(stack * weight, axis=0) / np.maximum(weight.sum(axis=0), np.finfo(np.float32).tiny)
            fused[better] = mean[better]
            most = np.maximum(most, agrees.sum(axis=0))
    seen = np.isfinite(stack).sum(axis=0)
    fused[(seen > 1) & (most < 2)] = np.nan
    return fused


def fused_sigma(sigmas: Sequence[float], toward: Sequence[Floats]) -> float:
    """Standard deviation of the mean of inverse depths that `fuse` makes where all pairs agree.

    Half of a disparity's variance comes from the reference's picture, which all pairs share: it moves all of them alike
    where the other cameras stand in the same direction, `toward` (3,) unit each, and not where they stand at right
    angles.
    """
    sigma, directions = np.asarray(sigmas), np.stack(toward)
    weight = 1 / np.square(sigma)
    weight /= weight.sum()
    shared = SHARED * directions @ directions.T
    np.fill_diagonal(shared, 1.0)
    covariance = shared * np.outer(sigma, sigma)
    return float(np.sqrt(weight @ covariance @ weight))

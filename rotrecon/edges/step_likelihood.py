"""How likely colours seen across an outline are, if its two sides are Gaussian processes with a step between them."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.compiled import CUBE, MATRIX, NUMBA, VECTOR, compiled

SQUARE = NUMBA.types.Array(NUMBA.float64, 2, "C")
"""What the compiled function works on in place."""


@compiled(SQUARE)
def _root(covariance: Floats) -> float:
    """Turn a covariance (T, T) into its lower root (Cholesky); the logarithm of the root's determinant."""
    spread = 0.0
    for i in range(len(covariance)):
        for j in range(i + 1):
            left = covariance[i, j]
            for k in range(j):
                left -= covariance[i, k] * covariance[j, k]
            covariance[i, j] = np.sqrt(left) if i == j else left / covariance[j, j]
        spread += np.log(covariance[i, i])
    return spread


@compiled(MATRIX, SQUARE)
def _whiten(root: Floats, rest: Floats) -> None:
    """Solve root (T, T) x = rest (T, N) in place, from the first row down."""
    for i in range(len(root)):
        row = rest[i]
        for j in range(i):
            share, known = root[i, j], rest[j]
            for n in range(len(row)):
                row[n] -= share * known[n]
        for n in range(len(row)):
            row[n] /= root[i, i]


@compiled(MATRIX, CUBE, CUBE, MATRIX, CUBE, CUBE, VECTOR)
def log_likelihoods(
    inner: Floats, shape: Floats, seen: Floats, step: Floats, inner_: Floats, outer_: Floats, noise: Floats
) -> Floats:
    """Log-likelihoods (K, 3, N), by channel, of K steps, less what is common to all.

    `inner` (K, T) is the share of the object in every sample, `seen` (3, T, N) the colour less the background's level,
    `step` (3, N) with `shape` (3, K, T) the object's level over the background's, `inner_` and `outer_` (3, T, T) are
    the covariances of their textures, and `noise` (3,) is the variance of the camera's.
    """
    channels, samples, count = seen.shape
    found = np.zeros((len(inner), channels, count))
    covariance, rest = np.empty((samples, samples)), np.empty((samples, count))
    for k in range(len(inner)):
        for c in range(channels):
            for i in range(samples):
                here = inner[k, i]
                for j in range(i + 1):
                    there = inner[k, j]
                    covariance[i, j] = here * there * inner_[c, i, j] + (1 - here) * (1 - there) * outer_[c, i, j]
                covariance[i, i] += noise[c]
                for n in range(count):
                    rest[i, n] = seen[c, i, n] - here * (step[c, n] + shape[c, k, i])
            spread = _root(covariance)
            _whiten(covariance, rest)
            likely = found[k, c]
            for i in range(samples):
                for n in range(count):
                    likely[n] -= 0.5 * rest[i, n] * rest[i, n]
            for n in range(count):
                likely[n] -= spread
    return found

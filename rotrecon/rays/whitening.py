"""Depths freed of the errors they share with their neighbours: differences are told more finely than depths."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Floats, Indices, freeze
from rotrecon.compiled import MATRIX, NUMBA, VECTOR, compiled
from rotrecon.rays.correlation import Likeness
from rotrecon.rays.fitting import UNSCALED, Depths, Prediction
from rotrecon.rays.surfaces import Surface

EARLIER = ((0, -1), (0, -2), (-1, 0), (-1, -1), (-1, 1), (-2, 0))
"""Rows and columns from a pixel to those before it, whose errors foretell its own. With 14 instead of 6 sizes of wires
would err by a sixth less, with 2 by a fifth more (of simulated clouds)."""
BITS = 2 ** np.arange(len(EARLIER))[::-1]
"""By which a pattern of them that are there is numbered."""
LEAST_OWN = 0.1
"""Least share of a pixel's variance that no neighbour foretells: models of depth are no better than that."""
SHORTEST_PX = 1e-3
"""Of errors that are not alike at all."""
NEIGHBOURS = NUMBA.types.Array(NUMBA.int32, 2, "C", readonly=True)


@dataclass(frozen=True, eq=False)
class Whitened:
    """Depths of neighbouring pixels, each less what those before it foretell of its error.

    The inverse covariance of all is so approximated by that of each given a few (Vecchia 1988), which makes least
    squares of what is left the generalised ones of the depths (Aitken 1935).
    """

    depths: Depths
    """N of them."""
    likeness: Likeness
    """Of their errors."""
    earlier: NDArray[np.int32]
    """(N, 6) which of the N stand before each; any where there is none."""
    gain: Floats
    """(N,) by which what is left is scaled to be as large as before."""
    shares: Floats
    """(N, 6) of the earlier ones that are taken off, scaled like that; 0 where there is none."""

    def __post_init__(self) -> None:
        freeze(self)

    def predict(self, surface: Surface) -> Prediction:
        """Residuals and derivatives, less those foretold."""
        found = self.depths.predict(surface)
        every = np.concatenate([found.columns, found.residual[None]])
        left = _less_foretold(every, self.earlier, self.gain, self.shares)
        return Prediction(left[:-1], UNSCALED, left[-1])

    def returned(self, weights: Floats) -> Floats:
        """Weights (k, N) that depths have in sums of what is left of them with weights (k, N)."""
        return _returned(weights, self.earlier, self.gain, self.shares)


def whitened(depths: Depths, pixels: Indices, shape: tuple[int, int], likeness: Likeness) -> Whitened:
    """The depths of some pixels (N,) of a patch of a shape, whose errors are alike as the likeness has it."""
    place = np.full((shape[0] + 2, shape[1] + 4), -1, dtype=np.int32)
    row, column = np.divmod(pixels, shape[1])
    place[row + 2, column + 2] = np.arange(len(pixels), dtype=np.int32)
    earlier = np.stack([place[row + 2 + down, column + 2 + right] for down, right in EARLIER], axis=1)
    pattern = (earlier >= 0) @ BITS
    gain, shares = _foretelling(likeness)
    return Whitened(depths, likeness, np.maximum(earlier, 0), gain[pattern], shares[pattern])


def _foretelling(likeness: Likeness) -> tuple[Floats, Floats]:
    """Gains (64,) and shares (64, 6) of every pattern of neighbours: the regression of an error on theirs."""
    places = np.array([(0, 0), *EARLIER], dtype=np.float64)
    lag = np.linalg.norm(places[:, None] - places, axis=2) / max(likeness.length_px, SHORTEST_PX)
    alike = min(likeness.alike, 1.0 - LEAST_OWN)
    covariance = alike * np.exp(-np.square(lag)) + (1.0 - alike) * np.eye(len(places))
    there = np.indices((2,) * len(EARLIER)).reshape(len(EARLIER), -1).T.astype(np.float64)
    among = covariance[1:, 1:] * there[:, :, None] * there[:, None, :]
    among += np.eye(len(EARLIER)) * (1.0 - there)[:, None, :]
    with_it = covariance[0, 1:] * there
    shares = np.asarray(np.linalg.solve(among, with_it[:, :, None])[:, :, 0], dtype=np.float64)
    gain = 1.0 / np.sqrt(1.0 - (shares * with_it).sum(axis=1))
    return gain, shares * gain[:, None]


@compiled(MATRIX, NEIGHBOURS, VECTOR, MATRIX)
def _less_foretold(values: Floats, earlier: Indices, gain: Floats, shares: Floats) -> Floats:
    """Values (m, N) less what is foretold of each; see `Whitened`."""
    left = np.empty(values.shape)
    for line in range(values.shape[0]):
        for i in range(values.shape[1]):
            found = gain[i] * values[line, i]
            for k in range(earlier.shape[1]):
                found -= shares[i, k] * values[line, earlier[i, k]]
            left[line, i] = found
    return left


@compiled(MATRIX, NEIGHBOURS, VECTOR, MATRIX)
def _returned(weights: Floats, earlier: Indices, gain: Floats, shares: Floats) -> Floats:
    """The transposed of `_less_foretold`, of weights (k, N)."""
    total = np.zeros(weights.shape)
    for line in range(weights.shape[0]):
        for i in range(weights.shape[1]):
            total[line, i] += gain[i] * weights[line, i]
            for k in range(earlier.shape[1]):
                total[line, earlier[i, k]] -= shares[i, k] * weights[line, i]
    return total

"""How far neighbouring residuals err together, which says how many of them are independent."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Floats
from rotrecon.compiled import MATRIX, compiled

LAGS = (1, 2, 4, 7, 12)
"""Distances, px, at which residuals are compared."""
LENGTHS_PX = np.array([0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0])
"""Correlation lengths that are told apart."""
FEWEST_PAIRS = 30
"""Fewer say nothing of a lag."""
SIGNIFICANT = 3.0
"""Standard deviations below which a likeness is one by chance: a small one over a long way would count for much."""


@dataclass(frozen=True)
class Likeness:
    """Autocorrelation alike exp(-(lag / length)^2) at lags above 0, and 1 at lag 0."""

    alike: float
    """From 0 for independent errors to 1 for errors without any independent part."""
    length_px: float

    @property
    def independent_share(self) -> float:
        """Independent measurements a pixel, of a plane full of them: 1 over the sum of the autocorrelation."""
        return 1.0 / (1.0 + self.alike * max(np.pi * self.length_px**2 - 1.0, 0.0))

    def smeared(self, image: Floats) -> Floats:
        """An image (h, w) convolved with the autocorrelation."""
        if self.alike == 0.0:
            return image
        half = int(np.ceil(2.5 * self.length_px))
        lag = np.arange(-half, half + 1)
        kernel = np.exp(-np.square(lag / self.length_px))
        together = cv2.sepFilter2D(image.astype(np.float32), -1, kernel, kernel, borderType=cv2.BORDER_CONSTANT)
        return self.alike * np.asarray(together, dtype=np.float64) + (1.0 - self.alike) * image


def likeness_of(residual: Floats) -> Likeness:
    """The likeness of residuals (h, w), NaN where there is none."""
    variance, total, pairs = _products(residual)
    told = (pairs >= FEWEST_PAIRS) & (variance > 0)
    lags, pairs = np.array(LAGS, dtype=np.float64)[told], pairs[told]
    return _fitted(lags, total[told] / pairs / variance, 1.0 / pairs)


@compiled(MATRIX)
def _products(residual: Floats) -> tuple[float, Floats, Floats]:
    """Mean square of residuals (h, w), sums of the products of those each lag apart, and how many they are."""
    height, width = residual.shape
    square, count = 0.0, 0
    total, pairs = np.zeros(len(LAGS)), np.zeros(len(LAGS))
    for row in range(height):
        for column in range(width):
            here = residual[row, column]
            if np.isnan(here):
                continue
            square += here * here
            count += 1
            for number, lag in enumerate(LAGS):
                if row + lag < height and not np.isnan(residual[row + lag, column]):
                    total[number] += here * residual[row + lag, column]
                    pairs[number] += 1
                if column + lag < width and not np.isnan(residual[row, column + lag]):
                    total[number] += here * residual[row, column + lag]
                    pairs[number] += 1
    return square / max(count, 1), total, pairs


def _fitted(lags: Floats, alike: Floats, chance: Floats) -> Likeness:
    """The likeness that explains what is alike at some lags, each with the variance that it has by chance."""
    if len(lags) == 0:
        return Likeness(0.0, 0.0)
    shapes = np.exp(-np.square(lags / LENGTHS_PX[:, None]))
    squares = np.maximum((shapes**2).sum(axis=1), np.finfo(float).tiny)
    share = (shapes @ alike / squares).clip(0.0, 1.0)
    # a single lag is explained by every length: of equals the shortest, not whichever the last digit favours
    best = int(np.square(alike - share[:, None] * shapes).sum(axis=1).round(12).argmin())
    if share[best] < SIGNIFICANT * np.sqrt((shapes[best] ** 2 * chance).sum()) / squares[best]:
        return Likeness(0.0, 0.0)
    return Likeness(float(share[best]), float(LENGTHS_PX[best]))

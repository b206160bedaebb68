"""A picture between its pixels: cubic splines, with their derivatives."""

from dataclasses import dataclass
from typing import Any, cast

import cv2
import numpy as np
from scipy import ndimage  # pyright: ignore[reportMissingTypeStubs]

from rotrecon.arrays import Bools, Bytes, Floats, freeze
from rotrecon.compiled import FLOAT, MATRIX, NUMBA, VECTOR, compiled

SCIPY = cast(Any, ndimage)
"""It comes without types."""
SUPPORT_PX = 3.0
"""Distance from a picture's border within which a spline knows what is beyond only by mirroring."""
LUMA = np.array([0.299, 0.587, 0.114])
"""Of red, green and blue in grey (ITU-R BT.601), which is about how many of a sensor's pixels see each."""
SMOOTHING_REACH = 4.0
"""Standard deviations after which a low pass has nothing left to take a mean of."""
NO_SMOOTHING_PX = 1e-9
"""A low pass of less does nothing."""
MUTABLE = NUMBA.types.Array(NUMBA.float64, 1, "C")
"""An array without gaps, which the compiled function fills."""


@compiled(FLOAT, MUTABLE, MUTABLE)
def _weights(part: float, value: Floats, slope: Floats) -> None:
    """Values and derivatives (4,) of the four B-splines that reach a place, at a part of the way to the next pixel."""
    rest = 1.0 - part
    value[0], value[3] = rest**3 / 6.0, part**3 / 6.0
    value[1], value[2] = 2.0 / 3.0 - part**2 * (2.0 - part) / 2.0, 2.0 / 3.0 - rest**2 * (2.0 - rest) / 2.0
    slope[0], slope[3] = -(rest**2) / 2.0, part**2 / 2.0
    slope[1], slope[2] = part * (1.5 * part - 2.0), rest * (2.0 - 1.5 * rest)


@dataclass(frozen=True, eq=False)
class Sampled:
    """Grey values and their derivatives at places of a picture."""

    grey: Floats
    """(N,)"""
    by_u: Floats
    """(N,) grey a pixel."""
    by_v: Floats


@dataclass(frozen=True, eq=False)
class Spline:
    """The cubic spline through the grey values of a rectangle of a picture (Unser 1999).

    The derivative is the spline's own, which scipy's `map_coordinates` does not give.
    """

    coefficients: Floats
    """(h, w) of the B-splines."""
    corner_px: Floats
    """(2,) u and v of the rectangle's first pixel."""

    def __post_init__(self) -> None:
        freeze(self)

    def within(self, place_px: Floats) -> Bools:
        """Which places (2, N) are far enough inside to be sampled."""
        place = place_px - self.corner_px[:, None]
        limits = np.array(self.coefficients.shape[::-1])[:, None] - 1 - SUPPORT_PX
        with np.errstate(invalid="ignore"):
            inside: Bools = (place >= SUPPORT_PX) & (place <= limits)
        return inside[0] & inside[1]

    def at(self, place_px: Floats) -> Sampled:
        """Grey values at places (2, N); those that are not within the rectangle count as its border."""
        return Sampled(*_sampled(self.coefficients, np.ascontiguousarray(place_px), self.corner_px))


def spline_of(image: Bytes, low_px: Floats, high_px: Floats, smoothing_px: float) -> Spline:
    """The spline of the part of a picture (H, W, 3) from one place (2,) to another and a little around it.

    `smoothing_px` is the standard deviation of a low pass that comes before.
    """
    border = 2 * SUPPORT_PX + 4 * smoothing_px
    size = np.array(image.shape[1::-1])
    low = np.clip(np.floor(low_px - border), 0, size - 1).astype(np.int64)
    high = np.clip(np.ceil(high_px + border), 0, size - 1).astype(np.int64) + 1
    grey = smoothed(image[low[1] : high[1], low[0] : high[0]], smoothing_px)
    return spline_through(grey, low.astype(np.float64))


def spline_through(grey: Floats, corner_px: Floats) -> Spline:
    """The spline of grey values (h, w) of which the first stands at (2,)."""
    return Spline(SCIPY.spline_filter(grey), corner_px)


def smoothed(image: Bytes, smoothing_px: float) -> Floats:
    """Grey values (h, w) of a picture (h, w, 3) after a low pass of a standard deviation."""
    lag = np.arange(smoothing_reach(smoothing_px) + 1)
    half = np.exp(-np.square(lag / max(smoothing_px, NO_SMOOTHING_PX)) / 2)
    kernel = np.concatenate([half[:0:-1], half]) / (2 * half.sum() - half[0])
    grey = cv2.transform(image.astype(np.float64), LUMA[None])
    return np.asarray(cv2.sepFilter2D(grey, -1, kernel, kernel, borderType=cv2.BORDER_REFLECT), dtype=np.float64)


def smoothing_reach(smoothing_px: float) -> int:
    """Pixels to each side over which a low pass of a standard deviation takes its mean."""
    return round(SMOOTHING_REACH * smoothing_px)


@compiled(MATRIX, MATRIX, VECTOR)
def _sampled(coefficients: Floats, place_px: Floats, corner_px: Floats) -> tuple[Floats, Floats, Floats]:
    """See `Spline.at`."""
    height, width = coefficients.shape
    count = place_px.shape[1]
    grey, by_u, by_v = np.zeros(count), np.zeros(count), np.zeros(count)
    value, slope = np.empty((2, 4)), np.empty((2, 4))
    first = np.empty(2, np.int64)
    for i in range(count):
        for axis in range(2):
            last = (height if axis else width) - 3.0
            place = place_px[axis, i] - corner_px[axis]
            place = 1.0 if np.isnan(place) else min(max(place, 1.0), last)
            floor = min(np.floor(place), last - 1.0)
            first[axis] = int(floor) - 1
            _weights(place - floor, value[axis], slope[axis])
        for row in range(4):
            line = coefficients[first[1] + row]
            here, change = 0.0, 0.0
            for column in range(4):
                knot = line[first[0] + column]
                here += value[0, column] * knot
                change += slope[0, column] * knot
            grey[i] += value[1, row] * here
            by_u[i] += value[1, row] * change
            by_v[i] += slope[1, row] * here
    return grey, by_u, by_v

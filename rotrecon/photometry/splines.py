"""A picture between its pixels: cubic splines, with their derivatives."""

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from scipy import ndimage  # pyright: ignore[reportMissingTypeStubs]

from rotrecon.arrays import Bools, Bytes, Floats, freeze

SCIPY = cast(Any, ndimage)
"""It comes without types."""
SUPPORT_PX = 3.0
"""Distance from a picture's border within which a spline knows what is beyond only by mirroring."""
LUMA = np.array([0.299, 0.587, 0.114])
"""Of red, green and blue in grey (ITU-R BT.601), which is about how many of a sensor's pixels see each."""


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
        height, width = self.coefficients.shape
        limits = np.array([[width - 3], [height - 3]], dtype=np.float64)
        place = np.clip(np.nan_to_num(place_px - self.corner_px[:, None]), 1.0, limits)
        floor = np.minimum(np.floor(place), limits - 1)
        (across, across_slope), (down, down_slope) = (_weights(part) for part in place - floor)
        first = ((floor[1] - 1) * width + floor[0] - 1).astype(np.int64)
        flat = self.coefficients.ravel()
        grey, by_u, by_v = np.zeros((3, place.shape[1]))
        for row in range(4):
            knots = [flat[first + (row * width + column)] for column in range(4)]
            value = sum(weight * knot for weight, knot in zip(across, knots, strict=True))
            slope = sum(weight * knot for weight, knot in zip(across_slope, knots, strict=True))
            grey += down[row] * value
            by_u += down[row] * slope
            by_v += down_slope[row] * value
        return Sampled(grey, by_u, by_v)


def spline_of(image: Bytes, low_px: Floats, high_px: Floats, smoothing_px: float) -> Spline:
    """The spline of the part of a picture (H, W, 3) from one place (2,) to another and a little around it.

    `smoothing_px` is the standard deviation of a low pass that comes before.
    """
    border = 2 * SUPPORT_PX + 4 * smoothing_px
    size = np.array(image.shape[1::-1])
    low = np.clip(np.floor(low_px - border), 0, size - 1).astype(np.int64)
    high = np.clip(np.ceil(high_px + border), 0, size - 1).astype(np.int64) + 1
    grey = smoothed(image[low[1] : high[1], low[0] : high[0]], smoothing_px)
    return Spline(SCIPY.spline_filter(grey), low.astype(np.float64))


def smoothed(image: Bytes, smoothing_px: float) -> Floats:
    """Grey values (h, w) of a picture (h, w, 3) after a low pass of a standard deviation."""
    return SCIPY.gaussian_filter(image.astype(np.float64) @ LUMA, smoothing_px)


def _weights(part: Floats) -> tuple[Floats, Floats]:
    """Values and derivatives (4, N) of the four B-splines that reach a place, at a part (N,) of the way to the next."""
    rest = 1.0 - part
    value = np.stack(
        [
            rest**3 / 6.0,
            2.0 / 3.0 - part**2 * (2.0 - part) / 2.0,
            2.0 / 3.0 - rest**2 * (2.0 - rest) / 2.0,
            part**3 / 6.0,
        ]
    )
    slope = np.stack([-(rest**2) / 2.0, part * (1.5 * part - 2.0), rest * (2.0 - 1.5 * rest), part**2 / 2.0])
    return value, slope

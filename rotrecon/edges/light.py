"""Linear light of a picture, at its pixels and between them."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bytes, Floats, freeze
from rotrecon.compiled import COUNT, CUBE, FLOAT, MATRIX, NUMBA, VECTOR, compiled

POLE = float(np.sqrt(3)) - 2
"""Of the recursive filter that gives a cubic spline's coefficients, of gain 6 (Unser 1999, box 2)."""
MIRRORED = 32
"""Pixels before the first that the filter looks back on: of any farther off, less than rounding is left."""
PICTURE = NUMBA.types.Array(NUMBA.uint8, 3, "A", readonly=True)
"""Of bytes, perhaps a part of a larger one."""
ROWS = NUMBA.types.Array(NUMBA.float64, 2, "C")
"""What the compiled function works on in place."""


def _decoded() -> Floats:
    encoded = np.arange(256) / 255.0
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


LINEAR_LIGHT = _decoded()
"""Of sRGB values (IEC 61966-2-1): a pixel that shows two things is their mean in light, not in display values."""


@dataclass(frozen=True, eq=False)
class LightSpline:
    """The cubic splines through the linear light of a picture, all colours at once."""

    coefficients: Floats
    """(h, w, 3) of the B-splines."""

    def __post_init__(self) -> None:
        freeze(self)

    @staticmethod
    def of(image: Bytes) -> "LightSpline":
        """Of an sRGB picture (h, w, 3), mirrored at its borders."""
        return LightSpline(_coefficients(image, LINEAR_LIGHT))

    def across(self, point_px: Floats, normal_px: Floats, offset_px: Floats, across_px: Floats) -> Floats:
        """Light (3, T, N) at distances (T,) along normals (N, 2) from points (N, 2) that are moved by offsets (N,)."""
        return _across(self.coefficients, point_px, normal_px, offset_px, across_px)


@compiled(COUNT, COUNT)
def _mirrored(place: int, count: int) -> int:
    """Which of so many pixels is seen at a place, not negative, where their row goes on mirrored at its end."""
    place = place % (2 * count - 2)
    return min(place, 2 * count - 2 - place)


@compiled(ROWS)
def _filter_down(values: Floats) -> None:
    """Turn the columns of values (n, M), mirrored at their ends, into a sixth of the coefficients of their splines."""
    count, width = values.shape
    first = values[0].copy()
    for lag in range(1, MIRRORED):
        mirrored, share = values[_mirrored(lag, count)], POLE**lag
        for column in range(width):
            first[column] += share * mirrored[column]
    values[0] = first
    for row in range(1, count):
        before, here = values[row - 1], values[row]
        for column in range(width):
            here[column] += POLE * before[column]
    before, last = values[count - 2], values[count - 1]
    for column in range(width):
        last[column] = POLE / (POLE * POLE - 1) * (last[column] + POLE * before[column])
    for row in range(count - 2, -1, -1):
        here, after = values[row], values[row + 1]
        for column in range(width):
            here[column] = POLE * (after[column] - here[column])


@compiled(PICTURE, VECTOR)
def _coefficients(image: Bytes, light: Floats) -> Floats:
    """Coefficients (h, w, 3) of the splines through the light (256,) of a picture's values (h, w, 3)."""
    height, width, _ = image.shape
    found = np.empty((height, width, 3))
    for row in range(height):
        for column in range(width):
            for channel in range(3):
                found[row, column, channel] = 6.0 * 6.0 * light[image[row, column, channel]]
    _filter_down(found.reshape(height, width * 3))
    for row in range(height):
        _filter_down(found[row])
    return found


@compiled(FLOAT)
def _weights(part: float) -> tuple[float, float, float, float]:
    """The four B-splines that reach a place, at a part of the way to the next pixel."""
    rest = 1.0 - part
    second, third = 2.0 / 3.0 - part**2 * (2.0 - part) / 2.0, 2.0 / 3.0 - rest**2 * (2.0 - rest) / 2.0
    return rest**3 / 6.0, second, third, part**3 / 6.0


@compiled(CUBE, MATRIX, MATRIX, VECTOR, VECTOR)
def _across(coefficients: Floats, point_px: Floats, normal_px: Floats, offset_px: Floats, across_px: Floats) -> Floats:
    """See `LightSpline.across`; beyond the border its coefficients go on."""
    height, width, _ = coefficients.shape
    light = np.zeros((3, len(across_px), len(offset_px)))
    for t in range(len(across_px)):
        for n in range(len(offset_px)):
            distance = offset_px[n] + across_px[t]
            u, v = point_px[n, 0] + distance * normal_px[n, 0], point_px[n, 1] + distance * normal_px[n, 1]
            left, top = int(np.floor(u)), int(np.floor(v))
            by_column = _weights(u - left)
            for i, by_row in enumerate(_weights(v - top)):
                line = coefficients[min(max(top - 1 + i, 0), height - 1)]
                for j in range(4):
                    knot, weight = line[min(max(left - 1 + j, 0), width - 1)], by_row * by_column[j]
                    for channel in range(3):
                        light[channel, t, n] += weight * knot[channel]
    return light

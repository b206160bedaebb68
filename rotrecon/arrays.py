"""The array types that stages pass to each other, and how they are made read-only."""

from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

Scalar = TypeVar("Scalar", bound=np.generic)
Floats = NDArray[np.float64]
"""Positions, directions, poses and results."""
Cloud = NDArray[np.float32]
"""Clouds and depth maps: a sensor's digits, at half the memory."""
Bools = NDArray[np.bool_]
Indices = NDArray[np.int32]
Bytes = NDArray[np.uint8]

BLOCK = 32768
"""Rows worked on at once where temporaries would be many times the result; they stay in the processor's cache."""
STRIP_ROWS = 16
"""Rows of a picture worked on at once: temporaries stay small beside it."""


def blocks(rows: NDArray[Scalar]) -> list[NDArray[Scalar]]:
    """An array cut into pieces of at most `BLOCK` rows."""
    return np.array_split(rows, 1 + len(rows) // BLOCK)


def strips(height: int) -> list[tuple[int, int]]:
    """The rows of a picture, first and end of each strip."""
    return [(top, min(top + STRIP_ROWS, height)) for top in range(0, height, STRIP_ROWS)]


def freeze(record: Any) -> None:
    """Make every array held by a frozen dataclass read-only; called from its `__post_init__`."""
    for value in cast("dict[str, Any]", vars(record)).values():
        if isinstance(value, np.ndarray):
            cast("NDArray[Any]", value).setflags(write=False)

"""A cloud as a file holds it, before it is put behind the pixels of a camera."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bytes, Cloud, freeze
from rotrecon.scene.formats.depth_limits import FARTHEST_M, check_depth
from rotrecon.scene.formats.source import SourceFile


@dataclass(frozen=True, eq=False)
class RawCloud:
    """Points in camera coordinates, NaN in all three where a point is not valid."""

    points_m: Cloud
    """(height, width, 3) when organised, else (n, 3)."""
    colors: Bytes | None
    """RGB of the same shape, or None."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def organised(self) -> bool:
        """Whether the points keep the raster of the camera that saw them."""
        return self.points_m.ndim == 3


def make_cloud(source: SourceFile, points_m: NDArray[Any], colors: NDArray[Any] | None) -> RawCloud:
    """A cloud of (..., 3) points whose invalid ones are NaN; raises SceneError when none is valid."""
    with np.errstate(over="ignore"):
        points = np.array(points_m, dtype=np.float32)
    invalid = ~np.isfinite(points).all(axis=-1) | ~(points[..., 2] > 0)
    points[invalid] = np.nan
    check_depth(source, points[..., 2])
    points[(np.abs(points) > FARTHEST_M).any(axis=-1)] = np.nan
    return RawCloud(points, None if colors is None else np.array(colors, dtype=np.uint8))


def unpack_rgb(packed: NDArray[Any]) -> Bytes:
    """RGB (..., 3) of colours packed as 0xAARRGGBB, in integers or in the bit pattern of floats."""
    if packed.dtype.kind == "f":
        packed = np.ascontiguousarray(packed, dtype=packed.dtype.newbyteorder("=")).view(np.uint32)
    bits = packed.astype(np.uint32)
    return np.stack([bits >> 16 & 255, bits >> 8 & 255, bits & 255], axis=-1).astype(np.uint8)

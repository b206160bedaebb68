"""Depth maps: NPZ in metres, or 16-bit PNG in counts."""

import numpy as np

from rotrecon.arrays import Cloud
from rotrecon.scene.formats.depth_limits import FARTHEST_M, check_depth
from rotrecon.scene.formats.image import read_raw_image
from rotrecon.scene.formats.npz import read_array
from rotrecon.scene.formats.source import SourceFile

_PNG_INVALID = (0, 65535)


def read_depth(source: SourceFile, depth_scale: float | None) -> Cloud:
    """Read a depth map as (height, width) float32 metres along z, NaN where it is not valid; raises SceneError.

    `depth_scale` is the metres of one count of a PNG; an NPZ is in metres already and takes none.
    """
    if source.ending == ".npz":
        depth = _read_npz(source, depth_scale)
    elif source.ending == ".png":
        depth = _read_png(source, depth_scale)
    else:
        raise source.error(
            f"has the unknown ending {source.path.suffix!r}", "save depth as .npz (depth_m) or 16-bit .png"
        )
    depth[~(np.isfinite(depth) & (depth > 0))] = np.nan
    check_depth(source, depth)
    depth[depth > FARTHEST_M] = np.nan
    return depth


def _read_npz(source: SourceFile, depth_scale: float | None) -> Cloud:
    if depth_scale is not None:
        raise source.error("is in metres and takes no depth_scale", "leave depth_scale out, or give a 16-bit PNG")
    stored = read_array(source, "depth_m")
    if stored.ndim != 2 or stored.dtype.kind != "f":
        raise source.error(
            f"has depth_m of shape {stored.shape} and type {stored.dtype}",
            "save floats in metres of shape (height, width)",
        )
    with np.errstate(over="ignore"):
        return np.array(stored, dtype=np.float32)


def _read_png(source: SourceFile, depth_scale: float | None) -> Cloud:
    if depth_scale is None:
        raise source.error("is a PNG without depth_scale", "give the metres of one count, such as depth_scale = 0.001")
    stored = read_raw_image(source)
    if stored.ndim != 2 or stored.dtype != np.uint16:
        raise source.error(f"has shape {stored.shape} and type {stored.dtype}", "save depth as a 16-bit grey PNG")
    depth = (stored * np.float64(depth_scale)).astype(np.float32)
    depth[np.isin(stored, _PNG_INVALID)] = np.nan
    return depth

"""NumPy archives: arrays by name, never pickled ones."""

import math
import zipfile
from io import BytesIO
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from rotrecon.scene.formats.cloud import RawCloud, make_cloud
from rotrecon.scene.formats.source import SourceFile


def read_array(source: SourceFile, name: str) -> NDArray[Any]:
    """Read the numeric array `name` of an NPZ file, in any shape and type; raises SceneError."""
    array = _read_arrays(source, (name,)).get(name)
    if array is None:
        raise source.error(f"has no array {name}", f"save the array under the name {name} with numpy.savez")
    return array


def read_npz_cloud(source: SourceFile) -> RawCloud:
    """Read `points_m` (H, W, 3), and `colors` (H, W, 3) uint8 if there is one; raises SceneError."""
    arrays = _read_arrays(source, ("points_m", "colors"))
    points, colors = arrays.get("points_m"), arrays.get("colors")
    if points is None:
        raise source.error("has no array points_m", "save the cloud under the name points_m")
    if points.ndim not in (2, 3) or points.shape[-1] != 3 or points.dtype.kind != "f":
        raise source.error(
            f"has points_m of shape {points.shape} and type {points.dtype}",
            "save floats in metres of shape (height, width, 3)",
        )
    if colors is not None and (colors.shape != points.shape or colors.dtype != np.uint8):
        raise source.error(
            f"has colors of shape {colors.shape} and type {colors.dtype} for points_m of shape {points.shape}",
            "save colors as uint8 RGB of the shape of points_m",
        )
    return make_cloud(source, points, colors)


def encode_npz(**arrays: NDArray[Any]) -> bytes:
    """Arrays by name as the bytes of a compressed NPZ file."""
    content = BytesIO()
    np.savez_compressed(content, allow_pickle=False, **arrays)
    return content.getvalue()


def _read_arrays(source: SourceFile, names: tuple[str, ...]) -> dict[str, NDArray[Any]]:
    content = source.read_bytes()
    try:
        archive = zipfile.ZipFile(BytesIO(content))
    except Exception as failure:
        raise source.error(
            "is not an NPZ archive, or is truncated", "copy it again, or save it with numpy.savez"
        ) from failure
    with archive:
        members = set(archive.namelist())
        return {name: _read_member(source, archive, name) for name in names if f"{name}.npy" in members}


def _read_member(source: SourceFile, archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    damaged = source.error(f"has a damaged array {name}", "copy or record it again")
    try:
        with archive.open(f"{name}.npy") as member:
            shape, dtype = _announced(member)
    except Exception as failure:
        raise damaged from failure
    if dtype.hasobject:
        raise source.error(
            f"has a pickled array {name}, and pickles are never loaded", "save plain numbers with numpy.savez"
        )
    channels = shape[-1] if len(shape) == 3 else 1
    source.check_count(math.prod(shape) // max(channels, 1), f"pixels in {name}")
    try:
        with archive.open(f"{name}.npy") as member:
            return npy.read_array(member, allow_pickle=False)
    except Exception as failure:
        raise damaged from failure


def _announced(member: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[Any]]:
    version = npy.read_magic(member)
    read_header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, dtype = read_header(member)
    return shape, dtype

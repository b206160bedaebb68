"""PCD clouds in their three encodings; the VIEWPOINT line is not applied, points are in camera coordinates."""

import re
from io import BufferedReader, BytesIO
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from pypcd4.pypcd4 import Encoding, MetaData, PointCloud

from rotrecon.arrays import Bytes
from rotrecon.scene.formats.cloud import RawCloud, make_cloud, unpack_rgb
from rotrecon.scene.formats.source import SourceFile

_END_OF_HEADER = re.compile(rb"^DATA[ \t]+\w+[ \t]*\r?\n", re.MULTILINE)


def read_pcd(source: SourceFile) -> RawCloud:
    """Read a PCD file, organised when its HEIGHT is above 1, with its rgb or rgba; raises SceneError."""
    content = source.read_bytes()
    end = _END_OF_HEADER.search(content)
    if end is None:
        raise source.error("is not a PCD file, or is cut off in its header", "copy or record it again")
    metadata = _read_header(source, content[: end.end()])
    body = content[end.end() :]
    _check_body(source, metadata, body)
    if metadata.data == Encoding.ASCII:
        # Read as doubles: colours may be written as integers that a float32 cannot hold.
        count = len(metadata.fields)
        metadata = metadata.derive(type=("F",) * count, size=(8,) * count)
    try:
        stream = cast(BufferedReader, BytesIO(metadata.compose_header().encode() + body))
        file: Any = PointCloud.from_fileobj(stream)
        stored = np.atleast_1d(cast(NDArray[Any], file.pc_data))
    except Exception as failure:
        raise _truncated(source) from failure
    if len(stored) != metadata.points:
        raise _truncated(source)
    return _arrange(source, stored, metadata)


def _read_header(source: SourceFile, header: bytes) -> MetaData:
    try:
        metadata = MetaData.parse_header(header.decode().splitlines())
        metadata.build_dtype()
    except Exception as failure:
        raise source.error(
            "has a PCD header that cannot be read", "save it again as PCD 0.7 with FIELDS, SIZE, TYPE and COUNT"
        ) from failure
    if metadata.width * metadata.height != metadata.points or metadata.points == 0:
        raise source.error(
            f"has a header with WIDTH {metadata.width}, HEIGHT {metadata.height} and POINTS {metadata.points}",
            "correct the header so that WIDTH times HEIGHT is POINTS and not zero",
        )
    if not {"x", "y", "z"} <= set(metadata.fields):
        raise source.error(f"has the FIELDS {', '.join(metadata.fields)}", "save it with x, y and z")
    source.check_count(metadata.points, "points")
    return metadata


def _check_body(source: SourceFile, metadata: MetaData, body: bytes) -> None:
    """Compare what the header announces with what is there, before memory is taken for it."""
    needed = metadata.points * metadata.build_dtype().itemsize
    if metadata.data == Encoding.ASCII:
        complete = len(body) >= 2 * metadata.points * len(metadata.fields) - 1
    elif metadata.data == Encoding.BINARY:
        complete = len(body) >= needed
    else:
        stored, unpacked = int.from_bytes(body[:4], "little"), int.from_bytes(body[4:8], "little")
        complete = len(body) >= 8 + stored and unpacked == needed
    if not complete:
        raise _truncated(source)


def _truncated(source: SourceFile) -> Exception:
    return source.error("is truncated or damaged after its PCD header", "copy or record it again")


def _arrange(source: SourceFile, stored: NDArray[Any], metadata: MetaData) -> RawCloud:
    points = np.stack([stored["x"], stored["y"], stored["z"]], axis=-1)
    colors = _colors(stored, metadata)
    if metadata.height > 1:
        shape = (metadata.height, metadata.width, 3)
        points = points.reshape(shape)
        colors = None if colors is None else colors.reshape(shape)
    return make_cloud(source, points, colors)


def _colors(stored: NDArray[Any], metadata: MetaData) -> Bytes | None:
    name = next((name for name in ("rgb", "rgba") if name in metadata.fields), None)
    if name is None:
        return None
    packed: NDArray[Any] = stored[name]
    if packed.dtype == np.float64:
        # Of the two ways to write a colour in ASCII, the number it is and the float of its bits, only the
        # first is ever 1 or more.
        as_floats = packed.astype(np.float32)
        as_numbers = np.where(packed >= 1, packed, 0).astype(np.uint32)
        return np.where((packed >= 1)[:, None], unpack_rgb(as_numbers), unpack_rgb(as_floats))
    return unpack_rgb(packed)

"""PLY clouds, organised when the file says so in one of the usual ways."""

import re
from io import BytesIO
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData  # pyright: ignore[reportMissingTypeStubs]

from rotrecon.arrays import Bytes
from rotrecon.scene.formats.cloud import RawCloud, make_cloud
from rotrecon.scene.formats.source import SourceFile

_END_OF_HEADER = re.compile(rb"^end_header\r?\n", re.MULTILINE)
_ELEMENT = re.compile(rb"^element\s+(\w+)\s+(\d+)\s*$", re.MULTILINE)


def read_ply(source: SourceFile) -> RawCloud:
    """Read the vertices of a PLY file in metres, with red, green, blue if uchar; raises SceneError.

    Organised are files with `num_cols` and `num_rows` among their comments (with or without a `range_grid`), and
    those with a `camera` element whose viewport has as many pixels as there are vertices.
    """
    content = source.read_bytes()
    _check_header(source, content)
    try:
        # plyfile carries no types; this is the one place where it is spoken to.
        file: Any = PlyData.read(BytesIO(content))  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType]
        elements = {str(element.name): cast(NDArray[Any], element.data) for element in file.elements}
        remarks = [str(line) for line in (*file.comments, *file.obj_info)]
        vertices = elements["vertex"]
        points = np.stack([vertices["x"], vertices["y"], vertices["z"]], axis=-1)
        place = _places(elements, remarks)
    except Exception as failure:
        raise source.error("is a truncated or damaged PLY file", "copy or record it again") from failure
    colors = _colors(vertices)
    if place is None:
        return make_cloud(source, points, colors)
    return make_cloud(source, _spread(points, place, np.nan), None if colors is None else _spread(colors, place, 0))


def _check_header(source: SourceFile, content: bytes) -> None:
    end = _END_OF_HEADER.search(content)
    if not content.startswith(b"ply") or end is None:
        raise source.error("is not a PLY file, or is cut off in its header", "copy or record it again")
    counts = {name: int(count) for name, count in _ELEMENT.findall(content[: end.end()])}
    if not counts.get(b"vertex"):
        raise source.error("has no vertices", "save it as a point cloud with element vertex")
    for count in counts.values():
        source.check_count(count, "elements")
        if count > len(content):
            raise source.error("is a truncated PLY file", "copy or record it again")


def _places(elements: dict[str, NDArray[Any]], remarks: list[str]) -> NDArray[np.int64] | None:
    """(height, width) index of the vertex behind each pixel, -1 for none; None when not organised."""
    count = len(elements["vertex"])
    words = dict(line.split()[:2] for line in remarks if len(line.split()) >= 2)
    if "num_cols" in words and "num_rows" in words:
        shape = int(words["num_rows"]), int(words["num_cols"])
    elif "camera" in elements and {"viewportx", "viewporty"} <= set(elements["camera"].dtype.names or ()):
        shape = int(elements["camera"]["viewporty"][0]), int(elements["camera"]["viewportx"][0])
    else:
        return None
    if "range_grid" in elements:
        cells = elements["range_grid"]["vertex_indices"]
        index = np.array([cell[0] if len(cell) else -1 for cell in cells], dtype=np.int64)
        if index.min() < -1 or index.max() >= count:
            raise ValueError("range_grid names vertices that do not exist")
        return index.reshape(shape)
    if shape[0] < 2 or shape[0] * shape[1] != count:
        return None
    return np.arange(count).reshape(shape)


def _spread(values: NDArray[Any], place: NDArray[np.int64], absent: float) -> NDArray[Any]:
    return np.where((place >= 0)[..., None], values[place], np.asarray(absent, dtype=values.dtype))


def _colors(vertices: NDArray[Any]) -> Bytes | None:
    channels = ("red", "green", "blue")
    if not set(channels) <= set(vertices.dtype.names or ()):
        return None
    colors = np.stack([vertices[channel] for channel in channels], axis=-1)
    return colors if colors.dtype == np.uint8 else None

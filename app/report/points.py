"""The points of the area, each with what the segmentation made of it."""

from enum import IntEnum
from io import BytesIO

import numpy as np
from plyfile import PlyData, PlyElement

from rotrecon.arrays import Bytes
from rotrecon.camera import transform
from rotrecon.reconstruction import Reconstruction
from rotrecon.segmentation import PixelHistory


class Label(IntEnum):
    """What became of a point; see paper 3.2."""

    OBJECT = 1
    DISTANT = 2
    OUTLIER = 3
    SPARSE_LINE = 4
    UNUSED = 5
    """Out of the arm's reach, or without a depth that can be used."""


FIELDS = [
    ("x", "f4"), ("y", "f4"), ("z", "f4"), ("red", "u1"), ("green", "u1"), ("blue", "u1"),
    ("label", "u1"), ("section", "i4"),
]  # fmt: skip


def points_ply(result: Reconstruction) -> bytes:
    """Binary PLY of all points of the area: place in base coordinates, m, colour, label and section.

    The section is that of the CSV, from 1; 0 for points in none.
    """
    label = labels(result)
    pixel = np.flatnonzero((label > 0) & np.isfinite(result.frame.points_m).all(axis=2).ravel())
    points_m = result.frame.points_m.reshape(-1, 3)[pixel]
    vertices = np.empty(len(pixel), FIELDS)
    vertices["x"], vertices["y"], vertices["z"] = transform(result.frame.T_base_camera, points_m).T
    vertices["red"], vertices["green"], vertices["blue"] = result.frame.image.reshape(-1, 3)[pixel].T
    vertices["label"] = label[pixel]
    vertices["section"] = _section_of(result)[pixel]
    comments = ["base coordinates, metres", *(f"label {label.value} {label.name.lower()}" for label in Label)]
    file = BytesIO()
    PlyData([PlyElement.describe(vertices, "vertex")], byte_order="<", comments=comments).write(file)
    return file.getvalue()


def labels(result: Reconstruction) -> Bytes:
    """Label of each pixel of the flattened frame; 0 for those that no line of pixels and no section went through."""
    segmentation, pixel = result.segmentation, result.segments.pixel
    history = segmentation.history
    of_cell = np.full(history.shape, Label.UNUSED, dtype=np.uint8)
    of_cell[history & PixelHistory.DEPTH > 0] = Label.OUTLIER
    of_cell[segmentation.removed_in_run > 0] = Label.DISTANT
    of_cell[history & PixelHistory.SPARSE_LINE > 0] = Label.SPARSE_LINE
    label = np.zeros(result.frame.camera.width * result.frame.camera.height, dtype=np.uint8)
    label[pixel[result.segments.inside]] = of_cell[result.segments.inside]
    # last, as slanted lines go through some pixels twice and sections hold pixels that lie between the lines
    label[pixel[segmentation.kept]] = Label.OBJECT
    if result.sections is not None:
        label[result.sections.pixel] = Label.OBJECT
    return label


def _section_of(result: Reconstruction) -> np.ndarray:
    """Section, from 1, of each pixel of the flattened frame; 0 for none."""
    section = np.zeros(result.frame.camera.width * result.frame.camera.height, dtype=np.int32)
    if result.sections is not None:
        start = result.sections.start
        section[result.sections.pixel] = np.repeat(np.arange(1, len(start)), np.diff(start))
    return section

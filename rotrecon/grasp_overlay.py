"""A tool at an object, and what it would hit, drawn on the camera frame."""

import cv2
import numpy as np

from rotrecon.arrays import Bytes, Floats
from rotrecon.camera import inverse, transform
from rotrecon.envelope import CORNERS, Box
from rotrecon.frame import Frame
from rotrecon.grasp import Grasp

STEEL_COLOR, MOUTH_COLOR, HIT_COLOR, WAY_COLOR = (252, 240, 96), (0, 158, 115), (255, 60, 200), (230, 159, 0)
EDGES = [(a, b) for a in range(8) for b in range(a + 1, 8) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 2]
"""Of the corners of a box, those that are joined."""
EDGE_POINTS = 24
"""Pieces of an edge: what is behind the camera is left out piece by piece."""
SPOT = np.ones((3, 3), dtype=np.uint8)
"""Pixels that a point is drawn with: one alone would not be seen."""


def with_grasp(image: Bytes, grasp: Grasp, frame: Frame) -> Bytes:
    """The image (H, W, 3) with mouth, jaws and body as boxes, contact and approach, and every point that is in them."""
    drawn = image.copy()
    thickness = max(1, round(image.shape[1] / 500))
    for hits, color in ((grasp.on_way, WAY_COLOR), (grasp.at_contact, HIT_COLOR)):
        there = np.zeros(drawn.shape[:2], dtype=np.uint8)
        there.ravel()[hits.pixel] = 1
        drawn[np.asarray(cv2.dilate(there, SPOT)) > 0] = color
    envelope = grasp.envelope
    for box, color in ((envelope.mouth, MOUTH_COLOR), *((part, STEEL_COLOR) for part in envelope.solid)):
        for line in _edges(box):
            _draw(drawn, line, frame, color, thickness)
    way = np.stack([envelope.start_m, grasp.contact.point_m])
    share = np.linspace(0, 1, EDGE_POINTS)[:, None]
    _draw(drawn, way[0] + share * (way[1] - way[0]), frame, STEEL_COLOR, 2 * thickness)
    return drawn


def edges_of(box: Box) -> Floats:
    """The twelve edges (12, 2, 3) of a box."""
    return box.corners_m[np.array(EDGES)]


def _edges(box: Box) -> Floats:
    """The edges in pieces, (12, n, 3)."""
    start, end = np.moveaxis(edges_of(box), 1, 0)[:, :, None]
    return start + np.linspace(0, 1, EDGE_POINTS)[:, None] * (end - start)


def _draw(image: Bytes, line_m: Floats, frame: Frame, color: tuple[int, int, int], thickness: int) -> None:
    """A line (n, 3), base coordinates, as far as it is before the camera."""
    place = frame.camera.project(transform(inverse(frame.T_base_camera), line_m)) * 16
    pieces = np.concatenate([place[:-1], place[1:]], axis=1)
    drawable = np.asarray(np.isfinite(pieces).all(axis=1) & (np.abs(pieces) < 1e6).all(axis=1))
    for a, b, c, d in np.rint(pieces[drawable]).astype(np.int32).tolist():
        cv2.line(image, (a, b), (c, d), color, thickness, cv2.LINE_AA, shift=4)

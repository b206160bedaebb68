"""Disparity carried back as depth into the reference's own pixels, without mixing surfaces."""

import cv2
import numpy as np

from rotrecon.arrays import Bytes, Cloud, Floats, strips
from rotrecon.stereo.canvas import Box, Canvas

ONE_SURFACE_PX = 1.0
"""Disparities of neighbouring pixels that differ more are of two surfaces, or of one too slanted to interpolate."""
NEIGHBOURS = np.ones((3, 3), dtype=np.uint8)


def inverse_depths(canvas: Canvas, disparity: Cloud, box: Box, step_px: int = 1) -> Cloud:
    """Inverse depth along the reference's z, 1/m, of its pixels in a box, every `step_px`-th (h, w); NaN where none.

    `disparity` (height, width) is the canvas's, px, negative where there is none. It is interpolated where all its
    neighbours belong to one surface; elsewhere the nearest one is taken, so that no depth arises between surfaces.
    """
    broken = _broken(disparity, ONE_SURFACE_PX * canvas.focal_px / canvas.pair.reference.camera.focal_px)
    left, top, right, bottom = box
    u, v = np.arange(left, right, step_px, dtype=np.float64), np.arange(top, bottom, step_px, dtype=np.float64)
    found = np.empty((len(v), len(u)), dtype=np.float32)
    for first, last in strips(len(v)):
        found[first:last] = _strip(canvas, disparity, broken, u, v[first:last, None])
    return found


def _broken(disparity: Cloud, step_px: float) -> Bytes:
    """(h, w) 1 where a pixel and its neighbours span more than a step, or lie beyond the border."""
    broken = np.empty(disparity.shape, dtype=np.uint8)
    for top, bottom in strips(len(disparity)):
        above = min(top, 1)
        part = disparity[top - above : bottom + 1]
        spread = np.asarray(cv2.subtract(cv2.dilate(part, NEIGHBOURS), cv2.erode(part, NEIGHBOURS)))
        broken[top:bottom] = spread[above : above + bottom - top] > step_px
    broken[[0, -1]], broken[:, [0, -1]] = 1, 1
    return broken


def _strip(canvas: Canvas, disparity: Cloud, broken: Bytes, u: Floats, v: Floats) -> Cloud:
    x, y, depth_ratio = (row[0] * u + row[1] * v + row[2] for row in canvas.homography())
    x, y = (x / depth_ratio).astype(np.float32), (y / depth_ratio).astype(np.float32)
    nearest = _sampled(disparity, x, y, cv2.INTER_NEAREST)
    apart = _sampled(broken, x, y, cv2.INTER_NEAREST) > 0
    chosen = np.where(apart, nearest, _sampled(disparity, x, y, cv2.INTER_LINEAR)) + np.float32(canvas.first_disparity)
    # depth in the common planes is f b / disparity, and depth_ratio times the depth along the reference's z
    inverse = chosen * (depth_ratio / canvas.disparity_of_inverse_depth)
    return np.where((nearest >= 0) & (inverse > 0), inverse, np.nan).astype(np.float32)


def _sampled(values: Cloud | Bytes, x: Cloud, y: Cloud, how: int) -> Cloud:
    """Values at places of the canvas; -1 beyond it."""
    return np.asarray(cv2.remap(values, x, y, how, borderMode=cv2.BORDER_CONSTANT, borderValue=(-1.0,)), np.float32)

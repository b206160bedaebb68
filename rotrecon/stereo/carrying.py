"""Disparity carried back as depth into the reference's own pixels, without mixing surfaces."""

from functools import partial

import cv2
import numpy as np

from rotrecon.arrays import Bytes, Cloud, strips
from rotrecon.stereo.canvas import Box, Canvas, cut, shift_of

ONE_SURFACE_PX = 1.0
"""Disparities of neighbouring pixels that differ more are of two surfaces, or of one too slanted to interpolate."""
NEIGHBOURS = np.ones((3, 3), dtype=np.uint8)
NONE = np.float32(-1.0)
"""Disparity of what has none."""


def inverse_depths(canvas: Canvas, disparity: Cloud, box: Box, step_px: int = 1) -> Cloud:
    """Inverse depth along the reference's z, 1/m, of its pixels in a box, every `step_px`-th (h, w); NaN where none.

    `disparity` (height, width) is the canvas's, px, negative where there is none. It is interpolated where all its
    neighbours belong to one surface; elsewhere the nearest one is taken, so that no depth arises between surfaces.
    Where the canvas has the reference's own pixels, there is nothing to interpolate.
    """
    left, top, right, bottom = box
    u, v = np.arange(left, right, step_px, dtype=np.float64), np.arange(top, bottom, step_px, dtype=np.float64)
    H = canvas.homography()
    own_pixels = step_px == 1 and shift_of(H) is not None
    seen_at = partial(_cut, disparity) if own_pixels else partial(_interpolated, disparity, _broken(canvas, disparity))
    found = np.empty((len(v), len(u)), dtype=np.float32)
    for first, last in strips(len(v)):
        x, y, depth_ratio = (row[0] * u + row[1] * v[first:last, None] + row[2] for row in H)
        seen_px = seen_at((x / depth_ratio).astype(np.float32), (y / depth_ratio).astype(np.float32))
        # depth in the common planes is f b / disparity, and depth_ratio times the depth along the reference's z
        inverse = (seen_px + np.float32(canvas.first_disparity)) * (depth_ratio / canvas.disparity_of_inverse_depth)
        found[first:last] = np.where(inverse > 0, inverse, np.nan)
    return found


def _broken(canvas: Canvas, disparity: Cloud) -> Bytes:
    """(h, w) 1 where a pixel and its neighbours are not of one surface, or lie beyond the border."""
    step_px = ONE_SURFACE_PX * canvas.focal_px / canvas.pair.reference.camera.focal_px
    broken = np.empty(disparity.shape, dtype=np.uint8)
    for top, bottom in strips(len(disparity)):
        above = min(top, 1)
        part = disparity[top - above : bottom + 1]
        spread = np.asarray(cv2.subtract(cv2.dilate(part, NEIGHBOURS), cv2.erode(part, NEIGHBOURS)))
        broken[top:bottom] = spread[above : above + bottom - top] > step_px
    broken[[0, -1]], broken[:, [0, -1]] = 1, 1
    return broken


def _cut(disparity: Cloud, x: Cloud, y: Cloud) -> Cloud:
    """Disparity at places (h, w) that are the canvas's own pixels; NaN where there is none."""
    height, width = x.shape
    seen_px = cut(disparity, (round(float(x[0, 0])), round(float(y[0, 0]))), (width, height), NONE)
    seen_px[seen_px < 0] = np.nan
    return seen_px


def _interpolated(disparity: Cloud, broken: Bytes, x: Cloud, y: Cloud) -> Cloud:
    """Disparity at places (h, w) of the canvas; NaN where there is none."""
    nearest = _sampled(disparity, x, y, cv2.INTER_NEAREST)
    apart = _sampled(broken, x, y, cv2.INTER_NEAREST) > 0
    chosen = np.where(apart, nearest, _sampled(disparity, x, y, cv2.INTER_LINEAR))
    return np.where(nearest >= 0, chosen, np.float32(np.nan))


def _sampled(values: Cloud | Bytes, x: Cloud, y: Cloud, how: int) -> Cloud:
    """Values at places of the canvas; negative beyond it."""
    beyond = (float(NONE),)
    return np.asarray(cv2.remap(values, x, y, how, borderMode=cv2.BORDER_CONSTANT, borderValue=beyond), np.float32)

"""The rectangle of a frame that a drawing concerns, pixel by pixel, as the robust method sees it."""

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from rotrecon.arrays import Bools, Bytes, Cloud, Floats, Indices, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, CrossSegments, area_mask
from rotrecon.frame import Frame
from rotrecon.noise import RayNoise, noise_of
from rotrecon.rays.traces import Rays
from rotrecon.workspace import available

MARGIN_PX = 12
"""Border of the rectangle round the area: a matching window, and an outline's edge, reach so far beyond it."""
MEDIAN_PX = 5
"""Side of the median filter that takes single wrong depths out before sections are segmented."""
BEYOND_M = 1e6
"""Stands for unknown depth in the median filter: farther than anything."""


@dataclass(frozen=True, eq=False)
class Patch:
    """Pixels of a rectangle (h, w), flattened to N = h w."""

    camera: PinholeCamera
    image: Bytes
    """(H, W, 3) RGB, of the whole frame."""
    corner_px: Floats
    """(2,) u and v of the rectangle's first pixel."""
    shape: tuple[int, int]
    rays: Rays
    """(3, N)"""
    depth_m: Floats
    """(N,) NaN where it is not known or the arm does not reach."""
    area: Bools
    """(N,) in the area of interest."""
    drawn: Bools
    """(N,) in it, and beside the stroke."""
    kept: Bools
    """(N,) segmented as the object by paper 3.2."""
    noise: RayNoise

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def focal_px(self) -> float:
        """Focal length."""
        return self.camera.focal_px

    def picture(self) -> Bytes:
        """The rectangle (h, w, 3) of the image."""
        left, top = self.corner_px.astype(np.int32)
        return self.image[top : top + self.shape[0], left : left + self.shape[1]]

    @cached_property
    def is_plain(self) -> bool:
        """Whether its picture is of one brightness, as a frame's without a picture is."""
        return bool(np.ptp(self.picture()) == 0)

    def frame_pixels(self, pixels: Indices) -> Indices:
        """Index (n,) into the flattened frame of pixels (n,) of the patch."""
        row, column = np.divmod(pixels, self.shape[1])
        left, top = self.corner_px.astype(np.int32)
        return ((row + top) * self.camera.width + column + left).astype(np.int32)

    def pixel_of(self, place_px: Floats) -> Indices:
        """Flat index (n,) of the pixels under places (n, 2) of the frame; -1 outside the rectangle."""
        column, row = np.floor(np.nan_to_num(place_px - self.corner_px, nan=-1.0) + 0.5).astype(np.int32).T
        within = (column >= 0) & (column < self.shape[1]) & (row >= 0) & (row < self.shape[0])
        return np.where(within, row * self.shape[1] + column, -1)


def patch_of(frame: Frame, area: AreaOfInterest, segments: CrossSegments, kept: Bools) -> Patch:
    """The rectangle round a drawing's area; `kept` (S, W) says which cells of its segments were segmented."""
    camera = frame.camera
    mask = area_mask(area, (camera.width, camera.height)) > 0
    row, column = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    top, left = max(int(row[0]) - MARGIN_PX, 0), max(int(column[0]) - MARGIN_PX, 0)
    box = np.s_[top : int(row[-1]) + MARGIN_PX + 1, left : int(column[-1]) + MARGIN_PX + 1]
    depth_m = frame.depth_m[box]
    v, u = np.indices(depth_m.shape)
    place = np.stack([u.ravel() + left, v.ravel() + top], axis=-1)
    rays = camera.unproject(place, np.ones(u.size)).T
    # the cells of sections that are not upright miss up to a sixth of the pixels between them
    row = (place - segments.origin_px) @ segments.along
    beside = (row >= -0.5) & (row < len(segments.pixel) - 0.5)
    segmented = np.zeros(mask.shape, dtype=np.bool_)
    segmented.ravel()[segments.pixel[kept]] = True
    reachable = available(frame.points_m[box].reshape(-1, 3), frame.T_base_camera, frame.workspace)
    return Patch(
        camera=camera,
        image=frame.image,
        corner_px=np.array([left, top], dtype=np.float64),
        shape=(depth_m.shape[0], depth_m.shape[1]),
        rays=np.ascontiguousarray(rays),
        depth_m=np.where(reachable, depth_m.ravel(), np.nan).astype(np.float64),
        area=mask[box].ravel(),
        drawn=mask[box].ravel() & beside,
        kept=segmented[box].ravel(),
        noise=noise_of(frame.noise, depth_m, camera.focal_px),
    )


def clear_depth(depth_m: Cloud, pixel: Indices) -> Cloud:
    """Depth (S, W) without speckle of some pixels (S, W) of a flattened depth map (H, W); NaN where one is negative."""
    height, width = depth_m.shape
    row = pixel // width
    column = pixel - row * width
    there, reach = pixel >= 0, MEDIAN_PX // 2
    top, bottom = max(int(row[there].min()) - reach, 0), min(int(row[there].max()) + reach + 1, height)
    left, right = max(int(column[there].min()) - reach, 0), min(int(column[there].max()) + reach + 1, width)
    clear = without_speckle(depth_m[top:bottom, left:right])
    place = np.where(there, (row - top) * (right - left) + column - left, 0)
    return np.where(there, clear.ravel()[place], np.float32(np.nan))


def without_speckle(depth_m: Cloud) -> Cloud:
    """A depth map (h, w) through a median filter, unknown where it was or where most of the window is unknown."""
    known = np.isfinite(depth_m)
    filtered = np.asarray(cv2.medianBlur(np.where(known, depth_m, np.float32(BEYOND_M)), MEDIAN_PX))
    return np.where(known & (filtered < BEYOND_M / 2), filtered, np.float32(np.nan))

"""Lens distortion: brings what a distorted raster recorded into the pinhole raster with the same camera matrix."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Bytes, Cloud, Floats, freeze
from rotrecon.camera import PinholeCamera

COEFFICIENT_COUNTS = (0, 4, 5, 8, 12, 14)
"""Lengths that OpenCV knows for its vector of distortion coefficients."""

_INVERSION = (cv2.TERM_CRITERIA_MAX_ITER | cv2.TERM_CRITERIA_EPS, 50, 1e-10)
_INVERSION_TOLERANCE_PX = 0.05
# Far outside the calibrated field the polynomial folds back; what does not return to its own pixel was not inverted.


@dataclass(frozen=True, eq=False)
class Lens:
    """A pinhole camera and the distortion of the raster it recorded."""

    camera: PinholeCamera
    distortion: Floats
    """OpenCV's coefficients, in their order; empty when pictures are undistorted."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def distorts(self) -> bool:
        """Whether the recorded raster differs from the pinhole one."""
        return bool(np.any(self.distortion != 0))

    def undistort_image(self, image: Bytes) -> Bytes:
        """The picture (height, width, 3) in the pinhole raster, interpolated; black where nothing was recorded."""
        return np.asarray(cv2.undistort(image, self.camera.K, self.distortion), np.uint8) if self.distorts else image

    def undistort_points(self, points_m: Cloud) -> Cloud:
        """An organised cloud (height, width, 3) brought to the nearest pinhole pixels, its points unchanged.

        Nothing is interpolated, so no point arises that was not measured; NaN where nothing was recorded.
        """
        if not self.distorts:
            return points_m
        size = self.camera.width, self.camera.height
        along_u, along_v = cv2.initUndistortRectifyMap(
            self.camera.K, self.distortion, np.eye(3), self.camera.K, size, cv2.CV_32FC1
        )
        recorded = (np.abs(along_u - (size[0] - 1) / 2) < size[0] / 2) & (
            np.abs(along_v - (size[1] - 1) / 2) < size[1] / 2
        )
        u, v = np.rint(along_u[recorded]).astype(np.int64), np.rint(along_v[recorded]).astype(np.int64)
        brought = np.full_like(points_m, np.nan)
        brought[recorded] = points_m[v, u]
        return brought

    def cloud(self, depth_m: Cloud) -> Cloud:
        """Organised cloud (height, width, 3), still in the recorded raster, of the depth map of that raster."""
        if not self.distorts:
            return self.camera.cloud(depth_m)
        pixels = pixel_grid(self.camera)
        rays = cv2.undistortPoints(
            pixels.reshape(-1, 1, 2), self.camera.K, self.distortion, criteria=_INVERSION
        ).reshape(*depth_m.shape, 2)
        with np.errstate(over="ignore", invalid="ignore"):
            points = np.concatenate([rays * depth_m[..., None], depth_m[..., None]], axis=-1)
            inverted = (np.abs(self.project(points) - pixels) < _INVERSION_TOLERANCE_PX).all(axis=-1)
        points[~inverted] = np.nan
        return points.astype(np.float32)

    def project(self, points_m: Cloud | Floats) -> Floats:
        """Pixels (..., 2) of the recorded raster at which points (..., 3) are seen; NaN for invalid points."""
        if not self.distorts:
            return self.camera.project(points_m)
        points = np.asarray(points_m, np.float64)
        seen = points[..., 2] > 0
        pixels = np.full((*points.shape[:-1], 2), np.nan)
        if seen.any():
            projected, _ = cv2.projectPoints(points[seen], np.zeros(3), np.zeros(3), self.camera.K, self.distortion)
            pixels[seen] = projected.reshape(-1, 2)
        return pixels


def pinhole(camera: PinholeCamera) -> Lens:
    """The lens of a camera whose raster is undistorted."""
    return Lens(camera, np.empty(0))


def pixel_grid(camera: PinholeCamera) -> Floats:
    """The (u, v) of every pixel of a camera, (height, width, 2)."""
    u, v = np.meshgrid(np.arange(camera.width, dtype=np.float64), np.arange(camera.height, dtype=np.float64))
    return np.stack([u, v], axis=-1)

"""The pinhole camera and rigid poses: the only place where pixels and metres meet."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rotrecon.arrays import Cloud, Floats, freeze, strips


@dataclass(frozen=True, eq=False)
class PinholeCamera:
    """A camera without distortion, OpenCV's axes: x right, y down, z forward; pixel centres are integers."""

    width: int
    height: int
    K: Floats
    """(3, 3) camera matrix, px."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def focal_px(self) -> float:
        """Focal length along u, the direction of a sideways stereo baseline."""
        return float(self.K[0, 0])

    def project(self, points_m: ArrayLike) -> Floats:
        """Pixels (..., 2) of points (..., 3) in camera coordinates; NaN for points not in front of the camera."""
        points = np.asarray(points_m, dtype=np.float64)
        z = np.where(points[..., 2:] > 0, points[..., 2:], np.nan)
        return (points[..., :2] / z) * self._focal + self._principal

    def unproject(self, pixels: ArrayLike, depth_m: ArrayLike) -> Floats:
        """Points (..., 3) in camera coordinates of pixels (..., 2) whose depth along z (...) is known."""
        depth = np.asarray(depth_m, dtype=np.float64)
        rays = (np.asarray(pixels, dtype=np.float64) - self._principal) / self._focal
        return np.concatenate([rays * depth[..., None], depth[..., None]], axis=-1)

    def cloud(self, depth_m: ArrayLike) -> Cloud:
        """Organised cloud (height, width, 3), float32, of a depth map (height, width); NaN where it is not valid."""
        points = np.empty((self.height, self.width, 3), dtype=np.float32)
        depth_before(points)[...] = depth_m
        self.spread(points)
        return points

    def spread(self, points_m: Cloud) -> None:
        """Turn the depth map that stands in the memory of a cloud (see `depth_before`) into the cloud, in place."""
        depth = depth_before(points_m)
        u = ((np.arange(self.width) - self._principal[0]) / self._focal[0]).astype(np.float32)
        v = ((np.arange(self.height) - self._principal[1]) / self._focal[1]).astype(np.float32)
        for top, bottom in strips(self.height):
            z, part = depth[top:bottom].copy(), points_m[top:bottom]
            z[~((z > 0) & (z < np.inf))] = np.nan
            np.multiply(u, z, out=part[..., 0])
            np.multiply(v[top:bottom, None], z, out=part[..., 1])
            part[..., 2] = z

    @property
    def _focal(self) -> Floats:
        return np.array([self.K[0, 0], self.K[1, 1]])

    @property
    def _principal(self) -> Floats:
        return np.array([self.K[0, 2], self.K[1, 2]])


def depth_before(points_m: Cloud) -> Cloud:
    """The depth map (height, width) that a cloud (height, width, 3) is made of in its own memory: the last third of it.

    Written from the first row on, the cloud never reaches rows of depth that are still to be read: its row r ends where
    3 (r + 1) rows of depth would, and the next row of depth begins after 2 height + r + 1.
    """
    return points_m.reshape(3, *points_m.shape[:2])[2]


def transform(T_target_source: Floats, points_m: ArrayLike) -> Floats:
    """Points (..., 3) carried from the source frame to the target frame."""
    return np.asarray(points_m, dtype=np.float64) @ T_target_source[:3, :3].T + T_target_source[:3, 3]


def rotate(T_target_source: Floats, directions: ArrayLike) -> Floats:
    """Directions (..., 3) turned from the source frame into the target frame."""
    return np.asarray(directions, dtype=np.float64) @ T_target_source[:3, :3].T


def inverse(T_target_source: Floats) -> Floats:
    """The rigid pose the other way round, T_source_target."""
    result = np.eye(4)
    result[:3, :3] = T_target_source[:3, :3].T
    result[:3, 3] = -T_target_source[:3, :3].T @ T_target_source[:3, 3]
    return result


def is_rigid(pose: Floats, tolerance: float = 1e-4) -> bool:
    """Whether a (4, 4) matrix is a rotation (determinant +1) and a translation."""
    rotation = pose[:3, :3]
    return bool(
        np.isfinite(pose).all()
        and np.allclose(pose[3], [0, 0, 0, 1], atol=tolerance)
        and np.allclose(rotation @ rotation.T, np.eye(3), atol=tolerance)
        and np.linalg.det(rotation) > 0
    )

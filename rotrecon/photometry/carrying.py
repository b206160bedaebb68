"""What one camera sees, carried into another."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.camera import PinholeCamera, inverse, transform
from rotrecon.compiled import MATRIX, VECTOR, compiled
from rotrecon.frame import View
from rotrecon.rays.ball import Ball
from rotrecon.rays.surfaces import Surface
from rotrecon.rays.traces import Rays


@dataclass(frozen=True, eq=False)
class Carrier:
    """Another camera, as it stands to the reference camera."""

    camera: PinholeCamera
    T_view_reference: Floats
    """(4, 4) rigid."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def center_m(self) -> Floats:
        """(3,) of the other camera, in reference coordinates."""
        return inverse(self.T_view_reference)[:3, 3]

    def carried(self, rays: Rays, depth_m: Floats) -> tuple[Floats, Floats]:
        """Places (2, N) in the other picture of points at a depth (N,) along rays, and their derivatives (2, N) by it.

        Places of points that are not in front of that camera are NaN.
        """
        pose, K = np.ascontiguousarray(self.T_view_reference), np.ascontiguousarray(self.camera.K)
        return _carried(np.ascontiguousarray(rays), np.ascontiguousarray(depth_m), pose, K)

    def back(self, reference: PinholeCamera) -> "Carrier":
        """The reference camera, as it stands to the other one."""
        return Carrier(reference, inverse(self.T_view_reference))

    def surface(self, surface: Surface) -> Surface:
        """A surface of the reference camera's coordinates in the other camera's.

        A step of a lateral surface is one in its own turn, so that it is the same in both; a ball's centre moves by
        the camera's coordinates: see `columns`.
        """
        center_m = transform(self.T_view_reference, surface.center_m)
        focal_px = self.camera.focal_px
        if isinstance(surface, Ball):
            return replace(surface, center_m=center_m, focal_px=focal_px)
        turn = surface.turn @ self.T_view_reference[:3, :3].T
        return replace(surface, center_m=center_m, turn=turn, focal_px=focal_px)

    def columns(self, columns: Floats, surface: Surface) -> Floats:
        """Derivatives (k, N) by the carried surface's parameters as those by the surface's own."""
        if not isinstance(surface, Ball):
            return columns
        return np.concatenate([self.T_view_reference[:3, :3].T @ columns[:3], columns[3:]])


@compiled(MATRIX, VECTOR, MATRIX, MATRIX)
def _carried(rays: Rays, depth_m: Floats, pose: Floats, K: Floats) -> tuple[Floats, Floats]:
    """See `Carrier.carried`; `pose` (4, 4) takes the rays there, and K (3, 3) is that camera's."""
    count = rays.shape[1]
    place, by_depth = np.empty((2, count)), np.empty((2, count))
    for i in range(count):
        ahead = pose[2, 0] * rays[0, i] + pose[2, 1] * rays[1, i] + pose[2, 2] * rays[2, i]
        z = ahead * depth_m[i] + pose[2, 3]
        if not z > 0:
            z = np.nan
        for axis in range(2):
            aside = pose[axis, 0] * rays[0, i] + pose[axis, 1] * rays[1, i] + pose[axis, 2] * rays[2, i]
            slope = (aside * depth_m[i] + pose[axis, 3]) / z
            place[axis, i] = K[axis, axis] * slope + K[axis, 2]
            by_depth[axis, i] = K[axis, axis] * (aside - slope * ahead) / z
    return place, by_depth


def carrier_of(view: View, T_base_camera: Floats) -> Carrier:
    """Another view's camera, seen from the reference camera of pose (4, 4)."""
    return Carrier(view.camera, inverse(view.T_base_camera) @ T_base_camera)

"""What one camera sees, carried into another."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.camera import PinholeCamera, inverse, transform
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
        ahead = self.T_view_reference[:3, :3] @ rays
        x, y, z = ahead * depth_m + self.T_view_reference[:3, 3:]
        z = np.where(z > 0, z, np.nan)
        K = self.camera.K
        focal, principal = np.array([[K[0, 0]], [K[1, 1]]]), np.array([[K[0, 2]], [K[1, 2]]])
        slope = np.stack([x, y]) / z
        return focal * slope + principal, focal * (ahead[:2] - slope * ahead[2]) / z

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


def carrier_of(view: View, T_base_camera: Floats) -> Carrier:
    """Another view's camera, seen from the reference camera of pose (4, 4)."""
    return Carrier(view.camera, inverse(view.T_base_camera) @ T_base_camera)

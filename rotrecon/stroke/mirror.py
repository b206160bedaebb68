"""How like its mirror image a surface is, about planes through the camera's centre.

A body of revolution and the camera are symmetric about the plane through the camera's centre and the body's axis, and
so is what the camera sees of it; in the picture the plane is a line: the axis, projected.
"""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.stroke.foreground import Foreground, Patch, places_of

JUDGES = 300
"""Pixels that judge: their mean is known to a few percent."""
UNKNOWN = 0.4
"""Unlikeness of a pixel whose mirror image was not seen: less than half, and not nothing, or planes that mirror the
object out of the area would win."""
AHEAD_PX = 50.0
"""A second place on a line, whose distance from the first is only to be well above rounding."""


@dataclass(frozen=True, eq=False)
class Mirror:
    """An object and its surroundings, to be mirrored."""

    camera: PinholeCamera
    patch: Patch
    mask: Bools
    """(h, w) the object."""
    points_m: Floats
    """(n, 3) some of its points, in camera coordinates."""
    scale: float
    """Share of the depth by which a mirror image lies off the surface that is no longer like it."""

    def __post_init__(self) -> None:
        freeze(self)

    @staticmethod
    def of(found: Foreground, relief: float, camera: PinholeCamera) -> "Mirror":
        """The object in a foreground, whose surface rises by `relief`, 1/m: noise above that counts instead."""
        places, inverse_depth = places_of(found.mask), found.patch.inverse_depth[found.mask]
        some = np.linspace(0, len(places) - 1, min(JUDGES, len(places))).astype(int)
        points_m = camera.unproject(found.patch.frame_px(places[some]), 1 / inverse_depth[some])
        noise = float(np.median(found.patch.tolerance[found.mask])) / 2
        return Mirror(camera, found.patch, found.mask, points_m, max(relief, noise) / float(np.median(inverse_depth)))

    def unlikeness(self, places_px: Floats, along: Floats) -> Floats:
        """From 0 to 1, (k,), about the planes of lines through places (k, 2) of the frame in directions (k, 2)."""
        depth = np.ones(len(places_px))
        ray, ahead = (self.camera.unproject(px, depth) for px in (places_px, places_px + AHEAD_PX * along))
        normal = np.cross(ray, ahead)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        image_m = self.points_m - 2 * (normal @ self.points_m.T)[..., None] * normal[:, None]
        u, v = np.moveaxis(np.rint(self.patch.patch_px(self.camera.project(image_m))), -1, 0)
        height, width = self.mask.shape
        seen = (u >= 0) & (u < width) & (v >= 0) & (v < height)
        u, v = np.where(seen, u, 0).astype(int), np.where(seen, v, 0).astype(int)
        nearer = (self.patch.inverse_depth[v, u] * image_m[..., 2] - 1) / self.scale
        missing = seen & self.patch.known[v, u] & (nearer < -1)
        off = np.where(seen & self.mask[v, u], np.minimum(np.abs(nearer), 1.0), np.where(missing, 1.0, UNKNOWN))
        return off.mean(axis=1)

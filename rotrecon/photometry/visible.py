"""Which pixels of the reference picture show a surface that another camera sees as well."""

import cv2
import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.compiled import FLOAT, MATRIX, VECTOR, compiled
from rotrecon.photometry.carrying import Carrier
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.patch import Patch
from rotrecon.rays.surfaces import Surface
from rotrecon.rays.traces import Rays

GUARD_PX = 2.0
"""Distance from the outline in either picture: blur and splines mix what is behind into pixels that are nearer."""
STEEPEST = float(np.cos(np.deg2rad(70.0)))
"""Least cosine of incidence: beyond, a pixel of one picture is spread over several of the other."""
AGREES_SIGMA, AGREES_RADIUS = 4.0, 0.1
"""Matched depth agrees with a surface within so many sigma, or this share of the radius."""
ROUND_ABOUT_PX = 9
"""Side of the window of which half the known depths must agree: they are rough, and full of holes."""


def clear_of(surface: Surface, patch: Patch) -> Bools:
    """(N,) drawn pixels of a patch at which a surface would be seen, clear of its outline."""
    drawn = np.flatnonzero(patch.drawn)
    rays = np.ascontiguousarray(patch.rays[:, drawn])
    depth_m, hit = surface.meet(rays)
    clear = hit & (depth_m > 0) & _faces(surface, rays * depth_m, np.zeros(3))
    result = np.zeros(len(patch.drawn), dtype=np.bool_)
    result[drawn] = clear & _inside(surface, rays, patch.focal_px)
    return result


def shown(surface: Surface, patch: Patch, clear: Bools, sigma: float) -> Bools:
    """Those of some pixels (N,) of a patch round which matched depth of a sigma agrees with a surface."""
    depth_m = surface.meet(patch.rays)[0]
    limit_m = np.maximum(AGREES_SIGMA * sigma * patch.noise.sigma_m(depth_m), AGREES_RADIUS * surface.size_m)
    known, near = np.isfinite(patch.depth_m), np.abs(patch.depth_m - depth_m) < limit_m
    return clear & (_summed(near & patch.drawn, patch.shape) >= 0.5 * _summed(known & patch.drawn, patch.shape))


def seen_too(surface: Surface, rays: Rays, carrier: Carrier) -> Bools:
    """(N,) which of the points where rays meet a surface another camera sees clear of its outline there."""
    points = rays * surface.meet(rays)[0]
    carried = carrier.T_view_reference[:3, :3] @ points + carrier.T_view_reference[:3, 3:]
    ahead = carried[2] > 0
    rays_there = carried / np.where(ahead, carried[2], 1.0)
    inside = _inside(carrier.surface(surface), rays_there, carrier.camera.focal_px)
    return ahead & inside & _faces(surface, points, carrier.center_m)


def _faces(surface: Surface, points: Floats, camera_m: Floats) -> Bools:
    """Which points (3, N) of a surface are seen at no steep incidence from a camera at (3,)."""
    return _facing(outward(surface, points), np.ascontiguousarray(points), np.ascontiguousarray(camera_m))


def outward(surface: Surface, points: Floats) -> Floats:
    """Unit normals (3, N) at points (3, N) of a surface, on the side that is seen."""
    axis, slope = (surface.direction, surface.slope) if isinstance(surface, Lateral) else (np.zeros(3), 0.0)
    return _outward(np.ascontiguousarray(points), surface.center_m, axis, surface.radius_m, slope, surface.side)


@compiled(MATRIX, VECTOR, VECTOR, FLOAT, FLOAT, FLOAT)
def _outward(points: Floats, center: Floats, axis: Floats, radius: float, slope: float, side: float) -> Floats:
    """See `outward`; the axis (3,) is a unit, or zero for a ball."""
    found = np.empty(points.shape)
    for i in range(points.shape[1]):
        x, y, z = points[0, i] - center[0], points[1, i] - center[1], points[2, i] - center[2]
        height = axis[0] * x + axis[1] * y + axis[2] * z
        lever = height + slope * (radius + slope * height)
        x, y, z = x - lever * axis[0], y - lever * axis[1], z - lever * axis[2]
        length = -side * np.sqrt(x * x + y * y + z * z)
        found[0, i], found[1, i], found[2, i] = x / length, y / length, z / length
    return found


@compiled(MATRIX, MATRIX, VECTOR)
def _facing(normals: Floats, points: Floats, camera_m: Floats) -> Bools:
    """Which points (3, N) with normals (3, N) are seen at no steep incidence from a camera at (3,)."""
    found = np.empty(points.shape[1], np.bool_)
    for i in range(len(found)):
        x, y, z = camera_m[0] - points[0, i], camera_m[1] - points[1, i], camera_m[2] - points[2, i]
        along = normals[0, i] * x + normals[1, i] * y + normals[2, i] * z
        found[i] = along > STEEPEST * np.sqrt(x * x + y * y + z * z)
    return found


def _inside(surface: Surface, rays: Rays, focal_px: float) -> Bools:
    """Which rays pass inside an outline by more than the guard; all for a surface seen from inside."""
    if surface.side > 0:
        return np.ones(len(rays[0]), dtype=np.bool_)
    gap_m, depth_m = surface.gap(rays)
    return gap_m * focal_px < -GUARD_PX * np.abs(depth_m)


def _summed(which: Bools, shape: tuple[int, int]) -> Floats:
    """Numbers (N,) of pixels of which something holds, in the window round each."""
    image: Floats = which.reshape(shape).astype(np.float64)
    side = (ROUND_ABOUT_PX, ROUND_ABOUT_PX)
    summed: Floats = np.empty(shape)
    cv2.boxFilter(image, -1, side, summed, normalize=False, borderType=cv2.BORDER_CONSTANT)
    return np.ravel(summed)

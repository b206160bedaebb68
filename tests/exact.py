"""Frames whose depth is exact: one solid before a wall, ray-cast."""

from dataclasses import replace

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, Drawing, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.outcome import Fit
from rotrecon.primitives import Frustum, Kind, Primitive, Sphere, basis_across
from rotrecon.reconstruction import Reconstruction
from rotrecon.simulation.raycast import first_hit

CAMERA = PinholeCamera(320, 240, np.array([[400.0, 0, 159.5], [0, 400.0, 119.5], [0, 0, 1]]))
WALL_M = 2.5


def exact_frame(solid: Primitive, camera: PinholeCamera = CAMERA, wall_m: float = WALL_M) -> Frame:
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    rays = camera.unproject(np.stack([u, v], axis=-1), np.ones(u.shape))
    body_axes = np.stack([*basis_across(solid.direction, -solid.center_m), solid.direction], axis=1)
    depth = np.minimum(first_hit(solid, -solid.center_m @ body_axes, rays @ body_axes), wall_m)
    return Frame(np.zeros((*u.shape, 3), dtype=np.uint8), camera.cloud(depth), camera)


def cylinder(center_m: Floats, direction: Floats, diameter_m: float, length_m: float = 0.3) -> Frustum:
    direction = np.asarray(direction, dtype=np.float64)
    return Frustum(
        "cylinder", np.asarray(center_m, float), direction / np.linalg.norm(direction), length_m, diameter_m / 2
    )


def cone(center_m: Floats, direction: Floats, diameter_m: float, half_angle_deg: float, length_m: float) -> Frustum:
    body = cylinder(center_m, direction, diameter_m, length_m)
    return Frustum("cone", body.center_m, body.direction, length_m, body.radius_m, float(np.deg2rad(half_angle_deg)))


def drawing_along(
    solid: Primitive, share: float = 0.8, camera: PinholeCamera = CAMERA, kind: Kind | None = None
) -> Drawing:
    """A stroke over the middle `share` of the solid, and a box round it three radii wide, turned with it."""
    low, high = (share * end for end in solid.ends)
    ends_m = np.array([solid.center_m + along * solid.direction for along in (low, high)])
    start, end = camera.project(ends_m)
    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([-along[1], along[0]])
    radius_m = solid.radius_m if isinstance(solid, Sphere) else max(float(solid.radius_at(e)) for e in solid.ends)
    width = 1.5 * radius_m * camera.focal_px / ends_m[:, 2].min()
    corners = [start - width * across, end - width * across, end + width * across, start + width * across]
    limit = np.array([camera.width - 1, camera.height - 1])
    vertices = tuple((float(u), float(v)) for u, v in np.clip(corners, 0, limit))
    return Drawing(AreaOfInterest(vertices), ObjectAxis(tuple(map(float, start)), tuple(map(float, end))), kind)


def measured(result: Reconstruction) -> Fit:
    assert isinstance(result.fit, Fit), result.fit
    return result.fit


def direction_of(tilt_deg: float, roll_deg: float) -> np.ndarray:
    tilt, roll = np.deg2rad([tilt_deg, roll_deg])
    return np.array([np.cos(tilt) * np.cos(roll), np.cos(tilt) * np.sin(roll), np.sin(tilt)])


def noisy(frame: Frame, seed: int, sigma_m: float = 0.001) -> Frame:
    depth = frame.depth_m + np.random.default_rng(seed).normal(0, sigma_m, frame.depth_m.shape)
    return replace(frame, points_m=frame.camera.cloud(depth))

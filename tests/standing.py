"""Exact frames of things that stand on a plane, and areas round them."""

from dataclasses import replace

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.primitives import Primitive, Sphere
from rotrecon.simulation.ideal_drawing import outline_px
from tests.exact import CAMERA, cylinder, exact_frame

UP = np.array([0.0, -0.8, -0.6])
"""Normal of a table that the camera looks down on."""
FOOT_M = np.array([0.02, 0.12, 0.9])
"""A place on it."""


def on_plane(frame: Frame, normal: Floats = UP, foot_m: Floats = FOOT_M) -> Frame:
    """The frame with a plane in it, which hides what is behind."""
    v, u = np.indices((frame.camera.height, frame.camera.width))
    facing = frame.camera.unproject(np.stack([u, v], axis=-1), np.ones(u.shape)) @ normal
    with np.errstate(divide="ignore"):
        depth = np.where(facing * (foot_m @ normal) > 0, (foot_m @ normal) / facing, np.inf)
    known = np.where(np.isfinite(frame.depth_m), frame.depth_m, np.inf)
    return replace(frame, points_m=frame.camera.cloud(np.minimum(known, depth)))


def upright(diameter_m: float = 0.08, length_m: float = 0.16) -> Primitive:
    """A cylinder that stands on the table."""
    return cylinder(FOOT_M + length_m / 2 * UP, UP, diameter_m, length_m)


def table_with(solid: Primitive, camera: PinholeCamera = CAMERA) -> Frame:
    return on_plane(exact_frame(solid, camera, wall_m=np.inf))


def area_round(solid: Primitive, size: float = 1.0, camera: PinholeCamera = CAMERA) -> AreaOfInterest:
    """The rectangle round the outline of a solid, so many times as wide and high."""
    outline = outline_px(solid, camera)
    low, high = outline.min(axis=0), outline.max(axis=0)
    half = size * (high - low) / 2 + 3.0
    corners = np.clip([(low + high) / 2 - half, (low + high) / 2 + half], 0, [camera.width - 1, camera.height - 1])
    first, opposite = ((float(u), float(v)) for u, v in corners)
    return AreaOfInterest.rectangle(first, opposite)


def off_axis(stroke: ObjectAxis, solid: Primitive, camera: PinholeCamera = CAMERA) -> tuple[float, float]:
    """Degrees between a stroke and the projected axis (0 for a ball), and how many widths its middle lies beside it."""
    start, end = np.array(stroke.start_px), np.array(stroke.end_px)
    along = (end - start) / np.linalg.norm(end - start)
    center = camera.project(solid.center_m)
    width_px = 2 * solid.radius_m * camera.focal_px / solid.center_m[2]
    if isinstance(solid, Sphere):
        return 0.0, abs(_cross(along, center - start)) / width_px
    axis = camera.project(solid.center_m + np.outer(solid.ends, solid.direction))
    axis = (axis[1] - axis[0]) / np.linalg.norm(axis[1] - axis[0])
    angle = np.degrees(np.arcsin(min(1.0, abs(_cross(axis, along)))))
    return float(angle), abs(_cross(axis, (start + end) / 2 - center)) / width_px


def _cross(one: Floats, other: Floats) -> float:
    return float(one[0] * other[1] - one[1] * other[0])

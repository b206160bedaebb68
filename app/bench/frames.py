"""Frames for timing: a rod of chosen width and direction before a wall, with the noise of a good depth camera."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, Drawing, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.primitives import Frustum, basis_across
from rotrecon.simulation.raycast import first_hit
from rotrecon.workspace import Workspace

CAMERA = PinholeCamera(1280, 960, np.array([[900.0, 0, 639.5], [0, 900.0, 479.5], [0, 0, 1]]))
WHOLE_FRAME = CAMERA.width * CAMERA.height
OBJECT_M, WALL_M = 1.0, 1.6
NOISE_M = 1e-3
WORKSPACE = Workspace(reach_m=(0.1, 3.0), box_m=np.array([[-3.0, -3.0, 0.0], [3.0, 3.0, 3.0]]), depth_m=(0.2, 3.0))
"""Of an arm that reaches everything: its tests are done, and drop nothing."""
OBJECT_SHARE = 0.5
"""Share of the area's width that the object takes."""
DIRECTIONS = {"vertical": (0.0, 1.0), "horizontal": (1.0, 0.0), "diagonal": (4.0, 3.0)}
"""Along the picture, px; the diagonal is that of the frame."""


@dataclass(frozen=True, eq=False)
class Task:
    """A frame, and a drawing on it to reconstruct from."""

    frame: Frame
    drawing: Drawing


def task(pixels: int, direction: str = "vertical") -> Task:
    """A task whose area is about so many pixels, four wide to three high, in the middle of the frame."""
    half = np.array([4.0, 3.0]) * np.sqrt(pixels / 12) / 2
    half = np.minimum(half, [CAMERA.width / 2, CAMERA.height / 2])
    middle = CAMERA.K[:2, 2]
    along = np.array(DIRECTIONS[direction])
    along /= np.linalg.norm(along)
    reach = along * (half / np.maximum(np.abs(along), 1e-9)).min()
    width_px = float(2 * np.abs([along[1], along[0]]) @ half)
    area = AreaOfInterest.rectangle(tuple(middle - half), tuple(middle + half - 1))
    stroke = ObjectAxis(tuple(middle - reach), tuple(middle + reach))
    return Task(_frame(along, OBJECT_SHARE * width_px), Drawing(area, stroke))


def _frame(along: Floats, width_px: float) -> Frame:
    """A rod `width_px` wide through the middle of the picture, `along` (2,)."""
    direction = np.array([*along, 0.0])
    radius_m = width_px / 2 * OBJECT_M / CAMERA.focal_px
    rod = Frustum("cylinder", np.array([0.0, 0.0, OBJECT_M]), direction, 10.0, radius_m)
    u, v = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    rays = CAMERA.unproject(np.stack([u, v], axis=-1), np.ones(u.shape))
    body_axes = np.stack([*basis_across(direction, -rod.center_m), direction], axis=1)
    depth = np.minimum(first_hit(rod, -rod.center_m @ body_axes, rays @ body_axes), WALL_M)
    depth += NOISE_M * np.random.default_rng(0).standard_normal(depth.shape)
    return Frame(np.zeros((*u.shape, 3), dtype=np.uint8), CAMERA.cloud(depth), CAMERA, workspace=WORKSPACE)

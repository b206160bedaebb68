"""Scenes whose truth is known: one object of revolution, free in front of a wall, as a stereo camera sees it."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame, StereoNoise
from rotrecon.primitives import Frustum, Simple, Sphere, basis_across
from rotrecon.simulation.ideal_drawing import ideal_drawing, outline_px
from rotrecon.simulation.rendering import Body, RenderedView, World, render
from rotrecon.simulation.scenery import (
    MaterialMaker,
    concrete,
    earth,
    leather_ball,
    plane_behind,
    rusty_steel,
    terracotta,
    weathered_cable,
    wood,
)
from rotrecon.simulation.stereo_noise import StereoErrors, stereo_depth

DEFAULT_CAMERA = PinholeCamera(640, 480, np.array([[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]]))
DEFAULT_NOISE = StereoErrors()
DISTANCE_M = (0.6, 1.2)
"""Depth of an object's middle: the working range of an arm's camera."""
TILT_RAD = float(np.deg2rad(35.0))
"""Largest tilt of an axis in depth; beyond it an operator looks from elsewhere."""
BEHIND_M = 0.3
"""Least depth between the object and anything behind it."""
BORDER_PX = 16.0
"""Least distance of the drawing and the outline from the picture's border: an unsteady hand stays inside."""
ATTEMPTS = 200
"""Poses tried until the object fits the picture; at least one in three does with the cameras foreseen."""


@dataclass(frozen=True)
class ObjectModel:
    """An object that can be simulated, its middle at the origin and its axis along z."""

    shape: Simple
    material: MaterialMaker


def _frustum(diameter_mm: float, length_m: float, half_angle_deg: float = 0.0, *, rod: bool = False) -> Frustum:
    kind = "rod" if rod else "cone" if half_angle_deg else "cylinder"
    middle, axis = np.zeros(3), np.array([0.0, 0.0, 1.0])
    return Frustum(kind, middle, axis, length_m, diameter_mm / 2000, float(np.deg2rad(half_angle_deg)))


OBJECTS = {
    "leg": ObjectModel(_frustum(36, 0.4), wood),
    "ball": ObjectModel(Sphere(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.108), leather_ball),
    "wire": ObjectModel(_frustum(25, 0.5, rod=True), weathered_cable),
    "pipe": ObjectModel(_frustum(100, 0.5), rusty_steel),
    "cone": ObjectModel(_frustum(100, 0.15, half_angle_deg=15), terracotta),
}
"""The first three are those of the paper's table 2."""


@dataclass(frozen=True, eq=False)
class Simulated:
    """A frame and all that is true of it."""

    object_name: str
    seed: int
    frame: Frame
    solid: Simple
    """In base coordinates."""
    solid_in_camera: Simple
    drawing: Drawing
    """What an ideal operator would draw."""
    world: World
    """In base coordinates; to be rendered from elsewhere."""
    view: RenderedView
    """The frame before the stereo camera's errors."""

    @property
    def diameter_mm(self) -> float:
        """At the middle of the length."""
        return 2000 * self.solid.radius_m

    def __post_init__(self) -> None:
        freeze(self)


def simulate(
    object_name: str,
    seed: int,
    camera: PinholeCamera = DEFAULT_CAMERA,
    noise: StereoErrors | None = DEFAULT_NOISE,
    supersampling: int = 2,
) -> Simulated:
    """One object in a random pose, the same for the same seed whatever the noise; ValueError for unknown names.

    Without noise the depth is exact, and the frame states no noise.
    """
    if object_name not in OBJECTS:
        raise ValueError(f"there is no object {object_name!r} to simulate; there are {', '.join(OBJECTS)}")
    poses, looks, errors = np.random.default_rng([seed, *object_name.encode()]).spawn(3)
    T_base_camera = camera_pose(poses)
    T_camera_body = object_pose(OBJECTS[object_name].shape, camera, DEFAULT_NOISE.baseline_m, poses)
    world = world_around(OBJECTS[object_name], camera, T_base_camera, T_camera_body, looks)
    view = render(world, camera, T_base_camera, supersampling)
    depth_m = view.depth_m if noise is None else stereo_depth(view, noise, errors)
    stated = None if noise is None else StereoNoise(noise.baseline_m, noise.disparity_sigma_px)
    solid_in_camera = OBJECTS[object_name].shape.moved(T_camera_body)
    return Simulated(
        object_name,
        seed,
        Frame(view.image, camera.cloud(depth_m), camera, T_base_camera, stated),
        solid_in_camera.moved(T_base_camera),
        solid_in_camera,
        ideal_drawing(solid_in_camera, camera),
        world,
        view,
    )


def camera_pose(rng: np.random.Generator) -> Floats:
    """A pose (4, 4) of the arm's camera over a base whose z is up: it looks ahead and a little down."""
    yaw, pitch, roll = np.deg2rad(rng.uniform([-40, 8, -6], [40, 20, 6]))
    forward = np.array([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), -np.sin(pitch)])
    right = np.array([np.sin(yaw), -np.cos(yaw), 0.0])
    down = np.cross(forward, right)
    rolled = np.cos(roll) * right + np.sin(roll) * down
    pose = np.eye(4)
    pose[:3, :3] = np.stack([rolled, np.cross(forward, rolled), forward], axis=1)
    pose[:3, 3] = rng.uniform([-0.1, -0.2, 0.5], [0.2, 0.2, 0.8])
    return pose


def object_pose(shape: Simple, camera: PinholeCamera, baseline_m: float, rng: np.random.Generator) -> Floats:
    """A pose (4, 4) of the object before the camera that keeps it in the pictures of a second camera at +x, too."""
    size = np.array([camera.width, camera.height])
    for _ in range(ATTEMPTS):
        depth = rng.uniform(*DISTANCE_M)
        middle = camera.unproject(rng.uniform(0.2 * size, 0.8 * size), depth)
        turn, tilt = rng.uniform(0, 2 * np.pi), rng.uniform(-TILT_RAD, TILT_RAD)
        axis = np.array([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)])
        pose = np.eye(4)
        pose[:3, :3] = np.stack([*basis_across(axis, -middle), axis], axis=1)
        pose[:3, 3] = middle
        if _fits(shape.moved(pose), camera, baseline_m):
            return pose
    raise ValueError(f"an object of this size does not fit a picture of {size[0]} x {size[1]} px at 0.6 to 1.2 m")


def _fits(solid: Simple, camera: PinholeCamera, baseline_m: float) -> bool:
    outline = outline_px(solid, camera)
    if not np.isfinite(outline).all():
        return False
    drawn = np.concatenate([outline, ideal_drawing(solid, camera).area.vertices_px])
    disparity_px = camera.focal_px * baseline_m / depth_range_m(solid)[0]
    low = np.array([BORDER_PX + disparity_px, BORDER_PX])
    high = np.array([camera.width, camera.height]) - 1 - BORDER_PX
    return bool((drawn >= low).all() and (drawn <= high).all())


def depth_range_m(solid: Simple) -> tuple[float, float]:
    """Least and greatest z of a solid."""
    middle, lean = float(solid.center_m[2]), float(solid.direction[2])
    if isinstance(solid, Sphere):
        return middle - solid.radius_m, middle + solid.radius_m
    along = np.array(solid.ends)
    rim = solid.radius_at(along) * np.sqrt(max(1 - lean**2, 0.0))
    return float((middle + along * lean - rim).min()), float((middle + along * lean + rim).max())


def world_around(
    model: ObjectModel,
    camera: PinholeCamera,
    T_base_camera: Floats,
    T_camera_body: Floats,
    rng: np.random.Generator,
) -> World:
    """The object, a wall and the ground behind it, and a lamp over the operator's shoulder."""
    solid = model.shape.moved(T_camera_body)
    farthest = depth_range_m(solid)[1]
    ahead = T_base_camera[:3, 2] * [1, 1, 0]
    turn = rng.uniform(-0.3, 0.3)
    ahead = np.array([ahead[0] - turn * ahead[1], ahead[1] + turn * ahead[0], 0.0])
    ahead /= np.linalg.norm(ahead)
    lamp = T_base_camera[:3, :3] @ np.array([rng.uniform(-0.8, 0.8), -0.9, -0.9])
    background = [
        (-ahead, farthest + BEHIND_M + rng.uniform(0.05, 0.3), concrete(rng)),
        (np.array([0.0, 0.0, 1.0]), farthest + BEHIND_M, earth(rng)),
    ]
    bodies = [Body(model.shape, T_base_camera @ T_camera_body, model.material(rng))]
    bodies += [plane_behind(camera, T_base_camera, normal, depth, look) for normal, depth, look in background]
    return World(tuple(bodies), lamp / np.linalg.norm(lamp))

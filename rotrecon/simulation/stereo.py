"""Pictures of one object from several known poses, with all that is true of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bytes, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import Drawing
from rotrecon.frame import View
from rotrecon.primitives import Simple
from rotrecon.simulation.ideal_drawing import ideal_drawing
from rotrecon.simulation.rendering import RenderedView, World, render
from rotrecon.simulation.simulate import OBJECTS, ObjectModel, camera_pose, object_pose, world_around
from rotrecon.simulation.surfaces import Texture, textured

VIEWS_CAMERA = PinholeCamera(1280, 720, np.array([[900.0, 0, 639.5], [0, 900.0, 359.5], [0, 0, 1]]))
WIDEST_BASELINE_M = 0.3
"""Objects are placed so that a camera so far to the right still has them in its picture."""


@dataclass(frozen=True)
class Flaws:
    """What is wrong with the pictures; the scene stays the same."""

    noise_levels: float = 2.0
    """Standard deviation of a pixel's value, in grey levels of 255."""
    gain: float = 1.0
    """Light of each view over that of the one before."""


@dataclass(frozen=True, eq=False)
class SimulatedViews:
    """Views and all that is true of them."""

    object_name: str
    seed: int
    texture: Texture
    flaws: Flaws
    views: tuple[View, ...]
    """As a reader of the scene gets them; the first is the reference."""
    solid: Simple
    """In base coordinates."""
    solid_in_camera: Simple
    """In those of the reference camera."""
    drawing: Drawing
    """What an ideal operator would draw in the reference picture."""
    world: World
    """In base coordinates."""
    view: RenderedView
    """The reference picture with its exact depth, and the true camera and pose."""

    @property
    def diameter_mm(self) -> float:
        """At the middle of the length."""
        return 2000 * self.solid.radius_m

    def __post_init__(self) -> None:
        freeze(self)


def simulate_views(
    object_name: str,
    seed: int,
    camera: PinholeCamera = VIEWS_CAMERA,
    baselines_m: Sequence[float] = (0.0, 0.1),
    texture: Texture = "fine",
    flaws: Flaws = Flaws(),
) -> SimulatedViews:
    """One object in a random pose, seen from places at +x of the reference; ValueError for unknown names.

    The same seed is the same scene, whatever the views, the texture and the flaws.
    """
    if object_name not in OBJECTS:
        raise ValueError(f"there is no object {object_name!r} to simulate; there are {', '.join(OBJECTS)}")
    shape = OBJECTS[object_name].shape
    poses, looks = np.random.default_rng([seed, *object_name.encode()]).spawn(2)
    T_base_camera = camera_pose(poses)
    T_camera_body = object_pose(shape, camera, WIDEST_BASELINE_M, poses)
    world = world_around(ObjectModel(shape, textured(texture, shape)), camera, T_base_camera, T_camera_body, looks)
    views: list[View] = []
    for number, baseline_m in enumerate(baselines_m):
        aside = np.eye(4)
        aside[0, 3] = baseline_m
        picture = render(world, camera, T_base_camera @ aside, supersampling=2).image
        noise = np.random.default_rng([seed, number, *object_name.encode()])
        views.append(View(_sensed(picture, flaws, number, noise), camera, T_base_camera @ aside))
    exact = render(world, camera, T_base_camera, supersampling=0)
    solid_in_camera = shape.moved(T_camera_body)
    return SimulatedViews(
        object_name,
        seed,
        texture,
        flaws,
        tuple(views),
        solid_in_camera.moved(T_base_camera),
        solid_in_camera,
        ideal_drawing(solid_in_camera, camera),
        world,
        RenderedView(views[0].image, exact.depth_m, exact.body, camera, T_base_camera),
    )


def _sensed(picture: Bytes, flaws: Flaws, number: int, rng: np.random.Generator) -> Bytes:
    levels = picture * flaws.gain ** (number / 2.2) + flaws.noise_levels * rng.standard_normal(picture.shape)
    return np.rint(levels).clip(0, 255).astype(np.uint8)

"""Pictures of one object from several known poses, with all that is true of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.camera import PinholeCamera, inverse
from rotrecon.drawing import Drawing
from rotrecon.frame import View
from rotrecon.primitives import Simple
from rotrecon.scene.lens import Lens, pinhole
from rotrecon.scene.view_writing import RecordedView
from rotrecon.simulation.flaws import Flaws, sensed, stated_lens, stated_pose
from rotrecon.simulation.ideal_drawing import ideal_drawing, outline_px
from rotrecon.simulation.intruders import neighbour, occluder
from rotrecon.simulation.pictures import Window, picture
from rotrecon.simulation.rendering import RenderedView, World, render
from rotrecon.simulation.simulate import (
    OBJECTS,
    ObjectModel,
    camera_pose,
    depth_range_m,
    object_pose,
    world_around,
)
from rotrecon.simulation.surfaces import Texture, textured

VIEWS_CAMERA = PinholeCamera(1280, 720, np.array([[900.0, 0, 639.5], [0, 900.0, 359.5], [0, 0, 1]]))
VIEW_STEP_M = 0.1
"""Between neighbouring views: the width of common stereo heads."""
WIDEST_BASELINE_M = 0.3
"""Objects are placed so that a camera so far to the right still has them in its picture."""
USUAL_FLAWS = Flaws()
NO_FLAWS = Flaws(noise_levels=0.0)


@dataclass(frozen=True, eq=False)
class Place:
    """Where a picture is taken from, and through what."""

    T_reference_view: Floats
    """(4, 4) rigid; that of the first place is the identity."""
    lens: Lens

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class SimulatedViews:
    """Views and all that is true of them."""

    object_name: str
    seed: int
    texture: Texture
    flaws: Flaws
    views: tuple[View, ...]
    """Undistorted, as a reader of the scene gets them; the first is the reference."""
    recorded: tuple[RecordedView, ...]
    """The same as they were recorded, with the cameras and poses that are stated."""
    true_lenses: tuple[Lens, ...]
    true_poses: tuple[Floats, ...]
    """T_base_camera, (4, 4) each; those of the views are what is stated."""
    solid: Simple
    """In base coordinates."""
    solid_in_camera: Simple
    """In those of the reference camera."""
    drawing: Drawing
    """What an ideal operator would draw in the reference picture."""
    world: World
    """In base coordinates; its first body is the object."""
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
    flaws: Flaws = USUAL_FLAWS,
    *,
    rig: Sequence[Place] | None = None,
    around_px: float | None = None,
) -> SimulatedViews:
    """One object in a random pose, seen from places at +x of the reference; ValueError for unknown names.

    A `rig` has any other places and lenses, and replaces `camera` and `baselines_m`. With `around_px` only a rectangle
    about the object is rendered in each view, so many pixels wider; the rest is black. The same seed and first camera
    are the same scene, whatever the other views, the texture and the flaws.
    """
    if object_name not in OBJECTS:
        raise ValueError(f"there is no object {object_name!r} to simulate; there are {', '.join(OBJECTS)}")
    places = _sideways(camera, baselines_m) if rig is None else tuple(rig)
    if not places or not np.array_equal(places[0].T_reference_view, np.eye(4)):
        raise ValueError("the first place is the reference: its pose is the identity")
    shape, reference = OBJECTS[object_name].shape, places[0].lens.camera
    poses, looks, extras = np.random.default_rng([seed, *object_name.encode()]).spawn(3)
    T_base_camera = camera_pose(poses)
    T_camera_body = object_pose(shape, reference, WIDEST_BASELINE_M, poses)
    model = ObjectModel(shape, textured(texture, shape))
    solid = shape.moved(T_camera_body)
    world = world_around(model, reference, T_base_camera, T_camera_body, looks)
    world = _with_flaws(world, flaws, solid, T_base_camera, extras)
    recorded = _recorded(world, places, T_base_camera, solid, flaws, (seed, *object_name.encode()), around_px)
    views = tuple(
        View(shot.lens.undistort_image(shot.image), shot.lens.camera, shot.T_base_camera) for shot in recorded
    )
    exact = render(world, reference, T_base_camera, supersampling=0)
    return SimulatedViews(
        object_name,
        seed,
        texture,
        flaws,
        views,
        recorded,
        tuple(place.lens for place in places),
        tuple(T_base_camera @ place.T_reference_view for place in places),
        solid.moved(T_base_camera),
        solid,
        ideal_drawing(solid, reference),
        world,
        replace(exact, image=views[0].image),
    )


def _sideways(camera: PinholeCamera, baselines_m: Sequence[float]) -> tuple[Place, ...]:
    offsets = [np.array([baseline_m, 0.0, 0.0]) for baseline_m in baselines_m]
    return tuple(Place(_moved(offset), pinhole(camera)) for offset in offsets)


def _moved(offset_m: Floats) -> Floats:
    pose = np.eye(4)
    pose[:3, 3] = offset_m
    return pose


def _with_flaws(world: World, flaws: Flaws, solid: Simple, T_base_camera: Floats, rng: np.random.Generator) -> World:
    """The world with what is asked for in it, the same whatever else is."""
    in_front, behind = rng.spawn(2)
    bodies = [replace(world.bodies[0], gloss=flaws.glare), *world.bodies[1:]]
    if flaws.occluder:
        bodies.append(occluder(solid, T_base_camera, in_front))
    if flaws.neighbour:
        bodies.append(neighbour(solid, depth_range_m(solid)[1], T_base_camera, behind))
    return World(tuple(bodies), world.toward_light)


def _recorded(
    world: World,
    places: Sequence[Place],
    T_base_camera: Floats,
    solid: Simple,
    flaws: Flaws,
    seed: tuple[int, ...],
    around_px: float | None,
) -> tuple[RecordedView, ...]:
    """Every picture, and what is stated of its camera; each view has chances of its own."""
    toward = np.random.default_rng(seed).uniform(0, 2 * np.pi)
    recorded: list[RecordedView] = []
    for number, place in enumerate(places):
        noise, errors = np.random.default_rng([number, *seed]).spawn(2)
        pose = T_base_camera @ place.T_reference_view
        seen = solid.moved(inverse(place.T_reference_view))
        window = None if around_px is None else _window(seen, place.lens, around_px)
        image = sensed(picture(world, place.lens, pose, window=window), flaws, number, noise)
        lens = stated_lens(place.lens, flaws, toward)
        recorded.append(RecordedView(image, lens, stated_pose(pose, flaws, errors) if number else pose))
    return tuple(recorded)


def _window(solid: Simple, lens: Lens, around_px: float) -> Window:
    """The rectangle about a solid in camera coordinates; empty where it is beyond the picture."""
    camera = lens.camera
    outline = outline_px(solid, camera)
    if not np.isfinite(outline).all():
        return Window(0, 0, camera.width, camera.height)
    outline = lens.project(camera.unproject(outline, np.ones(len(outline))))
    size = np.array([camera.width, camera.height])
    left, top = np.clip(np.floor(outline.min(axis=0) - around_px), 0, size).astype(int)
    right, bottom = np.clip(np.ceil(outline.max(axis=0) + around_px) + 1, 0, size).astype(int)
    return Window(int(left), int(top), int(right), int(bottom))

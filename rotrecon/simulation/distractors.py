"""Scenes without a body of revolution, and the drawing that an operator might still make in them."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, Drawing, ObjectAxis
from rotrecon.frame import Frame, StereoNoise
from rotrecon.simulation.arrangements.boxy import BOXY
from rotrecon.simulation.arrangements.cluttered import CLUTTERED, EMPTY
from rotrecon.simulation.arrangements.flat import FLAT
from rotrecon.simulation.arrangements.placing import Arrangement, Maker
from rotrecon.simulation.raycast import Plane
from rotrecon.simulation.rendering import Body, RenderedView, World, render
from rotrecon.simulation.scenery import concrete, wood
from rotrecon.simulation.stereo_noise import StereoErrors, correlated_noise, stereo_depth

MAKERS: dict[str, Maker] = FLAT | BOXY | CLUTTERED | EMPTY
"""What can be asked for."""
SMALL_CAMERA = PinholeCamera(320, 240, np.array([[400.0, 0, 159.5], [0, 400.0, 119.5], [0, 0, 1]]))
WHITE = StereoErrors(disparity_sigma_px=0.25, correlation_px=0.0, window_px=1, half_occlusion=False, hole_share=0.0)
"""Errors of every pixel on its own."""
UNSTEADY_PX = 1.5
"""How far a hand that is careful misses."""
BORDER_PX = 8.0
"""Least distance of a drawing from the picture's border: five times what the hand misses."""
TOWARD_LIGHT = np.array([-0.36, -0.64, -0.68])
"""A lamp over the operator's left shoulder."""


@dataclass(frozen=True, eq=False)
class Distractor:
    """A frame, and a drawing in it for which there is no certain answer."""

    kind: str
    seed: int
    frame: Frame
    drawing: Drawing
    view: RenderedView
    """What is true, before the camera's errors."""


def distractor(
    kind: str,
    seed: int,
    errors: StereoErrors | None = None,
    camera: PinholeCamera = SMALL_CAMERA,
    picture: bool = False,
) -> Distractor:
    """One of `MAKERS`, the same for the same seed whatever the errors; ValueError for unknown kinds.

    Without errors the depth is exact. The frame states its noise for even seeds only. Without a picture it is black.
    """
    if kind not in MAKERS:
        raise ValueError(f"there is no {kind!r} to simulate; there are {', '.join(MAKERS)}")
    places, hand, looks, chance = np.random.default_rng([seed, *kind.encode()]).spawn(4)
    arrangement = MAKERS[kind](places)
    view = render(_world(arrangement, looks), camera, np.eye(4), 1 if picture else 0)
    if arrangement.bumps is not None:
        height_m, scale_px = arrangement.bumps
        view = replace(view, depth_m=view.depth_m + height_m * correlated_noise(view.depth_m.shape, scale_px, chance))
    depth_m = view.depth_m if errors is None else stereo_depth(view, errors, chance)
    if arrangement.scattered:
        depth_m = chance.uniform(0.4, 2.0, depth_m.shape)
    depth_m = np.where(chance.random(depth_m.shape) < arrangement.kept_share, depth_m, np.nan)
    noise = None if errors is None or seed % 2 else StereoNoise(errors.baseline_m, errors.disparity_sigma_px)
    frame = Frame(view.image, camera.cloud(depth_m), camera, noise=noise)
    return Distractor(kind, seed, frame, _drawing(arrangement, camera, hand), view)


def _world(arrangement: Arrangement, rng: np.random.Generator) -> World:
    flat, solid = concrete(rng), wood(rng)
    bodies = [Body(shape, pose, flat if isinstance(shape, Plane) else solid) for shape, pose in arrangement.placed]
    return World(tuple(bodies), TOWARD_LIGHT)


def _drawing(arrangement: Arrangement, camera: PinholeCamera, rng: np.random.Generator) -> Drawing:
    """The stroke as meant, and an area turned with it: round everything, or only as long as the stroke."""
    start, end = camera.project(arrangement.stroke_m)
    along = (end - start) / np.linalg.norm(end - start)
    turn = np.array([along, [-along[1], along[0]]])
    outline = (camera.project(arrangement.outline_m) - start) @ turn.T
    low, high = outline.min(axis=0) - rng.uniform(3, 10, 2), outline.max(axis=0) + rng.uniform(3, 10, 2)
    if rng.random() < 0.7:
        low[0], high[0] = -rng.uniform(1, 4), np.linalg.norm(end - start) + rng.uniform(1, 4)
    quadrangle = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    area = _clipped(start + quadrangle @ turn, camera)
    stroke = np.clip([start, end], BORDER_PX, np.array([camera.width, camera.height]) - 1 - BORDER_PX)
    area, stroke = (points + UNSTEADY_PX * rng.standard_normal(points.shape) for points in (area, stroke))
    vertices = tuple((round(float(u), 1), round(float(v), 1)) for u, v in area)
    first, last = ((round(float(u), 1), round(float(v), 1)) for u, v in stroke)
    return Drawing(AreaOfInterest(vertices), ObjectAxis(first, last))


def _clipped(polygon_px: Floats, camera: PinholeCamera) -> Floats:
    """The part (N, 2) of a convex polygon that lies well on the picture."""
    left, top, right, bottom = BORDER_PX, BORDER_PX, camera.width - 1 - BORDER_PX, camera.height - 1 - BORDER_PX
    inside = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
    _, common = cv2.intersectConvexConvex(polygon_px.astype(np.float32), inside.astype(np.float32))
    return np.asarray(common, dtype=np.float64).reshape(-1, 2)

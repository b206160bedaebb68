"""Rendered views for the tests of matching, from any places."""

from functools import cache

import cv2
import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.camera import PinholeCamera
from rotrecon.capture import Capture
from rotrecon.frame import Frame, View
from rotrecon.scene.lens import pinhole
from rotrecon.simulation.flaws import Flaws
from rotrecon.simulation.stereo import Place, SimulatedViews, simulate_views

CAMERA = PinholeCamera(640, 360, np.array([[450.0, 0, 319.5], [0, 450.0, 179.5], [0, 0, 1]]))
BASELINE_M = 0.1
SEED = 2


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0, turned_deg: tuple[float, float, float] = (0, 0, 0)) -> Floats:
    """T_reference_view of a camera beside the reference, m, turned about its own axes."""
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(np.deg2rad(np.array(turned_deg, dtype=np.float64)))[0]
    pose[:3, 3] = x, y, z
    return pose


class Rig:
    """Places by name: every rendered one is kept for all tests."""

    SIDEWAYS = at(BASELINE_M)
    LEFT = at(-BASELINE_M)
    VERTICAL = at(0, BASELINE_M)
    CONVERGING = at(BASELINE_M, turned_deg=(0, -5, 0))
    ROLLED = at(BASELINE_M, turned_deg=(2, -4, 25))


def simulated(*places: Floats, camera: PinholeCamera = CAMERA, flaws: Flaws | None = None) -> SimulatedViews:
    """A ball before a wall, seen from the reference and from other places, the last `camera` being that of these."""
    key = tuple(tuple(place.ravel().tolist()) for place in places)
    return _simulated(key, camera, Flaws() if flaws is None else flaws)


@cache
def _simulated(places: tuple[tuple[float, ...], ...], camera: PinholeCamera, flaws: Flaws) -> SimulatedViews:
    rig = [Place(np.eye(4), pinhole(CAMERA))]
    rig += [Place(np.array(place).reshape(4, 4), pinhole(camera)) for place in places]
    return simulate_views("ball", SEED, rig=rig, flaws=flaws)


def frame_of(views: tuple[View, ...]) -> Frame:
    """The whole frame of views that can be matched."""
    frame = Capture("views", views=views).frame()
    assert isinstance(frame, Frame), frame
    return frame


def area_frame_of(scene: SimulatedViews) -> Frame:
    """The frame matched in the ideal drawing's area."""
    frame = Capture("views", views=scene.views).frame(scene.drawing.area)
    assert isinstance(frame, Frame), frame
    return frame


def disparity_errors(frame: Frame, scene: SimulatedViews, inside: Bools) -> Floats:
    """Errors (n,) of inverse depth as disparity of the frame's own baseline, px, where depth is known."""
    assert frame.noise is not None
    scale = frame.camera.focal_px * frame.noise.baseline_m
    errors = scale * (1 / frame.depth_m.astype(np.float64) - 1 / scene.view.depth_m)
    return errors[inside & np.isfinite(errors)]


def inner(scene: SimulatedViews, by_px: int = 4) -> Bools:
    """Pixels of the object, so far inside its outline."""
    kernel = np.ones((2 * by_px + 1, 2 * by_px + 1), dtype=np.uint8)
    return cv2.erode(scene.view.mask.astype(np.uint8), kernel) > 0

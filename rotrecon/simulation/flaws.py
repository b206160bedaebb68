"""What can be wrong with pictures and with what is said of their cameras."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Bytes, Cloud, Floats
from rotrecon.camera import PinholeCamera
from rotrecon.scene.lens import Lens
from rotrecon.simulation.texture import GAMMA


@dataclass(frozen=True)
class Flaws:
    """What is wrong with views; the scene stays the same. Raises ValueError for amounts that cannot be."""

    noise_levels: float = 2.0
    """Standard deviation of a pixel's value, in grey levels of 255. Shot noise, which grows with the root of light, is
    the same at all levels of a picture with gamma 2.2, but for a tenth."""
    blur_px: float = 0.0
    """Sigma of a lens out of focus."""
    gain: float = 1.0
    """Light of each view over that of the one before."""
    glare: float = 0.0
    """Light of a highlight on the object that moves with the camera; 1 is white."""
    pose_error_m: float = 0.0
    """How far the stated place of every view but the first is off."""
    pose_error_deg: float = 0.0
    """How far it is turned."""
    focal_error: float = 0.0
    """Stated focal lengths over the true ones, less 1."""
    principal_error_px: float = 0.0
    """How far the stated principal points are off, in all views the same way."""
    occluder: bool = False
    """A strip across the object, in front of it."""
    neighbour: bool = False
    """A second object, a rod that crosses behind."""

    def __post_init__(self) -> None:
        amounts = [value for name, value in vars(self).items() if name != "focal_error"]
        if not (np.isfinite([*amounts, self.focal_error]).all() and min(amounts) >= 0 and self.gain > 0):
            raise ValueError("no flaw is negative or without a limit, and no gain is zero")
        if self.focal_error <= -1:
            raise ValueError("a focal length stays positive: its error is above -1")


def sensed(light: Cloud, flaws: Flaws, number: int, rng: np.random.Generator) -> Bytes:
    """What the camera of a view makes of linear light (height, width, 3): a picture of the same shape."""
    if flaws.blur_px > 0:
        light = np.asarray(cv2.GaussianBlur(light, (0, 0), flaws.blur_px), dtype=np.float32)
    levels = 255 * (light * np.float32(flaws.gain**number)).clip(0, 1) ** np.float32(1 / GAMMA)
    noise = rng.standard_normal(light.shape, np.float32)
    return np.rint(levels + np.float32(flaws.noise_levels) * noise).clip(0, 255).astype(np.uint8)


def stated_pose(T_base_camera: Floats, flaws: Flaws, rng: np.random.Generator) -> Floats:
    """A pose (4, 4) off by the stated amounts, in directions of chance."""
    turn, shift = (vector / np.linalg.norm(vector) for vector in rng.standard_normal((2, 3)))
    error = np.eye(4)
    error[:3, :3] = cv2.Rodrigues(np.deg2rad(flaws.pose_error_deg) * turn)[0]
    error[:3, 3] = flaws.pose_error_m * shift
    return T_base_camera @ error


def stated_lens(lens: Lens, flaws: Flaws, toward: float) -> Lens:
    """A lens whose calibration is off by the stated amounts, its principal point in a direction, rad."""
    camera, K = lens.camera, lens.camera.K.copy()
    K[[0, 1], [0, 1]] *= 1 + flaws.focal_error
    K[:2, 2] += flaws.principal_error_px * np.array([np.cos(toward), np.sin(toward)])
    return Lens(PinholeCamera(camera.width, camera.height, K), lens.distortion)

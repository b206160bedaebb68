"""The distance between two points of a frame that somebody pointed at."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.camera import transform
from rotrecon.frame import DepthCameraNoise, Frame, StereoNoise

WINDOW_PX = 2
"""Pixels round a point whose median depth counts: single depths may be wrong or missing."""


@dataclass(frozen=True, eq=False)
class Distance:
    """Two points in base coordinates."""

    points_m: Floats
    """(2, 3)"""
    length_m: float
    sigma_m: float | None
    """Standard deviation of the length by the stated noise of single depths; None where the scene states none."""

    def __post_init__(self) -> None:
        freeze(self)


def distance_between(frame: Frame, first_px: tuple[float, float], second_px: tuple[float, float]) -> Distance | str:
    """The distance between two pixels, or a sentence why there is none."""
    ends = [_point(frame, pixel) for pixel in (first_px, second_px)]
    for name, end in zip(("first", "second"), ends, strict=True):
        if end is None:
            return f"there is no depth at the {name} point; point beside it"
    points = np.array(ends)
    apart = points[1] - points[0]
    length_m = float(np.linalg.norm(apart))
    sigma_m = None
    if frame.noise is not None and length_m > 0:
        # an end that errs along its ray by s lengthens the distance by s times the cosine between the two
        by_depth = (points / points[:, 2:]) @ (apart / length_m)
        sigma_m = float(np.hypot(*(by_depth * np.array([_sigma_m(frame.noise, frame, z) for z in points[:, 2]]))))
    return Distance(transform(frame.T_base_camera, points), length_m, sigma_m)


def _point(frame: Frame, pixel: tuple[float, float]) -> Floats | None:
    """A point (3,) in camera coordinates: the pixel's ray at the median depth round it."""
    u, v = (round(value) for value in pixel)
    if not (0 <= u < frame.camera.width and 0 <= v < frame.camera.height):
        return None
    rows = slice(max(v - WINDOW_PX, 0), v + WINDOW_PX + 1)
    columns = slice(max(u - WINDOW_PX, 0), u + WINDOW_PX + 1)
    depth_m = frame.depth_m[rows, columns]
    depth_m = depth_m[np.isfinite(depth_m)]
    return frame.camera.unproject(pixel, float(np.median(depth_m))) if len(depth_m) else None


def _sigma_m(noise: StereoNoise | DepthCameraNoise, frame: Frame, depth_m: float) -> float:
    if isinstance(noise, StereoNoise):
        return noise.disparity_sigma_px * depth_m**2 / (frame.camera.focal_px * noise.baseline_m)
    return noise.sigma0_m + noise.sigma2_per_m * depth_m**2

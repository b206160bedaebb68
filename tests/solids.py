"""A solid in front of a camera, for tests that need no picture of it."""

from typing import Literal

import numpy as np

from rotrecon.primitives import Frustum

CAMERA_M = np.zeros(3)
CENTER_M, ALONG = np.array([0, 0, 0.8]), np.array([0, 1.0, 0])


def pipe(
    diameter_m: float = 0.06,
    length_m: float = 0.3,
    kind: Literal["cylinder", "rod", "cone"] = "cylinder",
    half_angle_rad: float = 0.0,
) -> Frustum:
    return Frustum(kind, CENTER_M, ALONG, length_m, diameter_m / 2, half_angle_rad)

"""The Cramer-Rao bound: how small the error of a size can be on average, whoever measures it without bias.

It shares nothing with the program's own derivatives: the ray is intersected here once more, in complex numbers, whose
imaginary part is the derivative to rounding (Squire and Trapp 1998).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.bench.accuracy.clouds import CAMERA, FOCAL_BASELINE, Cloud, Pose
from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.primitives import Simple, Sphere, basis_across

STEP = 1e-20
"""Of the complex step: its square vanishes beside 1, and nothing is subtracted."""
UNKNOWNS = {"cylinder": 5, "rod": 5, "cone": 6, "sphere": 4}
"""Position, direction and size that a fit of each kind has to find."""

Numbers = np.ndarray[Any, np.dtype[Any]]
"""Real or complex."""


@dataclass(frozen=True)
class Bound:
    """Smallest standard deviations, relative to the true value."""

    radius: float
    half_angle: float
    """NaN but for a cone."""


@dataclass(frozen=True, eq=False)
class Derivatives:
    """How the disparity of a pose's own pixels changes with every unknown."""

    pixel: Bools
    """(H, W) the N pixels."""
    of_disparity: Floats
    """(N, P), px per metre, or per unit of slope."""

    def __post_init__(self) -> None:
        freeze(self)


def derivatives(pose: Pose) -> Derivatives:
    """Unknown are the axis (2 + 2), the radius and, of a cone, the slope; of a ball the centre and the radius."""
    v, u = np.nonzero(pose.lateral)
    rays = CAMERA.unproject(np.stack([u, v], axis=-1), np.ones(len(u)))
    solid = pose.solid
    columns: list[Floats] = []
    for number in range(UNKNOWNS[solid.kind]):
        change = np.zeros(6, dtype=np.complex128)
        change[number] = STEP * 1j
        columns.append(np.imag(FOCAL_BASELINE / near_depth(solid, change, rays)) / STEP)
    return Derivatives(pose.lateral, np.stack(columns, axis=1))


def cramer_rao(cloud: Cloud, known: Derivatives) -> Bound:
    """The bound from the object's own pixels that are no outliers, as drawn; noise counts as white."""
    jacobian = known.of_disparity[cloud.own[known.pixel]]
    covariance = cloud.sigma_px**2 * np.asarray(np.linalg.inv(jacobian.T @ jacobian), dtype=np.float64)
    solid = cloud.truth
    if isinstance(solid, Sphere):
        return Bound(_deviation(covariance, [0, 0, 0, 1]) / solid.radius_m, np.nan)
    if solid.half_angle_rad == 0:
        return Bound(_deviation(covariance, [0, 0, 0, 0, 1]) / solid.radius_m, np.nan)
    middle = float((cloud.place_m - solid.center_m) @ solid.direction)
    half_angle = np.cos(solid.half_angle_rad) ** 2 * _deviation(covariance, [0, 0, 0, 0, 0, 1])
    radius = _deviation(covariance, [0, 0, 0, 0, 1, middle])
    return Bound(radius / float(solid.radius_at(middle)), half_angle / abs(solid.half_angle_rad))


def near_depth(solid: Simple, change: Numbers, rays: Floats) -> Numbers:
    """Depth (N,) at which rays meet the near side of a solid whose unknowns are changed."""
    if isinstance(solid, Sphere):
        center, radius = solid.center_m + change[:3], solid.radius_m + change[3]
        return _near_root((rays**2).sum(axis=1), -(rays @ center), center @ center - radius**2)
    first, second = basis_across(solid.direction, -solid.center_m)
    center = solid.center_m + change[0] * first + change[1] * second
    axis = solid.direction + change[2] * first + change[3] * second
    axis = axis / np.sqrt(axis @ axis)
    slope = np.tan(solid.half_angle_rad) + change[5]
    leaning, height = rays @ axis, center @ axis
    radius = solid.radius_m + change[4] - slope * height
    return _near_root(
        (rays**2).sum(axis=1) - (1 + slope**2) * leaning**2,
        -(rays @ center) + leaning * height - slope * leaning * radius,
        center @ center - height**2 - radius**2,
    )


def _near_root(a: Numbers, half_b: Numbers, c: Numbers) -> Numbers:
    """Smaller root (N,) of a t^2 + 2 half_b t + c = 0."""
    return (-half_b - np.sqrt(half_b**2 - a * c)) / a


def _deviation(covariance: Floats, weights: Sequence[float]) -> float:
    """Standard deviation of a weighted sum of the unknowns."""
    return float(np.sqrt(np.array(weights) @ covariance @ np.array(weights)))

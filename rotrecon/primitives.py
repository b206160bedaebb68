"""The solids an object can be: geometry only, in whatever frame their numbers are given."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rotrecon.arrays import Cloud, Floats, freeze
from rotrecon.camera import rotate, transform

Kind = Literal["cylinder", "rod", "sphere", "cone", "revolution"]
KINDS: tuple[Kind, ...] = ("cylinder", "rod", "sphere", "cone")
"""The kinds that can be asked for."""


@dataclass(frozen=True, eq=False)
class Frustum:
    """A cylinder, rod or cone: a piece of a surface whose radius is linear along its axis."""

    kind: Literal["cylinder", "rod", "cone"]
    center_m: Floats
    """(3,) middle of the axis."""
    direction: Floats
    """(3,) unit, along the operator's stroke."""
    length_m: float
    radius_m: float
    """At the middle."""
    half_angle_rad: float = 0.0
    """Positive where the radius grows along the direction."""

    def __post_init__(self) -> None:
        freeze(self)

    def radius_at(self, along_m: Floats | float) -> Floats:
        """Radius at signed distances from the middle, along the axis."""
        return np.maximum(self.radius_m + np.tan(self.half_angle_rad) * np.asarray(along_m, dtype=np.float64), 0.0)

    @property
    def ends(self) -> tuple[float, float]:
        """Signed distances of the two ends from the middle."""
        return (-self.length_m / 2, self.length_m / 2)

    def moved(self, T_target_source: Floats) -> "Frustum":
        """The same solid in another frame."""
        return Frustum(
            self.kind,
            transform(T_target_source, self.center_m),
            rotate(T_target_source, self.direction),
            self.length_m,
            self.radius_m,
            self.half_angle_rad,
        )

    def distance(self, points_m: Floats | Cloud) -> Floats:
        """Signed orthogonal distance (...) of points (..., 3) from the surface, ends unbounded; outside is positive."""
        offset = points_m - self.center_m
        along = offset @ self.direction
        across = np.linalg.norm(offset - along[..., None] * self.direction, axis=-1)
        return (across - self.radius_m - np.tan(self.half_angle_rad) * along) * np.cos(self.half_angle_rad)


@dataclass(frozen=True, eq=False)
class Sphere:
    """A ball; its direction is only the operator's stroke, which orders its sections."""

    center_m: Floats
    direction: Floats
    radius_m: float
    kind: Literal["sphere"] = "sphere"

    def __post_init__(self) -> None:
        freeze(self)

    def radius_at(self, along_m: Floats | float) -> Floats:
        """Radius of the section at signed distances from the centre, along the direction."""
        return np.sqrt(np.maximum(self.radius_m**2 - np.asarray(along_m, dtype=np.float64) ** 2, 0.0))

    @property
    def ends(self) -> tuple[float, float]:
        """Signed distances of the two poles from the centre."""
        return (-self.radius_m, self.radius_m)

    def moved(self, T_target_source: Floats) -> "Sphere":
        """The same solid in another frame."""
        return Sphere(transform(T_target_source, self.center_m), rotate(T_target_source, self.direction), self.radius_m)

    def distance(self, points_m: Floats | Cloud) -> Floats:
        """Signed orthogonal distance (...) of points (..., 3) from the surface; outside is positive."""
        return np.linalg.norm(points_m - self.center_m, axis=-1) - self.radius_m


Primitive = Frustum | Sphere


def basis_across(direction: Floats, toward: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors that make a right-handed frame with `direction`; the second points toward `toward`.

    Shapes (3,). Where `toward` is along the direction, any pair that completes the frame is returned.
    """
    up = toward - (toward @ direction) * direction
    if np.linalg.norm(up) < 1e-9 * max(float(np.linalg.norm(toward)), 1e-300):
        up = np.eye(3)[np.argmin(np.abs(direction))]
        up = up - (up @ direction) * direction
    up = up / np.linalg.norm(up)
    return np.cross(up, direction), up

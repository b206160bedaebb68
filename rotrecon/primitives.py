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


@dataclass(frozen=True, eq=False)
class Revolution:
    """A general solid of revolution: radii at positions along its axis, straight between them.

    Raises ValueError for a profile that cannot be one.
    """

    center_m: Floats
    """(3,) a point of the axis between the ends; what is said of its middle is said of here."""
    direction: Floats
    """(3,) unit, along the operator's stroke."""
    along_m: Floats
    """(n,) rising positions from the centre, the ends first and last, 0 between them."""
    radii_m: Floats
    """(n,) at those positions."""
    kind: Literal["revolution"] = "revolution"

    def __post_init__(self) -> None:
        along_m, radii_m = self.along_m, self.radii_m
        if along_m.ndim != 1 or len(along_m) < 2 or along_m.shape != radii_m.shape:
            raise ValueError(f"a profile is two positions or more and as many radii: {along_m.shape}, {radii_m.shape}")
        if not (np.diff(along_m) > 0).all() or not along_m[0] < 0 < along_m[-1]:
            raise ValueError("the positions of a profile rise from below 0 to above it")
        if not (radii_m >= 0).all():
            raise ValueError("no radius of a profile is negative")
        freeze(self)

    @property
    def radius_m(self) -> float:
        """At the middle."""
        return float(self.radius_at(0.0))

    def radius_at(self, along_m: Floats | float) -> Floats:
        """Radius at signed distances from the middle, along the axis; beyond an end that of the end."""
        return np.interp(np.asarray(along_m, dtype=np.float64), self.along_m, self.radii_m)

    def slope_at(self, along_m: Floats | float) -> Floats:
        """Growth of the radius at signed distances from the middle; where it bends, that of the piece before it."""
        slopes = np.concatenate([[0.0], np.diff(self.radii_m) / np.diff(self.along_m), [0.0]])
        return slopes[np.searchsorted(self.along_m, np.asarray(along_m, dtype=np.float64))]

    @property
    def ends(self) -> tuple[float, float]:
        """Signed distances of the two ends from the middle."""
        return (float(self.along_m[0]), float(self.along_m[-1]))

    def moved(self, T_target_source: Floats) -> "Revolution":
        """The same solid in another frame."""
        center_m, direction = transform(T_target_source, self.center_m), rotate(T_target_source, self.direction)
        return Revolution(center_m, direction, self.along_m, self.radii_m)

    def distance(self, points_m: Floats | Cloud) -> Floats:
        """Signed distance (...) of points (..., 3) from the surface, ends unbounded; outside is positive.

        Orthogonal to the piece of the profile that a point is beside, and so to first order to the surface.
        """
        offset = points_m - self.center_m
        along = offset @ self.direction
        across = np.linalg.norm(offset - along[..., None] * self.direction, axis=-1)
        return (across - self.radius_at(along)) / np.hypot(1.0, self.slope_at(along))


Simple = Frustum | Sphere
"""Solids that a handful of numbers describe."""
Primitive = Simple | Revolution


def in_words(kind: str) -> str:
    """A kind of solid as it is called in a sentence."""
    return "solid of revolution" if kind == "revolution" else kind


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

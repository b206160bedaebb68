"""Where a tool would touch an object, and from which side it comes there."""

from dataclasses import dataclass
from math import pi

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.primitives import Primitive

MOST_ANGLE_RAD = pi / 2
"""How far an approach may be turned about the axis to either side: beyond, it touches what no camera has seen."""


@dataclass(frozen=True)
class Place:
    """Two numbers that an operator may change of a contact: 0, 0 is the one that is proposed."""

    angle_rad: float = 0.0
    """By which the approach is turned about the object's direction, from the camera's side, right-handed."""
    along_m: float = 0.0
    """From the middle of the object along its direction."""


PROPOSED = Place()


@dataclass(frozen=True, eq=False)
class Contact:
    """A point of the surface and the way to it, in the solid's own frame."""

    point_m: Floats
    """(3,) on the surface."""
    approach: Floats
    """(3,) unit: the way the tool moves to get there, at right angles to the object's direction."""

    def __post_init__(self) -> None:
        freeze(self)


def limits_of(solid: Primitive) -> Place:
    """The largest angle and distance from the middle, to either side, that a contact may have."""
    return Place(MOST_ANGLE_RAD, min(-solid.ends[0], solid.ends[1]))


def within(place: Place, solid: Primitive) -> Place:
    """The place, or the nearest within the limits of a solid; what is not a number becomes 0."""
    most = limits_of(solid)
    angle, along = np.nan_to_num([place.angle_rad, place.along_m], nan=0.0)
    return Place(
        float(np.clip(angle, -most.angle_rad, most.angle_rad)), float(np.clip(along, -most.along_m, most.along_m))
    )


def contact_on(solid: Primitive, camera_center_m: Floats, place: Place = PROPOSED) -> Contact:
    """The contact at a place of a solid that a camera at (3,) looks at, both in one frame.

    It comes from the camera's side, square to the axis unless the camera looks along it; a ball is met along the line
    of sight to its centre, unless the place is another than the proposed one.
    """
    place = within(place, solid)
    sight = solid.center_m - camera_center_m
    is_straight = solid.kind == "sphere" and place == PROPOSED
    approach = sight if is_straight else sight - (sight @ solid.direction) * solid.direction
    length = float(np.linalg.norm(approach))
    approach = approach / length if length > 0 else np.array([0.0, 0.0, 1.0])
    if place.angle_rad:
        sine, cosine = np.sin(place.angle_rad), np.cos(place.angle_rad)
        approach = cosine * approach + sine * np.cross(solid.direction, approach)
    middle_m = solid.center_m + place.along_m * solid.direction
    return Contact(middle_m - float(solid.radius_at(place.along_m)) * approach, approach)

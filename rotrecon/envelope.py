"""The space a tool takes at an object and on its way there, as boxes; and what of the cloud is in it."""

from dataclasses import dataclass

import numpy as np
import trimesh

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.contact import Contact
from rotrecon.primitives import Primitive
from rotrecon.tool_table import Tool

JAW_M = 0.012
"""Thickness of a jaw, which no tool table states: that of common cutters and two-finger grips, rounded up."""
BLADE_M = 0.03
"""Breadth of jaws and blade along the object, rounded up alike."""
BODY_M = 0.08
"""How far behind its mouth a tool is as broad as its jaws: behind that is the arm, whose own planner minds it."""
TIP_M = 0.01
"""By which the tips stand beyond the object: blades must pass it to close on it."""
STANDOFF_M = 0.1
"""From where the last, straight part of the way begins."""
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Box:
    """A cuboid in base coordinates."""

    turn: Floats
    """(3, 3) rows: unit vectors across the mouth, along the object, and of the approach."""
    center_m: Floats
    """(3,)"""
    half_m: Floats
    """(3,) half its lengths along those."""

    def __post_init__(self) -> None:
        freeze(self)

    def holds(self, points_m: Floats) -> Bools:
        """Which points (..., 3) are in it, its border included."""
        return np.asarray((np.abs((points_m - self.center_m) @ self.turn.T) <= self.half_m).all(axis=-1))

    @property
    def corners_m(self) -> Floats:
        """(8, 3)"""
        return self.center_m + (CORNERS * self.half_m) @ self.turn

    def as_mesh(self) -> trimesh.Trimesh:
        """A closed mesh, metres."""
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = self.turn.T, self.center_m
        return trimesh.creation.box(2 * self.half_m, pose)  # pyright: ignore[reportUnknownMemberType]


@dataclass(frozen=True, eq=False)
class Envelope:
    """A tool at an object, its mouth open; base coordinates."""

    mouth: Box
    """Between the jaws: what the blade sweeps when it closes."""
    jaws: tuple[Box, Box]
    body: Box
    """Behind the mouth."""
    way: Box
    """What jaws and mouth sweep on the straight last part of the way, and the tool at its end."""
    start_m: Floats
    """(3,) where the bottom of the mouth is when that part begins."""
    bottom_m: Floats
    """(3,) the middle of the bottom of the mouth at the object."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def solid(self) -> tuple[Box, ...]:
        """What is of steel."""
        return (*self.jaws, self.body)


def envelope_of(tool: Tool, solid: Primitive, contact: Contact, diameter_m: float) -> Envelope:
    """The envelope of a tool at a contact of a solid, both in base coordinates, whose diameter there is at most this.

    The mouth is the tool's opening by its depth; where the table does not say, as wide and as deep as the thickest
    object that it takes. It goes in until the tips stand beyond the object, or the object touches its bottom.
    """
    opening_m = (tool.opening_mm or tool.diameter_mm[1]) / 1000
    depth_m = (tool.depth_mm or tool.diameter_mm[1]) / 1000
    # a ball met along the line of sight may lie askew to its stroke
    along = solid.direction - (solid.direction @ contact.approach) * contact.approach
    length = float(np.linalg.norm(along))
    along = along / length if length > 1e-9 else _any_across(contact.approach)
    turn = np.stack([np.cross(along, contact.approach), along, contact.approach])
    # the thickest that it may be reaches nearer to the camera, too
    swell_m = max(diameter_m / 2 - float(solid.radius_at(_along(solid, contact))), 0.0)
    front_m = contact.point_m - swell_m * contact.approach
    back = max(depth_m - diameter_m - TIP_M, 0.0)
    bottom_m = front_m - back * contact.approach

    def box(across_m: float, half_across_m: float, from_m: float, to_m: float) -> Box:
        middle = bottom_m + across_m * turn[0] + (from_m + to_m) / 2 * turn[2]
        return Box(turn, middle, np.array([half_across_m, BLADE_M / 2, (to_m - from_m) / 2]))

    aside_m, outer_m = opening_m / 2 + JAW_M / 2, opening_m / 2 + JAW_M
    return Envelope(
        mouth=box(0.0, opening_m / 2, 0.0, depth_m),
        jaws=(box(-aside_m, JAW_M / 2, 0.0, depth_m), box(aside_m, JAW_M / 2, 0.0, depth_m)),
        body=box(0.0, outer_m, -BODY_M, 0.0),
        way=box(0.0, outer_m, -BODY_M - STANDOFF_M, depth_m),
        start_m=bottom_m - STANDOFF_M * contact.approach,
        bottom_m=bottom_m,
    )


def _along(solid: Primitive, contact: Contact) -> float:
    return float((contact.point_m - solid.center_m) @ solid.direction)


def _any_across(direction: Floats) -> Floats:
    across = np.eye(3)[int(np.argmin(np.abs(direction)))]
    across = across - (across @ direction) * direction
    return across / np.linalg.norm(across)

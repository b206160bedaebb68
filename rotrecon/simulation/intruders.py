"""What else may stand near the object that is to be measured."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.primitives import Frustum, Simple, basis_across
from rotrecon.simulation.raycast import Box
from rotrecon.simulation.rendering import Body
from rotrecon.simulation.surfaces import textured

STRIP_DEPTH = 0.7
"""Depth of the occluder over that of the object: far enough in front to be told apart, and seen by every camera."""
STRIP_SHARE = 0.12
"""Share of the object's length that it hides from the reference."""
STRIP_HALF_LENGTH_M, STRIP_HALF_THICKNESS_M = 0.25, 0.002
"""It reaches beyond both sides of every object that is simulated, also as other cameras see it."""
ROD_RADIUS_M, ROD_LENGTH_M = 0.015, 0.5
"""Of the neighbour: as thin as the objects of interest are."""
ROD_BEHIND_M = 0.12
"""Depth between the object and the neighbour: less than to any wall."""


def occluder(solid: Simple, T_base_camera: Floats, rng: np.random.Generator) -> Body:
    """A strip in front of a solid, which is in camera coordinates, square to its axis and off its middle."""
    length_m = float(np.ptp(solid.ends))
    place = solid.center_m + rng.choice([-1, 1]) * rng.uniform(0.15, 0.3) * length_m * solid.direction
    toward = -place / np.linalg.norm(place)
    across, along = basis_across(toward, solid.direction)
    strip = Box((STRIP_HALF_LENGTH_M, STRIP_DEPTH * STRIP_SHARE * length_m / 2, STRIP_HALF_THICKNESS_M))
    pose = _pose(STRIP_DEPTH * place, np.stack([across, along, toward], axis=1))
    # the texture has no use for the shape: only a pattern that repeats does
    return Body(strip, T_base_camera @ pose, textured("coarse", solid)(rng))


def neighbour(solid: Simple, farthest_m: float, T_base_camera: Floats, rng: np.random.Generator) -> Body:
    """A rod behind a solid, which is in camera coordinates and ends at a depth, and across it."""
    place = solid.center_m * (farthest_m + ROD_BEHIND_M) / solid.center_m[2]
    aside, along = basis_across(place / np.linalg.norm(place), solid.direction)
    lean = rng.uniform(-0.5, 0.5)
    axis = np.cos(lean) * aside + np.sin(lean) * along
    rod = Frustum("rod", np.zeros(3), np.array([0.0, 0.0, 1.0]), ROD_LENGTH_M, ROD_RADIUS_M)
    pose = _pose(place, np.stack([*basis_across(axis, -place), axis], axis=1))
    return Body(rod, T_base_camera @ pose, textured("fine", rod)(rng))


def _pose(middle_m: Floats, rotation: Floats) -> Floats:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, middle_m
    return pose

"""Solids as triangle meshes, for the 3D scene and for files."""

import numpy as np
import trimesh

from rotrecon.arrays import Floats
from rotrecon.primitives import Frustum, Primitive, Revolution, Sphere, basis_across

FACETS = 64
"""Triangles round a mesh: a 216 mm ball is then 0.26 mm off a true circle at most."""


def as_mesh(solid: Primitive) -> trimesh.Trimesh:
    """A closed mesh of a solid, in the solid's own frame, metres."""
    if isinstance(solid, Sphere):
        angle = np.linspace(-np.pi / 2, np.pi / 2, FACETS // 2 + 1)
        profile = solid.radius_m * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        profile[[0, -1], 0] = 0.0
    else:
        profile = _lateral_profile(solid)
    x, y = basis_across(solid.direction, np.array([0.0, 0.0, 1.0]))
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, y, solid.direction], axis=1)
    pose[:3, 3] = solid.center_m
    return trimesh.creation.revolve(profile, sections=FACETS, transform=pose)  # pyright: ignore[reportUnknownMemberType]


def _lateral_profile(solid: Frustum | Revolution) -> Floats:
    """Radius and height (n, 2) of the half section, from the middle of one base to the middle of the other."""
    height = solid.along_m if isinstance(solid, Revolution) else np.array(solid.ends)
    side = np.stack([solid.radius_at(height), height], axis=1)
    low, high = solid.ends
    return np.concatenate([[[0.0, low]], side, [[0.0, high]]])

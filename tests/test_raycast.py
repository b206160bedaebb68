"""Rays meet the surface they are aimed at, and nothing in front of it."""

import numpy as np
import pytest

from rotrecon.primitives import Frustum, Sphere
from rotrecon.simulation.raycast import (
    Box,
    Plane,
    Prism,
    Shape,
    Stretched,
    bounding_radius_m,
    first_hit,
    outward_normals,
)

AXIS = np.array([0.0, 0.0, 1.0])
CYLINDER = Frustum("cylinder", np.zeros(3), AXIS, 0.4, 0.05)
CONE = Frustum("cone", np.zeros(3), AXIS, 0.15, 0.05, np.deg2rad(15))
POINTED_CONE = Frustum("cone", np.zeros(3), AXIS, 0.4, 0.05, np.deg2rad(-30))
BALL = Sphere(np.zeros(3), AXIS, 0.108)
BOX = Box((0.05, 0.08, 0.15))
PENCIL = Prism(6, 0.06, 0.3)
PYRAMID = Prism(4, 0.05, 0.15, np.deg2rad(-15))
SOLIDS = [
    CYLINDER, CONE, POINTED_CONE, BALL, BOX, PENCIL, PYRAMID,
    Stretched(CYLINDER, (1.0, 0.5, 1.0)), Stretched(BALL, (0.6, 1.0, 1.4)),
    Stretched(Prism(3, 0.05, 0.3), (0.4, 1.5, 1.0)),
]  # fmt: skip


def aimed_rays(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3))
    origins /= np.linalg.norm(origins, axis=1, keepdims=True)
    return origins, rng.normal(scale=0.08, size=(count, 3)) - origins


def outside_by(shape: Shape, points: np.ndarray) -> np.ndarray:
    """Negative within a solid, zero on its surface, positive outside."""
    if isinstance(shape, Stretched):
        return outside_by(shape.shape, points / np.array(shape.scale))
    if isinstance(shape, Box):
        return (np.abs(points) - shape.half_lengths_m).max(axis=-1)
    if isinstance(shape, Sphere):
        return shape.distance(points)
    x, y, z = np.moveaxis(points, -1, 0)
    beyond_end = np.abs(z) - shape.length_m / 2
    if isinstance(shape, Prism):
        # a side spans its share of the full turn: the angle from its middle says how far off the axis it is
        share = 2 * np.pi / shape.sides
        turn = (np.arctan2(y, x) + share / 2) % share - share / 2
        off_side = np.hypot(x, y) * np.cos(turn) - shape.inradius_m - np.tan(shape.half_angle_rad) * z
        return np.maximum(off_side, beyond_end)
    assert isinstance(shape, Frustum)
    off_apex = -(shape.radius_m + np.tan(shape.half_angle_rad) * z)
    return np.maximum.reduce([shape.distance(points), beyond_end, off_apex])


@pytest.mark.parametrize("solid", SOLIDS)
def test_a_hit_is_on_the_surface(solid: Shape) -> None:
    origins, directions = aimed_rays(4000)
    depth = first_hit(solid, origins, directions)
    met = np.isfinite(depth)
    assert met.mean() > 0.2
    points = (origins + np.where(met, depth, 0)[:, None] * directions)[met]
    assert np.abs(outside_by(solid, points)).max() < 1e-9
    farthest = np.linalg.norm(points, axis=1).max()
    assert 0.5 * bounding_radius_m(solid) < farthest <= bounding_radius_m(solid)


@pytest.mark.parametrize("solid", SOLIDS)
def test_nothing_lies_before_a_hit_and_a_miss_stays_outside(solid: Shape) -> None:
    origins, directions = aimed_rays(1500, seed=1)
    depth = first_hit(solid, origins, directions)
    until = np.where(np.isfinite(depth), depth, 2.0)
    share = np.linspace(0, 1, 200)[:, None, None]
    assert (outside_by(solid, origins + share * until[:, None] * directions) > -1e-9).all()


@pytest.mark.parametrize("solid", SOLIDS)
def test_normals_are_unit_and_square_to_the_surface(solid: Shape) -> None:
    origins, directions = aimed_rays(2000, seed=2)
    depth = first_hit(solid, origins, directions)
    met = np.isfinite(depth)
    points = (origins + np.where(met, depth, 0)[:, None] * directions)[met]
    normals = outward_normals(solid, points)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-12)
    assert (np.einsum("ij,ij->i", normals, directions[met]) <= 1e-9).all()
    assert (outside_by(solid, points + 1e-6 * normals) > 0).all()
    # away from edges, the surface does not rise or fall along any direction square to its normal
    aside = np.cross(normals, np.random.default_rng(3).normal(size=normals.shape))
    change = outside_by(solid, points + 1e-6 * aside) - outside_by(solid, points - 1e-6 * aside)
    assert np.quantile(np.abs(change), 0.98) < 1e-10


@pytest.mark.parametrize("solid", SOLIDS)
def test_from_within_a_solid_its_far_side_is_seen(solid: Shape) -> None:
    directions = np.random.default_rng(4).normal(size=(500, 3))
    depth = first_hit(solid, np.zeros(3), directions)
    assert np.abs(outside_by(solid, depth[:, None] * directions)).max() < 1e-9


@pytest.mark.parametrize("shape", [*SOLIDS, Plane()])
def test_what_is_behind_is_not_seen(shape: Shape) -> None:
    assert np.isinf(first_hit(shape, np.array([0.01, 0.02, 1.0]), np.array([[0.0, 0.0, 1.0]]))).all()


@pytest.mark.parametrize("beside_m", [0.0500001, 0.2])
def test_a_ray_along_a_face_of_a_box_passes_by(beside_m: float) -> None:
    aside = np.array([beside_m, 0.0, 1.0])
    assert np.isinf(first_hit(BOX, aside, np.array([[0.0, 0.0, -1.0]]))).all()
    assert first_hit(BOX, aside * [0, 1, 1], np.array([[0.0, 0.0, -1.0]])) == pytest.approx(0.85)


def test_a_plane_is_met_at_its_height() -> None:
    assert first_hit(Plane(), np.array([0.0, 0.0, 2.0]), np.array([[1.0, 0.0, -0.5]])) == pytest.approx(4.0)

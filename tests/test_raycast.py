"""Rays meet the surface they are aimed at, and nothing in front of it."""

import numpy as np
import pytest

from rotrecon.primitives import Frustum, Sphere
from rotrecon.simulation.raycast import Plane, Shape, first_hit, outward_normals

AXIS = np.array([0.0, 0.0, 1.0])
CYLINDER = Frustum("cylinder", np.zeros(3), AXIS, 0.4, 0.05)
CONE = Frustum("cone", np.zeros(3), AXIS, 0.15, 0.05, np.deg2rad(15))
POINTED_CONE = Frustum("cone", np.zeros(3), AXIS, 0.4, 0.05, np.deg2rad(-30))
BALL = Sphere(np.zeros(3), AXIS, 0.108)
SOLIDS = [CYLINDER, CONE, POINTED_CONE, BALL]


def aimed_rays(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3))
    origins /= np.linalg.norm(origins, axis=1, keepdims=True)
    return origins, rng.normal(scale=0.08, size=(count, 3)) - origins


def inside(solid: Frustum | Sphere, points: np.ndarray) -> np.ndarray:
    within = solid.distance(points) < -1e-9
    if isinstance(solid, Frustum):
        z = points[..., 2]
        within &= (np.abs(z) < solid.length_m / 2 - 1e-9) & (solid.radius_m + np.tan(solid.half_angle_rad) * z > 0)
    return within


@pytest.mark.parametrize("solid", SOLIDS)
def test_a_hit_is_on_the_surface(solid: Frustum | Sphere) -> None:
    origins, directions = aimed_rays(4000)
    depth = first_hit(solid, origins, directions)
    met = np.isfinite(depth)
    assert met.mean() > 0.2
    points = (origins + np.where(met, depth, 0)[:, None] * directions)[met]
    on_surface = np.abs(solid.distance(points)) < 1e-9
    if isinstance(solid, Frustum):
        on_cap = np.abs(np.abs(points[:, 2]) - solid.length_m / 2) < 1e-9
        assert (on_surface | (on_cap & (solid.distance(points) < 1e-9))).all()
    else:
        assert on_surface.all()


@pytest.mark.parametrize("solid", SOLIDS)
def test_nothing_lies_before_a_hit_and_a_miss_stays_outside(solid: Frustum | Sphere) -> None:
    origins, directions = aimed_rays(1500, seed=1)
    depth = first_hit(solid, origins, directions)
    until = np.where(np.isfinite(depth), depth, 2.0)
    share = np.linspace(0, 1, 200)[:, None, None]
    assert not inside(solid, origins + share * until[:, None] * directions).any()


@pytest.mark.parametrize("solid", SOLIDS)
def test_normals_are_unit_and_point_out_of_the_solid(solid: Frustum | Sphere) -> None:
    origins, directions = aimed_rays(2000, seed=2)
    depth = first_hit(solid, origins, directions)
    met = np.isfinite(depth)
    points = (origins + np.where(met, depth, 0)[:, None] * directions)[met]
    normals = outward_normals(solid, points)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-12)
    assert (np.einsum("ij,ij->i", normals, directions[met]) <= 1e-9).all()
    assert not inside(solid, points + 1e-6 * normals).any()


@pytest.mark.parametrize("shape", [*SOLIDS, Plane()])
def test_what_is_behind_is_not_seen(shape: Shape) -> None:
    assert np.isinf(first_hit(shape, np.array([0.01, 0.02, 1.0]), np.array([[0.0, 0.0, 1.0]]))).all()


def test_a_plane_is_met_at_its_height() -> None:
    assert first_hit(Plane(), np.array([0.0, 0.0, 2.0]), np.array([[1.0, 0.0, -0.5]])) == pytest.approx(4.0)

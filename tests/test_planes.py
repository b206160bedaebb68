import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.stroke.planes import normal_of, off_plane, planes_through, refined
from tests.exact import CAMERA

GRID = np.stack(np.meshgrid(np.arange(0.0, 320, 8), np.arange(0.0, 240, 8)), axis=-1).reshape(-1, 2)
TOLERANCE = np.full(len(GRID), 0.004)


def plane_px(normal: np.ndarray, distance_m: float) -> np.ndarray:
    """1 / z of the plane normal . P = distance at the grid's pixels."""
    return CAMERA.unproject(GRID, np.ones(len(GRID))) @ normal / distance_m


normals = st.builds(
    lambda x, y: np.array([x, y, 1.0]) / np.linalg.norm([x, y, 1.0]), st.floats(-0.8, 0.8), st.floats(-0.8, 0.8)
)


@settings(deadline=None)
@given(normals, st.floats(0.4, 2.0))
def test_normal_of_an_exact_plane_is_its_own(normal, distance_m):
    (plane,) = planes_through(GRID, plane_px(normal, distance_m), TOLERANCE, least=100, most=3)
    assert normal_of(plane, CAMERA) == pytest.approx(normal, abs=1e-6)


@settings(deadline=None, max_examples=20)
@given(normals, st.integers(0, 2**31))
def test_plane_is_found_under_noise_and_outliers(normal, seed):
    rng = np.random.default_rng(seed)
    inverse_depth = plane_px(normal, 1.0) + rng.normal(0, 0.001, len(GRID))
    lost = rng.random(len(GRID)) < 0.4
    inverse_depth[lost] += rng.uniform(0.05, 0.5, lost.sum())
    plane = planes_through(GRID, inverse_depth, TOLERANCE, least=300, most=1)[0]
    plane, on = refined(plane, GRID, inverse_depth, TOLERANCE)
    assert np.degrees(np.arccos(min(1.0, normal_of(plane, CAMERA) @ normal))) < 0.2
    assert not (on & lost).any()
    assert (off_plane(plane, GRID, inverse_depth)[lost] > 0.04).all(), "what is nearer is in front of it"


def test_planes_come_in_the_order_of_their_size_and_share_no_pixel():
    table, wall = plane_px(np.array([0, 0.8, 0.6]), 0.6), plane_px(np.array([0, 0, 1.0]), 0.8)
    upper = GRID[:, 1] < 80
    first, second = planes_through(GRID, np.where(upper, wall, table), TOLERANCE, least=100, most=3)
    assert normal_of(first, CAMERA) == pytest.approx(np.array([0, 0.8, 0.6]), abs=1e-2)
    assert normal_of(second, CAMERA) == pytest.approx(np.array([0, 0, 1.0]), abs=1e-2)


def test_no_plane_is_found_among_too_few_pixels():
    assert planes_through(GRID, plane_px(np.array([0, 0, 1.0]), 1.0), TOLERANCE, least=len(GRID) + 1, most=3) == []
    scattered = np.random.default_rng(0).uniform(0.5, 2.0, len(GRID))
    assert planes_through(GRID, scattered, TOLERANCE, least=100, most=3) == []

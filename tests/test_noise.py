"""How depth errs along the ray: sizes and lengths are recovered from patches whose noise is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotrecon.frame import DepthCameraNoise, StereoNoise
from rotrecon.noise import CORRELATIONS_PX, SMALLEST_STEP, RayNoise, noise_of, structure
from rotrecon.simulation.stereo_noise import correlated_noise

SHAPE = (60, 80)
SIGMA = 1e-3
"""1/m: 0.07 px of disparity with a focal length of 700 px and a baseline of 0.1 m."""
FOCAL_PX = 700.0


def bent(shape: tuple[int, int] = SHAPE) -> np.ndarray:
    """Inverse depth (h, w) of a smooth surface."""
    v, u = np.indices(shape)
    return 1.2 + 1e-4 * u - 2e-4 * v + 3e-6 * (u - 30.0) ** 2


def seen(correlation_px: float, seed: int, shape: tuple[int, int] = SHAPE) -> np.ndarray:
    return bent(shape) + SIGMA * correlated_noise(shape, correlation_px, np.random.default_rng(seed))


@pytest.mark.parametrize("correlation_px", [0.0, 1.0, 1.5, 2.0, 3.0, 4.0])
@pytest.mark.parametrize("seed", range(3))
def test_size_and_length_of_noise_on_a_bent_surface_are_recovered(correlation_px, seed):
    sigma, length_px = structure(seen(correlation_px, seed))
    assert sigma == pytest.approx(SIGMA, rel=0.1)
    assert length_px == correlation_px


def test_long_correlation_is_recovered_to_the_next_of_the_lengths_that_are_told_apart():
    sigma, length_px = structure(seen(6.0, 0, (120, 160)))
    assert sigma == pytest.approx(SIGMA, rel=0.15)
    place = int(np.flatnonzero(CORRELATIONS_PX == 6.0)[0])
    assert length_px in CORRELATIONS_PX[place - 1 : place + 2]


def test_an_edge_and_outliers_and_holes_are_not_noise():
    rng = np.random.default_rng(5)
    values = seen(2.0, 5)
    values[:, 50:] -= 0.3
    values[rng.random(SHAPE) < 0.03] += 0.1
    values[rng.random(SHAPE) < 0.1] = np.nan
    sigma, length_px = structure(values)
    assert sigma == pytest.approx(SIGMA, rel=0.3)
    assert 1.0 <= length_px <= 3.0


@pytest.mark.parametrize(
    "values", [np.full(SHAPE, 1.25), np.full(SHAPE, np.nan), np.full((3, 3), 1.0), np.ones((0, 0))]
)
def test_what_shows_no_noise_has_the_smallest_that_can_be_divided_by(values):
    assert structure(values) == (SMALLEST_STEP, 0.0)


def test_noise_that_is_stated_is_taken_and_its_length_is_estimated():
    depth_m = (1.0 / seen(3.0, 1)).astype(np.float32)
    stereo = noise_of(StereoNoise(0.1, 0.2), depth_m, FOCAL_PX)
    assert (stereo.floor_m, stereo.growth_per_m) == (0.0, pytest.approx(0.2 / (FOCAL_PX * 0.1)))
    assert stereo.sigma_m(2.0) == pytest.approx(4 * stereo.sigma_m(1.0))
    camera = noise_of(DepthCameraNoise(0.001, 0.002), depth_m, FOCAL_PX)
    assert camera.sigma_m(2.0) == pytest.approx(0.001 + 0.008)
    assert stereo.stated
    assert camera.stated
    assert stereo.correlation_px == camera.correlation_px == 3.0


def test_noise_that_is_not_stated_is_that_of_a_stereo_camera():
    depth_m = (1.0 / seen(3.0, 1)).astype(np.float32)
    noise = noise_of(None, depth_m, FOCAL_PX)
    assert not noise.stated
    assert noise.floor_m == 0.0
    assert noise.growth_per_m == pytest.approx(SIGMA, rel=0.1)


@given(
    st.sampled_from([(0.0, 1e-3), (2e-3, 0.0), (1e-3, 2e-3), (1e-5, 5e-3)]),
    st.floats(0.2, 5.0),
)
def test_steps_are_the_integral_of_one_over_sigma(terms, depth_m):
    noise = RayNoise(*terms, correlation_px=0.0, stated=True)
    change_m = 1e-5 * depth_m
    near, far = noise.steps(np.array([depth_m - change_m, depth_m + change_m]))
    assert (far - near) / (2 * change_m) == pytest.approx(1 / noise.sigma_m(depth_m), rel=1e-4)


def test_steps_of_a_stereo_camera_are_its_disparity():
    baseline_m, sigma_px = 0.1, 0.25
    noise = RayNoise(0.0, sigma_px / (FOCAL_PX * baseline_m), 0.0, True)
    depth_m = np.array([0.4, 0.8, 1.6])
    assert noise.steps(depth_m) == pytest.approx(-FOCAL_PX * baseline_m / depth_m / sigma_px)

"""Intervals follow from the covariance of a fit, and hold the truth as often as they say."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.intervals import PLANE_95, SPACE_95, ball_intervals, lateral_intervals, quantile_95, radius_sigma
from rotrecon.rays.ball import Ball
from rotrecon.rays.correlation import Likeness
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.limbs import limbs_of, outline_at
from rotrecon.rays.ray_fit import RayFit, Sight, fine
from rotrecon.rays.surfaces import Surface, turn_of
from tests.bodies import CONE, CYLINDER, Knee, body_at, depth_of, drawing_round, noisy_frame, patch_seen

CENTER_M = np.array([0.02, -0.01, 0.8])
TURN = turn_of(np.array([0.0, 1.0, 0.0]), -CENTER_M)
PIPE = Lateral(CENTER_M, TURN, 0.05, 0.0, 700.0, tapers=False)
TAPERING = Lateral(CENTER_M, TURN, 0.05, 0.2, 700.0, tapers=True)
BALL = Ball(CENTER_M, 0.1, 700.0)
SAMPLES = 20_000
few = settings(max_examples=12, deadline=None)


def fit_of(surface: Surface, covariance: np.ndarray, pixels: int = 5000) -> RayFit:
    free = np.ones(len(covariance), dtype=np.bool_)
    nothing = np.zeros(pixels)
    unalike = Likeness(0.0, 0.0)
    return RayFit(surface, Sight(), (), free, nothing.astype(np.int32), nothing, 1.0, unalike, lambda: covariance)


def covariance_of(size: int, seed: int) -> np.ndarray:
    """Of parameters that err by about a millimetre, alike in part."""
    mix = np.random.default_rng(seed).normal(size=(size, size))
    return 1e-6 * (mix @ mix.T + 0.1 * np.eye(size))


def drawn(covariance: np.ndarray) -> np.ndarray:
    """Errors (SAMPLES, k) of that covariance."""
    return np.random.default_rng(0).multivariate_normal(np.zeros(len(covariance)), covariance, SAMPLES)


@few
@given(st.integers(0, 99), st.floats(-0.2, 0.2))
def test_diameter_of_a_cone_at_a_height_errs_as_radius_and_slope_together(seed, height_m):
    covariance = covariance_of(6, seed)
    low, high = lateral_intervals(fit_of(TAPERING, covariance), TAPERING, height_m, None).diameter_m
    error = drawn(covariance)
    half = 2 * 1.96 * np.std(error[:, 4] + height_m * error[:, 5])
    middle = 2 * (0.05 + 0.2 * height_m)
    assert high == pytest.approx(middle + half, rel=0.03)
    assert low == pytest.approx(max(middle - half, 0.0), abs=0.03 * half)


@few
@given(st.integers(0, 99))
def test_half_angle_errs_as_the_slope_does(seed):
    covariance = covariance_of(6, seed)
    interval = lateral_intervals(fit_of(TAPERING, covariance), TAPERING, 0.0, None).half_angle_rad
    assert interval is not None
    angle = np.arctan(0.2 + drawn(covariance)[:, 5])
    assert interval[1] - interval[0] == pytest.approx(2 * 1.96 * np.std(angle), rel=0.04)
    assert sum(interval) / 2 == pytest.approx(np.arctan(0.2))


@few
@given(st.integers(0, 99), st.floats(-0.2, 0.2))
def test_the_middle_lies_within_its_ball_at_least_as_often_as_is_said(seed, height_m):
    covariance = covariance_of(5, seed)
    intervals = lateral_intervals(fit_of(PIPE, covariance), PIPE, height_m, None)
    error = drawn(covariance)
    off_m = np.linalg.norm(error[:, :2] + height_m * error[:, 2:4], axis=1)
    assert np.mean(off_m <= intervals.center_m) > 0.94
    assert intervals.direction_rad is not None
    assert np.mean(np.linalg.norm(error[:, 2:4], axis=1) <= intervals.direction_rad) > 0.94
    assert intervals.half_angle_rad is None


def test_circle_and_ball_of_95_percent_are_those_of_errors_that_are_alike_in_all_directions():
    rng = np.random.default_rng(1)
    for dimensions, radius in ((2, PLANE_95), (3, SPACE_95)):
        inside = np.linalg.norm(rng.normal(size=(SAMPLES, dimensions)), axis=1) <= radius
        assert np.mean(inside) == pytest.approx(0.95, abs=0.006)


@few
@given(st.integers(0, 99))
def test_ball_errs_in_radius_and_place(seed):
    covariance = covariance_of(4, seed)
    intervals = ball_intervals(fit_of(BALL, covariance), BALL)
    low, high = intervals.diameter_m
    assert high - low == pytest.approx(4 * 1.96 * np.sqrt(covariance[3, 3]), rel=1e-2)
    assert (low + high) / 2 == pytest.approx(0.2)
    assert np.mean(np.linalg.norm(drawn(covariance)[:, :3], axis=1) <= intervals.center_m) > 0.94
    assert intervals.direction_rad is intervals.length_m is intervals.half_angle_rad is None


def test_few_independent_measurements_widen_an_interval_as_student_says():
    covariance = covariance_of(5, 0)
    assert quantile_95(fit_of(PIPE, covariance)) == pytest.approx(1.96, abs=0.001)
    assert quantile_95(fit_of(PIPE, covariance, 15)) == pytest.approx(2.228, abs=0.001)
    alike = replace(fit_of(PIPE, covariance, 500), likeness=Likeness(1.0, 4.0))
    assert quantile_95(alike) == pytest.approx(2.58, abs=0.01)
    assert quantile_95(fit_of(PIPE, covariance, 1)) == pytest.approx(3.182, abs=0.001)


def test_diameter_is_never_said_to_be_negative_and_a_length_is_passed_on():
    unsure = lateral_intervals(fit_of(PIPE, np.eye(5)), PIPE, 0.0, (0.1, 0.2))
    assert unsure.diameter_m[0] == 0.0
    assert unsure.length_m == (0.1, 0.2)


def test_standard_error_of_the_radius():
    assert radius_sigma(fit_of(TAPERING, np.diag([1.0, 1, 1, 1, 4, 9]))) == 2.0
    assert radius_sigma(fit_of(BALL, np.diag([1.0, 1, 1, 9]))) == 3.0


def errors_of_fits(knees: tuple[Knee, ...], slope: float, sigma_px: float, correlation_px: float) -> np.ndarray:
    """Errors of the diameter of a body over its half intervals, in 30 draws of the noise."""
    body = body_at(knees, 3)
    depth_m, drawing = depth_of(body.solids()), drawing_round(body, body.low_m + 0.01, body.high_m - 0.01)
    start = body.lateral(0.0, slope, slope != 0)
    free, units, errors = np.ones(len(start.units(1.0)), dtype=np.bool_), start.units(0.2), []
    for seed in range(30):
        patch = patch_seen(noisy_frame(depth_m, seed, sigma_px, correlation_px), drawing)
        fit = fine(start, patch, units, free, Sight())
        assert fit is not None
        assert isinstance(fit.surface, Lateral)
        middle_m = float(fit.surface.heights(body.center_m[None])[0])
        low, high = lateral_intervals(fit, fit.surface, middle_m, None).diameter_m
        errors.append(((low + high) / 2 - 2 * float(body.radius_at(np.array(0.0)))) / ((high - low) / 2))
    return np.array(errors)


@pytest.mark.parametrize(
    ("sigma_px", "correlation_px", "least"), [(0.25, 0.0, 0.85), (0.15, 4.0, 0.5)], ids=["white", "correlated"]
)
def test_errors_of_fits_are_as_large_as_their_intervals_say(sigma_px, correlation_px, least):
    """95 % are within 1: their mean is 0, and their standard deviation 1 / 1.96, or less where limbs are distrusted."""
    bodies = ((CYLINDER, 0.0), (CONE, 0.1875))
    errors = np.concatenate([errors_of_fits(knees, slope, sigma_px, correlation_px) for knees, slope in bodies])
    assert abs(np.mean(errors)) < 0.2
    assert least / 1.96 < np.std(errors) < 1.15 / 1.96
    assert np.mean(np.abs(errors) <= 1) >= 0.88


def test_what_a_stretch_of_outline_errs_by_alike_shifts_it_and_hardly_turns_it():
    body = body_at(CYLINDER, 3)
    patch = patch_seen(
        noisy_frame(depth_of(body.solids()), 0, 0.5), drawing_round(body, body.low_m + 0.01, body.high_m - 0.01)
    )
    surface = body.lateral()
    limbs = limbs_of(surface, patch.camera, np.linspace(-0.08, 0.08, 60))
    independent = outline_at(limbs.point_px, np.full(len(limbs.point_px), 0.2), patch)
    sides = [np.flatnonzero(limbs.side == side).astype(np.int32) for side in (0, 1)]
    together = replace(independent, alike=tuple((side, 0.19 / np.sqrt(len(side))) for side in sides))
    free, units = np.ones(5, dtype=np.bool_), surface.units(0.2)
    alone, shared = (fine(surface, patch, units, free, Sight(), ((one, 1.0),)) for one in (independent, together))
    assert alone is not None
    assert shared is not None
    assert shared.covariance[4, 4] == pytest.approx(alone.covariance[4, 4], rel=0.05)
    assert shared.covariance[2, 2] < 0.7 * alone.covariance[2, 2]

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.losses import tukey
from rotrecon.rays.surfaces import turn_of
from rotrecon.turned.smoothness import UNBENT, Radii, Smoothness, next_scale, second_differences
from rotrecon.turned.turned import Turned, turned_from
from tests.bodies import BOTTLE, CONE, CYLINDER, VASE, body_at

KNOTS = 12
SEEDS = range(4)


def turned(knees, seed: int, side: int = -1) -> Turned:
    body = body_at(knees, seed)
    height = np.linspace(body.low_m, body.high_m, 80)
    return turned_from(replace(body.lateral(), side=side), height, body.radius_at(height), KNOTS)


def rays_at(surface: Turned, seed: int, count: int = 400, most_rad: float = 1.2) -> tuple[np.ndarray, np.ndarray]:
    """Rays through points on the side that is seen, and the points' depths."""
    rng = np.random.default_rng(seed)
    height = rng.uniform(surface.low_m, surface.high_m, count)
    angle = rng.uniform(-most_rad, most_rad, count)
    across, toward, axis = surface.turn
    out = np.sin(angle)[:, None] * across - surface.side * np.cos(angle)[:, None] * toward
    radius, slope = surface.curve(height)
    points = surface.center_m + height[:, None] * axis + radius[:, None] * out
    facing = surface.side * ((out - slope[:, None] * axis) * points).sum(axis=1) / np.linalg.norm(points, axis=1)
    seen = facing > 0.2
    return (points / points[:, 2:]).T[:, seen], points[seen, 2]


def outline_rays(surface: Turned, seed: int) -> np.ndarray:
    """Rays (3, n) that pass nearly as far beside the axis as the surface reaches."""
    rays, _ = rays_at(surface, seed)
    centers = surface.center_m + np.linspace(surface.low_m, surface.high_m, 40)[:, None] * surface.direction
    beside = centers + np.linspace(-0.06, 0.06, 300)[:, None, None] * surface.turn[0]
    rays = (beside / beside[..., 2:]).reshape(-1, 3).T
    return rays[:, np.abs(surface.tangency(rays).gap_m) < 1e-4]


def numeric(value, surface: Turned, step: float = 1e-6) -> np.ndarray:
    """(k, N) derivatives by central differences."""
    count = len(surface.units(1.0))
    steps = step * np.eye(count)
    return np.stack([(value(surface.stepped(one)) - value(surface.stepped(-one))) / (2 * step) for one in steps])


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("knees", [VASE, BOTTLE, CONE])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_ray_meets_the_surface_where_it_is(knees, seed, side):
    surface = turned(knees, seed, side)
    rays, depth_m = rays_at(surface, seed)
    trace = surface.trace(rays)
    assert trace.hit.all()
    np.testing.assert_allclose(trace.depth_m, depth_m, atol=1e-7)


@pytest.mark.parametrize("knees", [VASE, BOTTLE, CYLINDER])
@pytest.mark.parametrize("seed", SEEDS)
def test_derivatives_of_depth_and_gap_are_those_of_differences(knees, seed):
    surface = turned(knees, seed)
    rays, _ = rays_at(surface, seed)
    np.testing.assert_allclose(
        surface.trace(rays).columns, numeric(lambda one: one.trace(rays).depth_m, surface), atol=2e-5, rtol=2e-4
    )
    grazing = outline_rays(surface, seed)
    assert grazing.shape[1] > 20
    off = np.abs(surface.tangency(grazing).columns - numeric(lambda one: one.tangency(grazing).gap_m, surface))
    # where a ray runs along a wave of the profile, the nearest place is hardly one
    assert np.quantile(off, 0.97) < 0.01


@pytest.mark.parametrize("knees", [CYLINDER, CONE])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_straight_curve_is_the_lateral_surface(knees, seed):
    body = body_at(knees, seed)
    surface = turned(knees, seed)
    slope = float(np.diff([radius for _, radius in knees])[0] / np.diff([height for height, _ in knees])[0])
    lateral = body.lateral(slope=slope)
    # rays that miss are among these
    rays, _ = rays_at(surface, seed, most_rad=1.5)
    rays[:2] += np.random.default_rng(seed).normal(0, 0.003, (2, rays.shape[1]))
    mine, other = surface.trace(rays), lateral.trace(rays)
    np.testing.assert_array_equal(mine.hit, other.hit)
    clear = np.abs(other.columns[4]) < 20
    np.testing.assert_allclose(mine.depth_m[clear], other.depth_m[clear], atol=2e-4)
    inner = np.abs(other.columns[4]) < 3
    np.testing.assert_allclose(mine.columns[:4, inner], other.columns[:4, inner], atol=1e-5)
    np.testing.assert_allclose(mine.columns[4:, inner].sum(axis=0), other.columns[4, inner], atol=1e-5)
    np.testing.assert_allclose(surface.off_middle(rays), lateral.off_middle(rays), atol=1e-6)
    np.testing.assert_allclose(surface.tangency(rays).gap_m, lateral.tangency(rays).gap_m, atol=1e-9)
    assert surface.radius_m == pytest.approx(lateral.radius_m, abs=1e-7)
    assert surface.slope == pytest.approx(lateral.slope, abs=1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_rays_that_miss_go_on_beyond_the_outline(seed):
    surface = turned(VASE, seed)
    middle = surface.center_m / surface.center_m[2]
    widest = surface.curve(np.linspace(surface.low_m, surface.high_m, 50))[0].max()
    reach = np.linspace(0.3, 1.2, 4000) * widest / surface.center_m[2]
    rays = (middle + reach[:, None] * surface.turn[0]).T
    rays /= rays[2]
    trace = surface.trace(rays)
    assert trace.hit[0]
    assert not trace.hit[-1]
    assert np.isfinite(trace.columns).all()
    assert (np.diff(trace.depth_m[trace.hit]) > 0).all()
    # where one bulge gives way to another there is a step, and nowhere a leap
    assert np.abs(np.diff(trace.depth_m)).max() < 0.02
    assert np.abs(trace.depth_m - surface.center_m[2]).max() < 1.0


@given(st.integers(0, 2**32 - 1), st.integers(4, 16))
@settings(max_examples=30, deadline=None)
def test_the_curve_is_linear_in_its_coefficients_and_straight_beyond_its_ends(seed, knots):
    rng = np.random.default_rng(seed)
    line = Lateral(np.array([0.0, 0.0, 0.7]), turn_of(np.array([1.0, 0, 0]), np.array([0.0, 0, -1])), 1, 0, 700, False)
    surface = turned_from(line, np.array([-0.1, 0.2]), np.array([0.04, 0.04]), knots)
    surface = surface.stepped(np.concatenate([np.zeros(4), rng.normal(0, 0.003, knots)]))
    height = rng.uniform(-0.2, 0.3, 50)
    basis = surface.basis(height)
    np.testing.assert_allclose(basis.sum(axis=0), 1.0, atol=1e-12)
    radius, slope = surface.curve(height)
    open_ = radius > 1e-4
    np.testing.assert_allclose((surface.coefficients_m @ basis)[open_], radius[open_], atol=1e-12)
    nudged, _ = surface.curve(height + 1e-7)
    within = open_ & (np.abs(height - surface.low_m) > 1e-6) & (np.abs(height - surface.high_m) > 1e-6)
    np.testing.assert_allclose(((nudged - radius) / 1e-7)[within], slope[within], atol=1e-4)
    beyond = surface.curve(np.array([0.2, 0.25, 0.3]))[0]
    if (beyond > 1e-4).all():
        assert beyond[2] - beyond[1] == pytest.approx(beyond[1] - beyond[0], abs=1e-12)


def test_a_curve_that_closes_has_no_negative_radius():
    surface = turned(CONE, 0)
    radius, slope = surface.curve(np.array([-1.0]))
    assert radius[0] > 0
    assert slope[0] == 0.0


def test_the_prior_wants_no_bends_and_nothing_of_the_axis():
    surface = turned(VASE, 1)
    prior = Smoothness(1e-3)
    prediction = prior.predict(surface)
    assert not prediction.columns[:4].any()
    np.testing.assert_allclose(prediction.columns[4:].T, second_differences(KNOTS) / 1e-3)
    straight = surface.stepped(np.concatenate([np.zeros(4), np.linspace(0.03, 0.05, KNOTS) - surface.coefficients_m]))
    np.testing.assert_allclose(prior.predict(straight).residual, 0.0, atol=1e-9)
    # no loss bends it
    sigma, share = UNBENT
    assert share * tukey(np.array([5.0 / sigma]))[0][0] == pytest.approx(12.5, rel=1e-2)
    ball = Ball(np.array([0.0, 0, 1]), 0.1, 700.0)
    with pytest.raises(TypeError):
        prior.predict(ball)
    with pytest.raises(TypeError):
        Radii(np.zeros(1), np.zeros(1), np.ones(1), np.zeros((4, 1))).predict(ball)


@pytest.mark.parametrize("bend_m", [1e-4, 1e-3, 4e-3])
def test_the_priors_scale_is_that_of_the_bends(bend_m):
    found = []
    for seed in range(20):
        surface = turned(CYLINDER, seed)
        bends = np.random.default_rng(seed).normal(0, bend_m, KNOTS - 2)
        curve = np.concatenate([[0.0, 0.0], np.cumsum(np.cumsum(bends))])
        bent = surface.stepped(np.concatenate([np.zeros(4), curve]))
        scale_m = 0.01
        for _ in range(8):
            prior = second_differences(KNOTS) / scale_m
            information = np.zeros((4 + KNOTS, 4 + KNOTS))
            information[4:, 4:] = prior.T @ prior + np.eye(KNOTS) / 1e-6**2
            scale_m = next_scale(bent, information, scale_m, np.arange(4 + KNOTS) >= 4)
        found.append(scale_m)
    assert np.sqrt(np.mean(np.square(found))) == pytest.approx(bend_m, rel=0.2)


def test_the_priors_scale_is_not_less_for_noise_that_it_smooths():
    bend_m, sigma_m, found = 1e-3, 1.5e-3, []
    surface = turned(CYLINDER, 0)
    difference = second_differences(KNOTS)
    for seed in range(60):
        rng = np.random.default_rng(seed)
        curve = np.concatenate([[0.0, 0.0], np.cumsum(np.cumsum(rng.normal(0, bend_m, KNOTS - 2)))])
        seen = curve + rng.normal(0, sigma_m, KNOTS)
        scale_m = 0.01
        for _ in range(40):
            information = np.zeros((4 + KNOTS, 4 + KNOTS))
            information[4:, 4:] = np.eye(KNOTS) / sigma_m**2 + difference.T @ difference / scale_m**2
            smooth = np.linalg.solve(information[4:, 4:], seen / sigma_m**2)
            bent = surface.stepped(np.concatenate([np.zeros(4), smooth]))
            scale_m = next_scale(bent, information, scale_m, np.arange(4 + KNOTS) >= 4)
        found.append(scale_m)
    assert np.sqrt(np.mean(np.square(found))) == pytest.approx(bend_m, rel=0.25)

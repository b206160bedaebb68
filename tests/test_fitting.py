"""Laws of the robust loop: what it recovers, what does not move it, and what its losses and measurements say."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.noise import RayNoise
from rotrecon.rays.ball import Ball
from rotrecon.rays.fitting import Depths, MatchedDepths, Outline, Refined, refine
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.losses import CAUCHY, TUKEY, cauchy, robust_scale, tukey
from rotrecon.rays.patch import clear_depth, without_speckle
from rotrecon.rays.surfaces import Surface, turn_of

FOCAL_PX = 700.0
NOISE = RayNoise(floor_m=0.0, growth_per_m=0.25 / (FOCAL_PX * 0.1), correlation_px=0.0, stated=True)
LENGTH_M = 0.2
CENTER_M = np.array([0.02, -0.01, 0.8])
TURN = turn_of(np.array([0.3, 0.9, np.sqrt(0.1)]), -CENTER_M)
SURFACES: dict[str, Surface] = {
    "cylinder": Lateral(CENTER_M, TURN, 0.05, 0.0, FOCAL_PX, tapers=False),
    "pipe from inside": Lateral(CENTER_M * 0.4, TURN, 0.25, 0.0, FOCAL_PX, tapers=False, side=1),
    "cone": Lateral(CENTER_M, TURN, 0.05, 0.2, FOCAL_PX, tapers=True),
    "ball": Ball(CENTER_M, 0.1, FOCAL_PX),
}
each = pytest.mark.parametrize("truth", SURFACES.values(), ids=SURFACES.keys())
few = settings(max_examples=15, deadline=None)


def rays_at(surface: Surface, reach: float = 0.9) -> np.ndarray:
    """Rays (3, N) of a grid of pixels that meet a surface beside its middle, no farther from its outline."""
    u, v = np.meshgrid(np.arange(-160, 161, 5.0), np.arange(-160, 161, 5.0))
    rays = np.stack([u.ravel() / FOCAL_PX, v.ravel() / FOCAL_PX, np.ones(u.size)])
    rays[:2] += (surface.center_m[:2] / surface.center_m[2])[:, None]
    seen = surface.trace(rays).hit & (surface.off_middle(rays) < reach)
    if isinstance(surface, Lateral):
        seen &= np.abs(surface.heights((rays * surface.trace(rays).depth_m).T)) < LENGTH_M / 2
    return rays[:, seen]


def seen(surface: Surface, rays: np.ndarray, error: np.ndarray | float = 0.0) -> Depths:
    """Depths of a surface, with errors (N,) in standard deviations."""
    return Depths(rays, NOISE.steps(surface.trace(rays).depth_m) + error, NOISE)


def perturbed(truth: Surface, seed: int) -> Surface:
    """A surface beside the true one: by a centimetre or two, a fifth of its radius and some degrees."""
    shift = np.random.default_rng(seed).uniform(-1, 1, len(truth.units(1.0)))
    by = {"Lateral": [0.01, 0.02, 0.1, 0.1, 0.01, 0.05], "Ball": [0.02, 0.02, 0.02, 0.02]}[type(truth).__name__]
    return truth.stepped(shift * np.array(by[: len(shift)]))


def fitted(start: Surface, depths: Depths, free: np.ndarray | None = None) -> Refined:
    """Rounds of a heavy-tailed loss down to the noise, and one that redescends, as the program goes."""
    units = start.units(LENGTH_M)
    free = np.ones(len(units), dtype=np.bool_) if free is None else free
    refined = None
    for scale, loss in ((64.0, cauchy), (8.0, cauchy), (1.0, cauchy), (1.0, tukey)):
        start = start if refined is None else refined.surface
        refined = refine(start, [depths], [(scale, 1.0)], loss, free, units, 20)
    assert refined is not None
    return refined


def radius_at(surface: Surface, point_m: np.ndarray) -> float:
    """The radius beside a point of the axis: the centre of a surface is free to slide along it."""
    if isinstance(surface, Ball):
        return surface.radius_m
    return surface.radius_m + surface.slope * float(surface.heights(point_m[None])[0])


def apart(one: Surface, other: Surface, rays: np.ndarray) -> float:
    """Greatest difference of the depths along rays, m."""
    return float(np.abs(one.trace(rays).depth_m - other.trace(rays).depth_m).max())


@each
@few
@given(seed=st.integers(0, 999))
def test_exact_rays_give_back_their_surface_from_a_start_beside_it(truth, seed):
    rays = rays_at(truth)
    refined = fitted(perturbed(truth, seed), seen(truth, rays))
    assert radius_at(refined.surface, truth.center_m) == pytest.approx(truth.radius_m, rel=1e-6)
    assert apart(refined.surface, truth, rays) < 1e-7
    assert refined.cost < 1e-6


@each
def test_a_fifth_of_outliers_does_not_move_it(truth):
    rng = np.random.default_rng(1)
    rays = rays_at(truth)
    clean = rng.standard_normal(rays.shape[1])
    wrong = rng.random(rays.shape[1]) < 0.2
    spoilt = np.where(wrong, rng.uniform(10, 200, len(wrong)), clean)
    start = perturbed(truth, 1)
    straight, robust = fitted(start, seen(truth, rays, clean)), fitted(start, seen(truth, rays, spoilt))
    sigma = np.sqrt(np.linalg.inv(straight.information).diagonal()[3 if isinstance(truth, Ball) else 4])
    assert abs(robust.surface.size_m - straight.surface.size_m) < 2 * sigma
    assert abs(robust.surface.size_m - truth.size_m) < 3 * sigma


def test_information_is_the_inverse_of_the_scatter():
    truth = SURFACES["cylinder"]
    rays, rng = rays_at(truth), np.random.default_rng(2)
    found = [fitted(truth, seen(truth, rays, rng.standard_normal(rays.shape[1]))) for _ in range(60)]
    scatter = np.std([one.surface.size_m for one in found])
    expected = np.sqrt(np.linalg.inv(found[0].information)[4, 4])
    assert scatter == pytest.approx(expected, rel=0.3)
    assert abs(np.mean([one.surface.size_m for one in found]) - truth.size_m) < 0.5 * expected


@pytest.mark.parametrize("held", [[2, 3], [4], [0, 1, 4], [5]])
def test_what_is_held_stays_to_the_last_digit(held):
    truth = SURFACES["cone"]
    assert isinstance(truth, Lateral)
    free = np.ones(6, dtype=np.bool_)
    free[held] = False
    start = perturbed(truth, 3)
    assert isinstance(start, Lateral)
    found = fitted(start, seen(truth, rays_at(truth)), free).surface
    assert isinstance(found, Lateral)
    kept = {
        2: np.allclose(found.direction, start.direction, rtol=0, atol=1e-15),
        4: found.radius_m == start.radius_m,
        0: np.allclose((found.center_m - start.center_m) @ start.turn[:2].T, 0, atol=1e-15),
        5: found.slope == start.slope,
    }
    assert all(kept[parameter] for parameter in held if parameter in kept)
    assert not all(kept.values())


@each
@few
@given(seed=st.integers(0, 999))
def test_the_cost_never_grows(truth, seed):
    depths, start = seen(truth, rays_at(truth)), perturbed(truth, seed)
    free, units = np.ones(len(truth.units(1.0)), dtype=np.bool_), truth.units(LENGTH_M)
    costs = [refine(start, [depths], [(2.0, 1.0)], tukey, free, units, rounds).cost for rounds in range(5)]
    assert costs == sorted(costs, reverse=True)


@pytest.mark.parametrize("loss", [cauchy, tukey])
@given(residual=st.floats(-30, 30))
def test_weight_is_the_derivative_of_the_cost_over_the_residual(loss, residual):
    around = residual + 1e-5 * np.array([-1.0, 0.0, 1.0])
    cost, weight = loss(around)
    assert (cost[2] - cost[0]) / 2e-5 == pytest.approx(weight[1] * residual, abs=1e-4)
    assert cost[1] >= 0
    assert 0 <= weight[1] <= 1


def test_losses_are_squares_for_small_residuals_and_know_outliers_for_large_ones():
    small, large = np.array([0.01]), np.array([TUKEY, 50.0, 1e6])
    for loss in (cauchy, tukey):
        assert loss(small)[0] == pytest.approx(small**2 / 2, rel=1e-3)
    assert tukey(large)[1].tolist() == [0, 0, 0]
    assert np.ptp(tukey(large)[0]) == 0
    assert (cauchy(large)[1] > 0).all(), "no start is too far"
    assert cauchy(np.array([CAUCHY]))[1] == pytest.approx(0.5)


def test_sigma_of_residuals_is_that_of_most_of_them():
    rng = np.random.default_rng(4)
    residual = 2.0 * rng.standard_normal(4000)
    assert robust_scale(residual) == pytest.approx(2.0, rel=0.05)
    residual[:400] = rng.uniform(20, 100, 400)
    assert robust_scale(residual) == pytest.approx(2.0, rel=0.1)
    assert robust_scale(np.zeros(5)) == 0.0


@pytest.mark.parametrize("truth", [SURFACES[name] for name in ("cylinder", "cone", "ball")])
def test_an_outline_says_how_many_pixels_a_surface_is_short_of_it(truth):
    rays = grazing(truth)
    outline = Outline(rays, np.full(rays.shape[1], 0.5), FOCAL_PX)
    assert np.abs(outline.predict(truth).residual).max() < 1e-6
    grown = truth.stepped(np.eye(len(truth.units(1.0)))[3 if isinstance(truth, Ball) else 4] * 1e-4)
    expected = 1e-4 * FOCAL_PX / truth.tangency(rays).depth_m / 0.5
    assert np.abs(outline.predict(grown).residual) == pytest.approx(expected, rel=0.1)
    assert len(outline.chosen(np.arange(3))) == 3


def grazing(surface: Surface) -> np.ndarray:
    """Rays (3, n) of the outline, found between ones inside and outside of it."""
    inside = rays_at(surface, reach=0.5)
    away = np.random.default_rng(0).standard_normal((2, inside.shape[1]))
    outside = inside + np.concatenate([away / np.hypot(*away), np.zeros((1, inside.shape[1]))])
    outside = outside[:, ~surface.trace(outside).hit][:, :50]
    inside = np.repeat(inside[:, :1], outside.shape[1], axis=1)
    for _ in range(60):
        middle = (inside + outside) / 2
        hits = surface.trace(middle).hit
        inside, outside = np.where(hits, middle, inside), np.where(hits, outside, middle)
    return inside


@pytest.mark.parametrize("window_px", [1, 5])
def test_matched_depths_are_means_over_the_pixels_of_a_window_that_hit(window_px):
    truth = SURFACES["ball"]
    u, v = np.meshgrid(np.arange(-130, 131) / FOCAL_PX, np.arange(-120, 121) / FOCAL_PX)
    shape, rays = u.shape, np.stack([u.ravel(), v.ravel(), np.ones(u.size)])
    trace = truth.trace(rays)
    hit = trace.hit.reshape(shape).astype(float)
    steps = NOISE.steps(trace.depth_m).reshape(shape)
    side = (window_px, window_px)
    summed = (
        cv2.boxFilter(values, -1, side, normalize=False, borderType=cv2.BORDER_CONSTANT)
        for values in (steps * hit, hit)
    )
    total, count = summed
    index = np.flatnonzero(count > 0).astype(np.int32)
    measured = total.ravel()[index] / count.ravel()[index]
    everywhere = np.arange(u.size, dtype=np.int32)
    matched = MatchedDepths(rays, everywhere, shape, window_px, index, measured, NOISE)
    prediction = matched.predict(truth)
    assert np.abs(prediction.residual).max() < 1e-9
    if window_px == 1:
        alone = Depths(rays[:, index], measured, NOISE).predict(truth)
        assert prediction.columns == pytest.approx(alone.columns)
    change = 1e-7 * np.eye(4)[3]
    inner = truth.off_middle(rays[:, index]) < 0.8
    more, less = (matched.predict(truth.stepped(step)).residual for step in (change, -change))
    assert (less - more)[inner] / 2e-7 == pytest.approx(prediction.columns[3][inner], rel=1e-4)


def test_some_of_the_depths_are_depths():
    truth = SURFACES["ball"]
    depths = seen(truth, rays_at(truth), 1.0)
    some = depths.chosen(np.arange(0, 10, 2))
    assert some.predict(truth).residual == pytest.approx(1.0)
    assert len(some) == 5
    assert len(replace(depths, steps=depths.steps)) == len(depths)


@pytest.mark.parametrize("corner", [(0, 0), (25, 10), (28, 33)])
def test_depth_without_speckle_is_the_same_wherever_it_is_asked_for(corner):
    rng = np.random.default_rng(1)
    depth_m = rng.uniform(0.5, 0.6, (40, 50)).astype(np.float32)
    depth_m[rng.random(depth_m.shape) < 0.3] = np.nan
    row, column = np.add.outer(corner[0], np.arange(12)), np.add.outer(corner[1], np.arange(17))
    pixel = (row[:, None] * 50 + column).astype(np.int32)
    expected = without_speckle(depth_m).ravel()[pixel]
    pixel[rng.random(pixel.shape) < 0.2] = -1
    np.testing.assert_array_equal(clear_depth(depth_m, pixel), np.where(pixel >= 0, expected, np.nan))

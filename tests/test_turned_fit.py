from dataclasses import replace

import numpy as np
import pytest

from rotrecon.drawing import AreaOfInterest, Drawing, ObjectAxis
from rotrecon.extent import Extent
from rotrecon.rays.ball import Ball
from rotrecon.rays.limbs import limbs_of, outline_at
from rotrecon.rays.ray_fit import RayFit
from rotrecon.rays.starts import Ridge
from rotrecon.rays.surfaces import turn_of
from rotrecon.turned.height_radii import height_radii
from rotrecon.turned.looks import looks_at, medians
from rotrecon.turned.turned import Turned, turned_from
from rotrecon.turned.turned_fit import fit_turned
from rotrecon.turned.turned_start import Points, longest_run
from tests.bodies import (
    BODIES,
    BOTTLE,
    CAMERA,
    CONE,
    CYLINDER,
    VASE,
    Body,
    as_fit,
    body_at,
    noisy_frame,
    patch_seen,
    ridge_seen,
    seen,
)

SEEDS = range(5)


def off_axis(fit: RayFit, body: Body) -> tuple[float, float]:
    """Angle, degrees, between the axes, and distance of the fit's middle from the true axis, m."""
    surface = fit.surface
    assert isinstance(surface, Turned)
    offset = surface.center_m - body.center_m
    beside = offset - (offset @ body.direction) * body.direction
    cosine = min(abs(float(surface.direction @ body.direction)), 1.0)
    return float(np.degrees(np.arccos(cosine))), float(np.linalg.norm(beside))


def errors_of(fit: RayFit, body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Errors and standard deviations of the curve at heights within the body."""
    surface = fit.surface
    assert isinstance(surface, Turned)
    height = np.linspace(surface.low_m, surface.high_m, 50)
    on_body = body.on(surface, height)
    within = (on_body > body.low_m) & (on_body < body.high_m)
    basis = surface.basis(height[within])
    sigma = np.sqrt(np.einsum("kn,kl,ln->n", basis, fit.covariance[4:, 4:], basis))
    return surface.curve(height[within])[0] - body.radius_at(on_body[within]), sigma


@pytest.mark.parametrize("name", BODIES)
def test_the_axis_is_found_from_the_stroke_alone(name):
    for seed in SEEDS:
        body, patch, edge = seen(BODIES[name], seed)
        fit = fit_turned(patch, edge)
        assert fit is not None
        degrees, beside_m = off_axis(fit, body)
        assert degrees < 0.5
        assert beside_m < 0.001
        assert fit.sigma == pytest.approx(0.25 / (700 * 0.1) / patch.noise.growth_per_m, rel=0.15)


@pytest.mark.parametrize("name", ["vase", "cylinder", "cone"])
def test_a_smooth_curve_is_within_its_interval(name):
    held = []
    for seed in SEEDS:
        body, patch, edge = seen(BODIES[name], seed)
        fit = fit_turned(patch, edge)
        assert fit is not None
        error, sigma = errors_of(fit, body)
        assert len(error) > 40
        held.append(np.mean(np.abs(error) < 1.96 * sigma))
        assert np.median(np.abs(error)) < 0.0002
        assert np.median(sigma) < 0.0004
    assert np.mean(held) >= 0.9


def test_errors_that_are_alike_widen_the_interval():
    width = []
    for correlation_px in (0.0, 4.0):
        body, patch, edge = seen(CYLINDER, 1, 0.15, correlation_px)
        fit = fit_turned(patch, edge)
        assert fit is not None
        error, sigma = errors_of(fit, body)
        assert np.mean(np.abs(error) < 1.96 * sigma) > 0.8
        width.append(np.median(sigma))
    assert width[1] > 3 * width[0]


@pytest.mark.parametrize("tilt_deg", [-40.0, 0.0, 40.0])
def test_a_start_that_is_askew_does_no_harm(tilt_deg):
    body, patch, edge = seen(BOTTLE, 2)
    lateral = body.lateral()
    tilt = np.deg2rad(tilt_deg)
    turn = turn_of(np.cos(tilt) * lateral.turn[2] + np.sin(tilt) * lateral.turn[1], -lateral.center_m)
    fit = fit_turned(patch, edge, as_fit(replace(lateral, turn=turn)))
    assert fit is not None
    assert off_axis(fit, body)[0] < 0.3


def test_a_direction_that_is_held_stays():
    body, patch, edge = seen(VASE, 3)
    free = np.array([True, True, False, False, True])
    fit = fit_turned(patch, edge, replace(as_fit(body.lateral()), free=free))
    assert fit is not None
    assert off_axis(fit, body)[0] < 1e-6
    assert not fit.covariance[2:4].any()
    assert list(fit.free[:4]) == [True, True, False, False]


def test_an_extent_says_from_where_to_where():
    body, patch, edge = seen(BOTTLE, 4)
    extent = Extent(-0.08, 0.02, False, False, (-0.081, -0.079), (0.019, 0.021))
    fit = fit_turned(patch, edge, as_fit(body.lateral()), extent)
    assert fit is not None
    assert isinstance(fit.surface, Turned)
    assert fit.surface.high_m - fit.surface.low_m == pytest.approx(0.1, abs=0.005)
    np.testing.assert_allclose(fit.surface.curve(np.linspace(-0.07, 0.01, 9))[0], 0.035, atol=0.0005)


def test_a_hollow_surface_is_followed_from_inside():
    way = np.array([0.05, 0.1, 1.0])
    body = Body(((-0.3, 0.1), (0.3, 0.11)), np.array([0.0, 0.02, 0.6]), way / np.linalg.norm(way))
    surface = replace(body.lateral(), side=1)
    height = np.array([-0.3, 0.3])
    u, v = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    rays = CAMERA.unproject(np.stack([u.ravel(), v.ravel()], axis=-1), np.ones(u.size)).T
    depth = turned_from(surface, height, body.radius_at(height), 6).trace(rays).depth_m.reshape(u.shape)
    frame = noisy_frame(np.where(depth < 0.9, depth, 1.5), 0)
    drawing = Drawing(AreaOfInterest.rectangle((140, 100), (500, 380)), ObjectAxis((320, 110), (320, 370)))
    patch = patch_seen(frame, drawing)
    patch = replace(patch, kept=patch.drawn & (patch.depth_m < 0.9))
    fit = fit_turned(patch, ridge_seen(frame, drawing), as_fit(surface))
    assert fit is not None
    assert fit.surface.side == 1
    assert off_axis(fit, body)[0] < 0.3
    error, _ = errors_of(fit, body)
    assert np.median(np.abs(error)) < 0.001


def test_outlines_tie_down_what_depths_leave_open():
    body, patch, edge = seen(CONE, 0, sigma_px=2.0)
    lateral = body.lateral(slope=0.03 / 0.16)
    limbs = limbs_of(lateral, patch.camera, np.linspace(-0.07, 0.07, 60))
    outline = outline_at(limbs.point_px, np.full(len(limbs.point_px), 0.1), patch)
    depths = fit_turned(patch, edge, as_fit(lateral))
    both = fit_turned(patch, edge, as_fit(lateral, outlines=((outline, 1.0),)))
    assert depths is not None
    assert both is not None
    assert np.trace(both.covariance[:4, :4]) < 0.5 * np.trace(depths.covariance[:4, :4])
    assert off_axis(both, body)[0] < 0.3


def test_too_little_is_no_fit_and_what_has_no_axis_no_start():
    body, patch, edge = seen(CYLINDER, 0)
    nothing = replace(patch, kept=np.zeros_like(patch.kept))
    assert fit_turned(nothing, edge) is None
    bare = replace(patch, depth_m=np.full_like(patch.depth_m, np.nan))
    assert fit_turned(bare, edge) is None
    with pytest.raises(TypeError):
        fit_turned(patch, edge, as_fit(Ball(body.center_m, 0.1, 700.0)))
    with pytest.raises(ValueError, match="extent"):
        fit_turned(patch, edge, None, Extent(0, 1, False, False, None, None))


@pytest.mark.parametrize("seed", SEEDS)
def test_radii_are_right_whatever_the_surface_says(seed):
    body, patch, _ = seen(VASE, seed)
    heights = np.linspace(-0.09, 0.09, 40)
    # a plain cylinder about the true axis, as wide as the vase is nowhere
    plain = replace(body.lateral(), radius_m=0.04)
    found = height_radii(looks_at(plain, patch, heights, 1.0))
    error = 0.04 + found.change_m - body.radius_at(heights)
    assert found.sound.all()
    assert np.sqrt(np.mean(np.square(error))) < 0.0003


def test_derivatives_of_looks_are_those_of_differences():
    body, patch, _ = seen(VASE, 1)
    heights = np.linspace(-0.09, 0.09, 30)
    surface = turned_from(body.lateral(), heights, body.radius_at(heights), 10)
    looks = looks_at(surface, patch, heights, 0.9, 500)
    residual, columns = looks.rows(np.zeros(30))
    said = residual < 1e5
    for number in range(4):
        step = 1e-6 * np.eye(14)[number]
        moved = surface.stepped(step)
        # the same rays, at the heights they were seen at
        trace = [one.trace(patch.rays[:, looks.pixels]).depth_m for one in (moved, surface.stepped(-step))]
        change = (patch.noise.steps(trace[0]) - patch.noise.steps(trace[1])) / 2e-6
        off = np.abs(columns[number] - change)[said] / (1 + np.abs(change[said]))
        assert np.median(off) < 0.02
    nudged, _ = looks.rows(np.full(30, 1e-6))
    np.testing.assert_allclose(columns[4][said], (residual - nudged)[said] / 1e-6, rtol=0.02)


def test_points_pull_as_differences_say():
    surface = turned_from(body_at(VASE, 5).lateral(), np.array([-0.1, 0.0, 0.1]), np.array([0.03, 0.04, 0.035]), 8)
    rng = np.random.default_rng(0)
    points = surface.center_m[:, None] + surface.turn.T @ rng.normal(0, 0.03, (3, 200))
    measured = Points(points, np.full(200, 0.001))
    prediction = measured.predict(surface)
    for number in range(12):
        step = 1e-7 * np.eye(12)[number]
        change = measured.predict(surface.stepped(-step)).residual - measured.predict(surface.stepped(step)).residual
        off = np.abs(prediction.columns[number] - change / 2e-7)
        # the slope's own share in the distance is left out, as it is in Newton's method near the surface
        assert np.median(off / (1 + np.abs(prediction.columns[number]))) < 0.05


def test_medians_are_those_of_each_place():
    rng = np.random.default_rng(0)
    values, place = rng.normal(size=200), rng.integers(0, 9, 200).astype(np.int32)
    values[rng.random(200) < 0.2] = np.nan
    place[place == 4] = 5
    found = medians(values, place, 10, 3)
    for number in range(10):
        of = values[place == number]
        of = of[np.isfinite(of)]
        if len(of) < 3:
            assert np.isnan(found[number])
        else:
            assert found[number] == pytest.approx(np.median(of))


def test_a_ridge_that_leaps_to_the_wall_is_cut_there():
    points = np.concatenate(
        [np.linspace([0, 0, 0.7], [0, 0.1, 0.72], 30), np.linspace([0, 0.1, 1.3], [0, 0.12, 1.3], 10)]
    )
    run = longest_run(Ridge(points, np.full(40, 0.05)))
    np.testing.assert_array_equal(run.points_m, points[:30])

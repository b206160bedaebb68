from dataclasses import replace

import numpy as np
import pytest

from rotrecon.extent import Extent, extent_of
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.losses import robust_scale
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import Sight, depths_of, near
from rotrecon.turned.turned import turned_from
from tests.bodies import BOTTLE, CONE, CYLINDER, Body, body_at, depth_of, drawing_round, noisy_frame, patch_seen

POSES = range(12)
CONE_SLOPE = (CONE[1][1] - CONE[0][1]) / (CONE[1][0] - CONE[0][0])


def sigma_of(surface: Lateral, patch: Patch) -> float:
    pixels = near(surface, patch, patch.drawn & np.isfinite(patch.depth_m), Sight(guard=0.7))
    return robust_scale(depths_of(patch, pixels).predict(surface).residual)


def seen(body: Body, seed: int, margin_m: float, correlation_px: float = 0.0) -> Patch:
    frame = noisy_frame(depth_of(body.solids()), seed, 0.15 if correlation_px else 0.25, correlation_px)
    return patch_seen(frame, drawing_round(body, body.low_m - margin_m, body.high_m + margin_m))


def extent(surface: Lateral, patch: Patch, correlation_px: float = 0.0) -> Extent:
    found = extent_of(surface, patch, sigma_of(surface, patch), correlation_px)
    assert found is not None
    return found


@pytest.mark.parametrize("correlation_px", [0.0, 4.0])
@pytest.mark.parametrize(("knees", "slope"), [(CYLINDER, 0.0), (CONE, CONE_SLOPE)])
def test_closed_ends_are_found_within_their_intervals(knees, slope, correlation_px):
    held, errors = [], []
    for seed in POSES:
        body = body_at(knees, seed, most_tilt=0.4)
        found = extent(body.lateral(slope=slope), seen(body, seed, 0.06, correlation_px), correlation_px)
        for end_m, interval, true_m in (
            (found.low_m, found.low_interval_m, body.low_m),
            (found.high_m, found.high_interval_m, body.high_m),
        ):
            assert interval is not None
            held.append(interval[0] <= true_m <= interval[1])
            errors.append(end_m - true_m)
            assert interval[1] - interval[0] < 0.012
        low, high = found.length_interval_m or (np.inf, 0.0)
        assert low <= body.high_m - body.low_m <= high
    assert np.mean(held) >= 0.9
    assert np.sqrt(np.mean(np.square(errors))) < 0.001


@pytest.mark.parametrize("seed", POSES)
def test_an_end_outside_the_area_is_open(seed):
    body = body_at(CYLINDER, seed, most_tilt=0.4)
    patch = seen(body, seed, -0.03)
    found = extent(body.lateral(), patch)
    assert found.low_open
    assert found.high_open
    assert found.length_interval_m is None
    # the rims of a tilted cylinder are seen as arcs, which a straight border cuts
    assert found.low_m == pytest.approx(body.low_m + 0.03, abs=0.02)
    assert found.high_m == pytest.approx(body.high_m - 0.03, abs=0.02)


def test_an_end_outside_the_picture_is_open():
    body = Body(CYLINDER, np.array([0.25, 0.0, 0.7]), np.array([1.0, 0.0, 0.0]))
    frame = noisy_frame(depth_of(body.solids()), 1)
    found = extent(body.lateral(), patch_seen(frame, drawing_round(body, -0.12, 0.06)))
    assert found.high_open
    assert not found.low_open


def test_support_ends_where_another_part_begins():
    body = Body(BOTTLE, np.array([0.0, 0.0, 0.7]), np.array([0.6, 0.8, 0.0]))
    frame = noisy_frame(depth_of(body.solids()), 2)
    # the stroke is beside the body, the area holds all of the bottle
    patch = patch_seen(frame, drawing_round(body, -0.13, 0.13))
    drawn = patch.drawn & (body.lateral().heights((patch.rays * patch.depth_m).T) < 0.0)
    found = extent(body.lateral(), replace(patch, drawn=drawn))
    assert not found.high_open
    assert found.high_m == pytest.approx(0.03, abs=0.006)


@pytest.mark.parametrize("seed", POSES)
def test_the_extent_does_not_depend_on_the_sense_of_the_axis(seed):
    body = body_at(CYLINDER, seed, most_tilt=0.4)
    patch = seen(body, seed, 0.03)
    turned = replace(body, direction=-body.direction)
    one, other = extent(body.lateral(), patch), extent(turned.lateral(), patch)
    assert one.low_m == pytest.approx(-other.high_m, abs=2e-4)
    assert one.high_m == pytest.approx(-other.low_m, abs=2e-4)


def test_unknown_depth_within_is_passed_and_beyond_an_end_makes_it_uncertain():
    body = Body(CYLINDER, np.array([0.0, 0.0, 0.7]), np.array([1.0, 0.0, 0.0]))
    patch = seen(body, 3, 0.03)
    surface = body.lateral()
    plain = extent(surface, patch)
    height = surface.heights((patch.rays * surface.trace(patch.rays).depth_m).T)
    hole = ((height > 0.05) & (height < 0.06)) | ((height > 0.1) & (height < 0.11))
    found = extent(surface, replace(patch, depth_m=np.where(hole, np.nan, patch.depth_m)))
    assert found.high_m == pytest.approx(plain.high_m, abs=1e-3)
    assert found.high_interval_m is not None
    assert plain.high_interval_m is not None
    assert found.high_interval_m[1] > 0.109
    assert plain.high_interval_m[1] < 0.104


def test_a_surface_that_is_not_there_has_no_extent():
    body = Body(CYLINDER, np.array([0.0, 0.0, 0.7]), np.array([1.0, 0.0, 0.0]))
    patch = seen(body, 4, 0.02)
    nearer = replace(body, center_m=np.array([0.0, 0.0, 0.5]))
    assert extent_of(nearer.lateral(), patch, sigma_of(body.lateral(), patch), 0.0) is None


@pytest.mark.parametrize("seed", POSES)
def test_a_turned_surface_is_followed_through_all_of_an_object(seed):
    body = body_at(BOTTLE, seed, most_tilt=0.4)
    height = np.linspace(body.low_m, body.high_m, 80)
    surface = turned_from(body.lateral(), height, body.radius_at(height), 24)
    patch = seen(body, seed, 0.05)
    drawn = patch.drawn & (body.lateral().heights((patch.rays * patch.depth_m).T) < -0.02)
    found = extent(surface, replace(patch, drawn=drawn))
    assert found.low_m == pytest.approx(body.low_m, abs=0.003)
    assert found.high_m == pytest.approx(body.high_m, abs=0.003)
    assert not found.low_open
    assert not found.high_open


def test_a_strap_of_a_pixel_does_not_end_the_support():
    body = Body(CYLINDER, np.array([0.0, 0.0, 0.7]), np.array([0.8, 0.6, 0.0]))
    patch, surface = seen(body, 5, 0.03), body.lateral()
    height = surface.heights((patch.rays * surface.trace(patch.rays).depth_m).T)
    strap = np.abs(height - 0.05) < 0.0006
    found = extent(surface, replace(patch, depth_m=np.where(strap, patch.depth_m - 0.05, patch.depth_m)))
    assert found.high_m == pytest.approx(body.high_m, abs=0.001)
    broad = np.abs(height - 0.05) < 0.004
    cut = extent(surface, replace(patch, depth_m=np.where(broad, patch.depth_m - 0.05, patch.depth_m)))
    assert cut.high_m == pytest.approx(0.046, abs=0.001)

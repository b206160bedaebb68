from dataclasses import replace

import numpy as np
import pytest

from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import RayFit, Sight, fine
from rotrecon.turned.profile import Profile, profile_of
from rotrecon.turned.turned_fit import fit_turned
from tests.bodies import BODIES, BOTTLE, CONE, CYLINDER, FLANGED_PIPE, Body, as_fit, seen

SEEDS = range(5)


def heights_of(low_m: float, high_m: float, pitch_m: float = 0.003) -> np.ndarray:
    return np.arange(low_m, high_m, pitch_m)


def share_held(profile: Profile, fit: RayFit, body: Body) -> float:
    """Share of the known heights on a body whose interval holds the true radius."""
    assert isinstance(fit.surface, Lateral)
    on_body = body.on(fit.surface, profile.height_m)
    known = profile.known & (on_body > body.low_m + 0.002) & (on_body < body.high_m - 0.002)
    for limit_m in (profile.low_m, profile.high_m, profile.own_m):
        np.testing.assert_array_equal(np.isfinite(limit_m), profile.known)
    assert known.sum() > 0.8 * (on_body > body.low_m).sum() * (on_body < body.high_m).mean()
    truth = body.radius_at(on_body)
    return float(np.mean(((profile.low_m <= truth) & (truth <= profile.high_m))[known]))


def lateral_fit(body: Body, patch: Patch, slope: float) -> RayFit:
    start = body.lateral(slope=slope, tapers=slope != 0.0)
    free = np.ones(6 if slope else 5, dtype=np.bool_)
    fit = fine(start, patch, start.units(0.2), free, Sight())
    assert fit is not None
    return fit


@pytest.mark.parametrize("correlation_px", [0.0, 4.0])
@pytest.mark.parametrize("name", BODIES)
def test_the_interval_of_each_height_holds_the_true_radius(name, correlation_px):
    held = []
    for seed in SEEDS:
        body, patch, edge = seen(BODIES[name], seed, 0.15 if correlation_px else 0.25, correlation_px)
        fit = fit_turned(patch, edge)
        assert fit is not None
        assert isinstance(fit.surface, Lateral)
        profile = profile_of(fit, patch, heights_of(fit.surface.low_m, fit.surface.high_m))
        held.append(share_held(profile, fit, body))
        half_m = np.nanmedian(profile.high_m - profile.low_m) / 2
        assert half_m < (0.002 if correlation_px else 0.0008)
    assert np.mean(held) >= 0.88


@pytest.mark.parametrize(("knees", "slope"), [(CYLINDER, 0.0), (CONE, 0.03 / 0.16)])
def test_a_cylinder_or_a_cone_has_a_profile_too(knees, slope):
    held = []
    for seed in SEEDS:
        body, patch, _ = seen(knees, seed)
        fit = lateral_fit(body, patch, slope)
        assert isinstance(fit.surface, Lateral)
        profile = profile_of(fit, patch, heights_of(-0.07, 0.07))
        held.append(share_held(profile, fit, body))
        assert np.nanmedian(profile.high_m - profile.low_m) < 0.001
    assert np.mean(held) >= 0.9


def test_a_profile_is_the_objects_whatever_was_fitted():
    body, patch, _ = seen(BOTTLE, 0)
    # the axis of the bottle, and a cylinder as wide as its body is
    profile = profile_of(as_fit(body.lateral()), patch, heights_of(-0.09, 0.09))
    truth = body.radius_at(profile.height_m)
    straight = (np.abs(profile.height_m - 0.03) > 0.004) & (np.abs(profile.height_m - 0.06) > 0.004) & profile.known
    assert straight.sum() > 45
    assert np.abs(profile.radius_m - truth)[straight].max() < 0.001


def test_an_axis_that_may_turn_leans_the_profile():
    body, patch, _ = seen(CYLINDER, 2)
    fit = as_fit(body.lateral())
    sure = profile_of(fit, patch, heights_of(-0.08, 0.08))
    covariance = np.zeros((5, 5))
    covariance[3, 3] = 0.01**2
    unsure = profile_of(replace(fit, own_covariance=lambda: covariance), patch, heights_of(-0.08, 0.08))
    assert sure.lean == 0.0
    # most of the side that is seen faces the camera, and turning the axis that way changes its radii by as much
    assert 0.006 < unsure.lean < 0.0105
    np.testing.assert_allclose(unsure.own_m, sure.own_m)
    middle = len(sure.height_m) // 2
    assert unsure.high_m[middle] - unsure.low_m[middle] == pytest.approx(
        sure.high_m[middle] - sure.low_m[middle], rel=0.1
    )
    assert unsure.high_m[-1] - unsure.low_m[-1] > 5 * (sure.high_m[-1] - sure.low_m[-1])


def test_a_height_without_depth_has_no_radius():
    body, patch, _ = seen(CYLINDER, 3)
    height = body.lateral().heights((patch.rays * patch.depth_m).T)
    holed = replace(patch, depth_m=np.where((height > 0.0) & (height < 0.02), np.nan, patch.depth_m))
    profile = profile_of(as_fit(body.lateral()), holed, heights_of(-0.08, 0.08))
    gap = (profile.height_m > 0.002) & (profile.height_m < 0.018)
    assert not profile.known[gap].any()
    assert np.isnan(profile.low_m[gap]).all()
    assert profile.known[(profile.height_m < -0.003) | (profile.height_m > 0.023)].all()


def test_a_height_on_an_edge_has_no_one_radius():
    body, patch, _ = seen(FLANGED_PIPE, 1)
    # the third reaches from before the step to beyond it
    profile = profile_of(as_fit(body.lateral()), patch, np.array([-0.1, -0.05, 0.03, 0.05, 0.06]))
    np.testing.assert_array_equal(profile.known, [True, True, False, True, True])


def test_finer_heights_are_less_sure_each():
    body, patch, _ = seen(CYLINDER, 1)
    fit = as_fit(body.lateral())
    fine_, coarse = (profile_of(fit, patch, heights_of(-0.08, 0.08, pitch)) for pitch in (0.002, 0.008))
    assert np.nanmedian(fine_.own_m) == pytest.approx(2 * np.nanmedian(coarse.own_m), rel=0.15)


def test_a_ball_has_none():
    with pytest.raises(TypeError):
        profile_of(as_fit(Ball(np.array([0.0, 0, 1]), 0.1, 700.0)), seen(CYLINDER, 0)[1], heights_of(0, 0.1))


def test_the_sense_of_the_axis_does_not_matter():
    body, patch, _ = seen(BOTTLE, 3)
    turned = replace(body, direction=-body.direction)
    heights = heights_of(-0.08, 0.08)
    one = profile_of(as_fit(body.lateral()), patch, heights)
    other = profile_of(as_fit(turned.lateral()), patch, -heights[::-1])
    np.testing.assert_allclose(one.radius_m, other.radius_m[::-1], atol=1e-5)

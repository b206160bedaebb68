"""A fit doubts what another way to its size says, the more the less of the outline is seen."""

from dataclasses import replace

import numpy as np
import pytest

from app.bench.accuracy.clouds import FULL_MODEL, cloud_of, pose_of
from app.bench.accuracy.outcome import by_program
from rotrecon.rays.ball import Ball
from rotrecon.rays.doubting import doubting, doubting_outline
from rotrecon.rays.fitting import Outline
from rotrecon.rays.ray_fit import RayFit
from tests.bodies import CONE, CYLINDER, as_fit, body_at

OWN_M, WINDOWS = 0.0002, 3.0


def seen_on(sides: int) -> tuple[tuple[Outline, float], ...]:
    rays, sigma_px = np.ones((3, 40)), np.full(40, 0.4)
    stretches = np.array_split(np.arange(40, dtype=np.int32), sides)
    return ((Outline(rays, sigma_px, 700.0, tuple((stretch, 0.05) for stretch in stretches)), 1.0),)


def fit_of(radius_m: float, sides: int = 2, slope: float = 0.0) -> RayFit:
    surface = body_at(CONE if slope else CYLINDER, 3).lateral(0.0, slope, slope != 0)
    fit = as_fit(replace(surface, radius_m=radius_m), seen_on(sides))
    return replace(fit, own_covariance=lambda: OWN_M**2 * np.eye(len(fit.free)))


def sigma_m(fit: RayFit) -> float:
    return float(np.sqrt(fit.covariance[fit.surface.size_place, fit.surface.size_place]))


@pytest.mark.parametrize("sides", [1, 2])
def test_an_outline_that_depths_agree_with_is_not_doubted(sides):
    assert sigma_m(doubting_outline(fit_of(0.03, sides), fit_of(0.03), WINDOWS)) == pytest.approx(OWN_M)


def test_doubt_grows_with_what_the_outline_changes_and_is_larger_where_one_side_is_seen():
    for near, far in ((0.0301, 0.031), (0.031, 0.05)):
        for sides in (1, 2):
            fit = fit_of(0.03, sides)
            assert (
                OWN_M
                < sigma_m(doubting_outline(fit, fit_of(near), WINDOWS))
                < sigma_m(doubting_outline(fit, fit_of(far), WINDOWS))
            )
        one, two = (sigma_m(doubting_outline(fit_of(0.03, sides), fit_of(far), WINDOWS)) for sides in (1, 2))
        assert two < 0.5 * one
        assert one < far - 0.03, "an outline is worth more than the depths it contradicts"


def test_depths_have_the_more_of_a_say_the_more_windows_a_cylinder_is_wide():
    one, three, six, many = (
        sigma_m(doubting_outline(fit_of(0.03), fit_of(0.031), windows)) for windows in (1.0, 3.0, 6.0, np.inf)
    )
    assert OWN_M < one < three < six == many


def test_how_the_sides_of_an_outline_converge_is_not_doubted():
    doubted = doubting_outline(fit_of(0.03, slope=0.1), fit_of(0.031, slope=0.2), WINDOWS)
    assert doubted.covariance[5, 5] == pytest.approx(OWN_M**2)
    assert doubting(fit_of(0.03, slope=0.1), fit_of(0.03, slope=0.2)).covariance[5, 5] > 2 * OWN_M**2


def test_the_outline_of_a_ball_is_doubted_by_all_that_it_changes():
    center_m = np.array([0.0, 0.0, 0.7])
    ball, other = (as_fit(Ball(center_m, radius_m, 700.0), seen_on(4)) for radius_m in (0.1, 0.102))
    assert sigma_m(doubting_outline(ball, other, WINDOWS)) == pytest.approx(1.1 * 0.002)


@pytest.mark.parametrize("seed", [3001, 3036, 3038])
def test_depths_that_windows_have_spoilt_do_not_outvote_the_outline_of_a_thin_rod(seed):
    """Between its limbs there are two windows' width: depths alone have it up to twice as thick, and sure of that."""
    outcome = by_program(cloud_of(pose_of("wire", seed, 2), FULL_MODEL), "robust")
    assert outcome.kind == "rod"
    assert abs(outcome.radius) < 0.08
    assert outcome.radius_interval[0] < 0 < outcome.radius_interval[1]

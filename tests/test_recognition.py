"""Which kind is chosen, what else stays possible, and the solid that is made of it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotrecon.primitives import Frustum, Sphere
from rotrecon.rays.ball import Ball
from rotrecon.rays.correlation import Likeness
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.ray_fit import RayFit, Sight
from rotrecon.rays.robust import Ranked
from rotrecon.rays.surfaces import Surface, turn_of
from rotrecon.recognition import candidates_of, chosen_of, half_angle_rad, is_possible, is_straight, solid_of
from rotrecon.sections.radii import Shape
from rotrecon.settings import Settings

SETTINGS = Settings()
CENTER_M = np.array([0.02, -0.01, 0.8])
DIRECTION = np.array([0.0, 1.0, 0.0])
costs = st.floats(0.0, 60.0)


def surface_of(shape: Shape, half_angle_deg: float = 12.0, radius_m: float = 0.05) -> Surface:
    if shape == "sphere":
        return Ball(CENTER_M, radius_m, 700.0)
    slope = float(np.tan(np.deg2rad(half_angle_deg))) if shape == "cone" else 0.0
    return Lateral(CENTER_M, turn_of(DIRECTION, -CENTER_M), radius_m, slope, 700.0, shape == "cone")


def ranked(
    shape: Shape, cost: float, half_angle_deg: float = 12.0, off_deg: float = 0.1, radius_m: float = 0.05
) -> Ranked:
    """A shape that was fitted, its half angle with a standard error."""
    surface = surface_of(shape, half_angle_deg, radius_m)
    size = len(surface.units(1.0))
    sigma = np.array([1e-4, 1e-4, 1e-3, 1e-3, 1e-4, np.deg2rad(off_deg)])[:size]
    nothing = np.zeros(5000)
    fit = RayFit(
        surface, Sight(), (), np.ones(size, dtype=np.bool_), nothing.astype(np.int32), nothing, 1.0,
        Likeness(0.0, 0.0), lambda: np.diag(sigma**2),
    )  # fmt: skip
    return Ranked(shape, surface, fit, cost)


def hopeless(shape: Shape, cost: float) -> Ranked:
    return replace(ranked(shape, cost), fit=None)


@given(costs, costs)
def test_the_most_credible_is_chosen_unless_a_kind_is_asked_for(second, third):
    order = (ranked("sphere", 0.0), ranked("cylinder", second), ranked("cone", second + third))
    assert chosen_of(order, None, SETTINGS) is order[0]
    asked = chosen_of(order, "cylinder", SETTINGS)
    assert asked is (order[1] if second <= SETTINGS.asked_cost else None)
    assert chosen_of(order, "rod", SETTINGS) is asked, "a rod is a cylinder"


def test_a_kind_that_was_hopeless_is_never_chosen():
    order = (ranked("cone", 0.0), hopeless("sphere", 3.0))
    assert chosen_of(order, "sphere", SETTINGS) is None
    assert not is_possible(order[1], order[0], SETTINGS)


def test_a_cone_that_hardly_tapers_is_a_cylinder_unless_the_depths_insist():
    slight, clear = ranked("cone", 0.0, half_angle_deg=2.7, off_deg=0.5), ranked("cone", 0.0, half_angle_deg=6.0)
    near, far = ranked("cylinder", SETTINGS.tapers_cost), ranked("cylinder", SETTINGS.tapers_cost + 0.1)
    assert chosen_of((slight, near), None, SETTINGS) is near
    assert chosen_of((slight, far), None, SETTINGS) is slight
    assert chosen_of((clear, near), None, SETTINGS) is clear
    assert chosen_of((slight, hopeless("cylinder", 1.0)), None, SETTINGS) is slight


def test_a_cone_that_cannot_taper_much_is_a_cylinder_of_its_size_whatever_the_depths_say():
    straight, far = ranked("cone", 0.0, half_angle_deg=0.5), ranked("cylinder", 100.0)
    assert chosen_of((straight, far), None, SETTINGS) is far
    assert chosen_of((straight, ranked("cylinder", 100.0, radius_m=0.06)), None, SETTINGS) is straight


def test_another_kind_is_possible_until_it_is_a_hundred_times_less_credible():
    chosen = ranked("cylinder", 0.0)
    within, beyond = ranked("sphere", SETTINGS.excluded_cost - 0.01), ranked("sphere", SETTINGS.excluded_cost + 0.01)
    assert np.exp(SETTINGS.excluded_cost) == pytest.approx(100, rel=0.02)
    assert is_possible(within, chosen, SETTINGS)
    assert not is_possible(beyond, chosen, SETTINGS)
    assert is_possible(chosen, chosen, SETTINGS)


@pytest.mark.parametrize(
    ("half_angle_deg", "off_deg", "straight"),
    [(0.1, 0.2, True), (0.1, 3.0, False), (-2.5, 0.1, True), (2.9, 0.2, False)],
)
def test_a_cone_is_a_rival_of_a_cylinder_as_far_as_it_may_taper(half_angle_deg, off_deg, straight):
    cylinder, cone = ranked("cylinder", 0.0), ranked("cone", 1.0, half_angle_deg, off_deg)
    assert is_straight(cone, SETTINGS) is straight
    assert is_possible(cone, cylinder, SETTINGS) is not straight


@given(st.tuples(costs, costs, costs), st.integers(0, 2), st.floats(-0.1, 0.1))
def test_scores_are_shares_of_belief_and_the_chosen_kind_stands_first(cost, number, middle_m):
    order = tuple(ranked(shape, value) for shape, value in zip(("cylinder", "cone", "sphere"), cost, strict=True))
    chosen = order[number]
    candidates = candidates_of(order, chosen, middle_m, SETTINGS)
    assert candidates[0].kind == chosen.shape
    assert candidates[0].possible
    assert sum(one.score for one in candidates) == pytest.approx(1.0)
    assert [one.kind for one in candidates[1:]] == [one.shape for one in order if one is not chosen]
    for one, other in ((0, 1), (1, 2)):
        expected = np.exp(order_cost(candidates[other].kind, order) - order_cost(candidates[one].kind, order))
        assert candidates[one].score == pytest.approx(candidates[other].score * expected, rel=1e-6, abs=1e-12)
    for candidate in candidates:
        assert candidate.diameter_m is not None
        low, high = candidate.diameter_m
        assert low < 2 * candidate.radius_m < high


def order_cost(shape: str, order: tuple[Ranked, ...]) -> float:
    return next(one.cost for one in order if one.shape == shape)


def test_a_hopeless_candidate_has_no_interval():
    order = (ranked("cylinder", 0.0), hopeless("sphere", 90.0))
    chosen, other = candidates_of(order, order[0], 0.0, SETTINGS)
    assert chosen.diameter_m is not None
    assert other.diameter_m is None
    assert other.possible is False


@given(st.floats(-0.1, 0.1), st.floats(0.05, 0.3))
def test_a_cone_between_two_heights_is_a_frustum_with_its_radius_in_the_middle(low_m, length_m):
    cone = ranked("cone", 0.0, radius_m=0.2)
    solid = solid_of(cone, None, (low_m, low_m + length_m), DIRECTION, SETTINGS)
    assert isinstance(solid, Frustum)
    assert solid.kind == "cone"
    assert solid.length_m == pytest.approx(length_m)
    assert solid.half_angle_rad == pytest.approx(half_angle_rad(cone)) == pytest.approx(np.deg2rad(12.0))
    assert (solid.center_m - CENTER_M) @ DIRECTION == pytest.approx(low_m + length_m / 2)
    for height_m in (low_m, low_m + length_m):
        along_m = height_m - (low_m + length_m / 2)
        expected = cone.surface.radius_m + np.tan(np.deg2rad(12.0)) * height_m
        assert solid.radius_at(along_m) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("kind", "diameter_m", "length_m", "called"),
    [
        (None, 0.02, 0.3, "rod"),
        (None, 0.02, 0.1, "cylinder"),
        (None, 0.06, 0.6, "cylinder"),
        ("rod", 0.06, 0.1, "rod"),
        ("cylinder", 0.02, 0.3, "cylinder"),
    ],
)
def test_what_is_long_and_thin_is_a_rod_unless_it_is_asked_for_as_something_else(kind, diameter_m, length_m, called):
    one = ranked("cylinder", 0.0, radius_m=diameter_m / 2)
    assert solid_of(one, kind, (0.0, length_m), DIRECTION, SETTINGS).kind == called


def test_a_ball_keeps_the_strokes_direction():
    ball = solid_of(ranked("sphere", 0.0), None, (-0.05, 0.05), DIRECTION, SETTINGS)
    assert isinstance(ball, Sphere)
    assert ball.direction is DIRECTION
    assert ball.radius_m == 0.05

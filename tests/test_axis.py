from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotrecon.axis import Axis, cut_in_space, fit_axis
from rotrecon.circles import SectionCircles, SectionState
from rotrecon.settings import Settings

PAPER = Settings(method="paper")


def circles_at(centers):
    n = len(centers)
    return SectionCircles(
        np.full(n, SectionState.USED, dtype=np.uint8),
        np.asarray(centers, dtype=float),
        np.full(n, 0.05),
        np.zeros((n, 3, 3)),
        np.full(n, 2.0),
        np.zeros(n, dtype=bool),
    )


@given(st.integers(0, 2**31))
def test_exact_centres_give_their_line_in_any_direction_and_lose_none(seed):
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    found = fit_axis(circles_at(rng.normal(size=3) + np.linspace(0, 0.3, 20)[:, None] * direction), PAPER)
    assert found is not None
    assert found.direction == pytest.approx(direction, abs=1e-9)
    assert found.on_axis.all()


def test_a_centre_far_off_does_not_turn_the_axis():
    centers = np.linspace(0, 0.3, 30)[:, None] * np.array([0, 1.0, 0])
    centers += np.random.default_rng(0).normal(0, 1e-4, centers.shape)
    centers[29] += [0.05, 0, 0]
    found = fit_axis(circles_at(centers), PAPER)
    assert found is not None
    assert not found.on_axis[29]
    assert found.direction == pytest.approx([0, 1, 0], abs=2e-3)


def test_centres_in_a_heap_hold_no_axis():
    centers = np.random.default_rng(0).normal(0, 0.01, (30, 3))
    assert fit_axis(circles_at(centers), PAPER) is None


def test_too_few_circles_hold_no_axis():
    circles = circles_at(np.linspace(0, 0.3, 5)[:, None] * np.array([0, 1.0, 0]))
    state = circles.state.copy()
    state[:2] = SectionState.COLLINEAR
    assert fit_axis(replace(circles, state=state), PAPER) is None


@given(st.integers(0, 2**31), st.integers(1, 20))
def test_cut_in_space_does_not_depend_on_the_order_of_points(seed, count):
    rng = np.random.default_rng(seed)
    points = rng.normal([0, 0, 1], 0.1, (200, 3)).astype(np.float32)
    pixel = np.arange(200, dtype=np.int32)
    axis = Axis(np.array([0, 0, 1.0]), np.array([0, 0.6, 0.8]))
    first = cut_in_space(points, pixel, axis, (-0.1, 0.1), count)
    second = cut_in_space(points, rng.permutation(pixel), axis, (-0.1, 0.1), count)
    assert np.array_equal(first.pixel, second.pixel)
    assert np.array_equal(first.start, second.start)


@given(st.integers(0, 2**31))
def test_sections_hold_the_points_between_their_planes_in_order(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal([0, 0, 1], 0.1, (300, 3)).astype(np.float32)
    axis = Axis(np.array([0.01, 0, 1.0]), np.array([1.0, 0, 0]))
    sections = cut_in_space(points, np.arange(300, dtype=np.int32), axis, (-0.1, 0.1), 10)
    along = axis.along(points[sections.pixel])
    for section in range(10):
        mine = slice(sections.start[section], sections.start[section + 1])
        low = -0.1 + 0.02 * section
        assert ((along[mine] >= low - 1e-6) & (along[mine] <= low + 0.02 + 1e-6)).all()
        assert (np.diff(sections.in_plane(sections.points_in(section))[:, 0]) >= -1e-6).all()
    base, _ = sections.base_points()
    assert np.nanmax(np.abs(np.diff(axis.along(base), axis=1))) < 1e-12


def test_no_point_between_the_ends_makes_empty_sections():
    axis = Axis(np.array([0, 0, 1.0]), np.array([1.0, 0, 0]))
    sections = cut_in_space(np.zeros((5, 3), np.float32), np.arange(5, dtype=np.int32), axis, (1.0, 2.0), 4)
    points, count = sections.base_points()
    assert count.tolist() == [0, 0, 0, 0]
    assert np.isnan(points).all()


@given(st.integers(0, 2**31))
def test_a_sight_line_through_a_point_finds_its_section(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal([0, 0, 1], 0.1, (300, 3)).astype(np.float32)
    axis = Axis(np.array([0.01, 0, 1.0]), np.array([1.0, 0, 0]))
    sections = cut_in_space(points, np.arange(300, dtype=np.int32), axis, (-0.1, 0.1), 10)
    chosen = int(rng.integers(10))
    if len(sections.points_in(chosen)) > 0:
        assert sections.section_at(np.zeros(3), sections.points_in(chosen)[0].astype(float)) == chosen


def test_residuals_are_distances_from_the_circle_in_its_plane():
    axis = Axis(np.array([0, 0, 1.0]), np.array([0, 1.0, 0]))
    angle = np.linspace(0.2, 2.9, 20)
    ring = np.stack([0.05 * np.cos(angle), 0.01 * np.sin(9 * angle), 1 - 0.05 * np.sin(angle)], axis=1)
    ring[7] += [0, 0, -0.002]
    sections = cut_in_space(ring.astype(np.float32), np.arange(20, dtype=np.int32), axis, (-0.02, 0.02), 1)
    circles = replace(circles_at(np.array([[0, 0, 1.0]])), radius_m=np.array([0.05]))
    residuals = np.sort(np.abs(sections.residuals_m(0, circles)))
    assert residuals[:-1] == pytest.approx(0, abs=1e-6)
    assert residuals[-1] == pytest.approx(0.002 * np.sin(angle[7]), rel=0.05)

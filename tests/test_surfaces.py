"""Laws of the surfaces that are fitted: where rays meet them, where they graze, and the derivatives of both."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.surfaces import Surface, turn_of

FOCAL_PX = 700.0
U, V = np.meshgrid(np.linspace(-0.6, 0.6, 41), np.linspace(-0.45, 0.45, 31))
RAYS = np.stack([U.ravel(), V.ravel(), np.ones(U.size)])
few = settings(max_examples=40, deadline=None)

axes = st.tuples(st.floats(-0.9, 0.9), st.floats(0.0, 2 * np.pi)).map(
    lambda way: np.array([np.cos(way[0]) * np.cos(way[1]), np.cos(way[0]) * np.sin(way[1]), np.sin(way[0])])
)
centers = st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(0.5, 1.2)).map(np.array)


def lateral(center: np.ndarray, direction: np.ndarray, radius: float, slope: float, tapers: bool, side: int) -> Lateral:
    return Lateral(center, turn_of(direction, -center), radius, slope, FOCAL_PX, tapers, side)


outsides = st.sampled_from([-1, 1])
cylinders = st.builds(lateral, centers, axes, st.floats(0.01, 0.2), st.just(0.0), st.just(False), outsides)
cones = st.builds(lateral, centers, axes, st.floats(0.01, 0.2), st.floats(-0.6, 0.6), st.just(True), outsides)
balls = st.builds(Ball, centers, st.floats(0.01, 0.3), st.just(FOCAL_PX), outsides)
surfaces: st.SearchStrategy[Surface] = st.one_of(cylinders, cones, balls)


def off_surface(surface: Surface, points: np.ndarray) -> np.ndarray:
    """Distance (N,) of points (3, N) from the axis or centre, less the radius there."""
    offset = points - surface.center_m[:, None]
    if isinstance(surface, Ball):
        return np.linalg.norm(offset, axis=0) - surface.radius_m
    x, y, height = surface.turn @ offset
    return np.hypot(x, y) - np.abs(surface.radius_m + surface.slope * height)


def clear_hits(surface: Surface) -> np.ndarray:
    """Rays (3, n) that meet a surface well inside its outline, in front of the camera and not along a flank."""
    trace = surface.trace(RAYS)
    clear = trace.hit & (trace.depth_m > 0.05) & (trace.depth_m < 5.0) & (surface.off_middle(RAYS) < 0.9)
    if isinstance(surface, Lateral):
        clear &= surface.radius_m + surface.slope * surface.heights((RAYS * trace.depth_m).T) > 0.005
    return RAYS[:, clear]


def steps_of(surface: Surface, size: float) -> list[np.ndarray]:
    return list(size * np.eye(len(surface.units(1.0))))


def outline_rays(surface: Surface) -> np.ndarray:
    """Rays (3, n) between one of the grid that hits and the next that does not."""
    hit = surface.trace(RAYS).hit.reshape(U.shape)
    rows, columns = np.nonzero(hit[:, :-1] != hit[:, 1:])
    inside = RAYS.reshape(3, *U.shape)[:, rows, columns + ~hit[rows, columns]]
    outside = RAYS.reshape(3, *U.shape)[:, rows, columns + hit[rows, columns]]
    for _ in range(50):
        middle = (inside + outside) / 2
        hits = surface.trace(middle).hit
        inside, outside = np.where(hits, middle, inside), np.where(hits, outside, middle)
    return inside


@few
@given(surfaces)
def test_depth_lies_on_the_surface_on_the_side_that_is_meant(surface):
    rays = clear_hits(surface)
    assume(rays.shape[1])
    trace = surface.trace(rays)
    assert trace.hit.all()
    assert np.abs(off_surface(surface, rays * trace.depth_m)).max() < 1e-9
    behind = replace(surface, side=-surface.side).trace(rays).depth_m
    if not (isinstance(surface, Lateral) and surface.tapers):
        assert (surface.side * (trace.depth_m - behind) > 0).all()


@few
@given(surfaces)
def test_columns_of_the_depth_are_its_derivatives(surface):
    rays = clear_hits(surface)
    assume(rays.shape[1])
    columns = surface.trace(rays).columns
    for column, step in zip(columns, steps_of(surface, 1e-7), strict=True):
        more, less = surface.stepped(step).trace(rays).depth_m, surface.stepped(-step).trace(rays).depth_m
        assert (more - less) / 2e-7 == pytest.approx(column, rel=1e-3, abs=1e-4 * np.abs(columns).max())


@few
@given(surfaces)
def test_rays_that_miss_go_on_with_finite_depths_and_a_pull(surface):
    trace = surface.trace(RAYS)
    assert np.isfinite(trace.depth_m).all()
    assert np.isfinite(trace.columns).all()
    assert (np.abs(trace.columns[:, ~trace.hit]).max(axis=0) > 0).all()


@few
@given(st.one_of(cylinders, balls))
def test_rays_hit_where_they_do_not_pass_outside(surface):
    tangency, trace = surface.tangency(RAYS), surface.trace(RAYS)
    clear = np.abs(tangency.gap_m) > 1e-9
    assert ((tangency.gap_m < 0) == trace.hit)[clear].all()


@few
@given(surfaces)
def test_gap_is_zero_on_the_outline_and_its_columns_are_its_derivatives_there(surface):
    rays = outline_rays(surface)
    assume(rays.shape[1])
    tangency = surface.tangency(rays)
    near = np.flatnonzero((tangency.depth_m > 0.05) & (tangency.depth_m < 3.0))
    if isinstance(surface, Lateral):
        radius = surface.radius_m + surface.slope * surface.heights((rays * tangency.depth_m).T)
        near = near[radius[near] > 0.005]
    assume(len(near))
    rays, gap_m, columns = rays[:, near], tangency.gap_m[near], tangency.columns[:, near]
    assert np.abs(gap_m).max() < 1e-9
    assert surface.off_middle(rays) == pytest.approx(1.0, abs=1e-6)
    for column, step in zip(columns, steps_of(surface, 1e-6), strict=True):
        more, less = surface.stepped(step).tangency(rays).gap_m, surface.stepped(-step).tangency(rays).gap_m
        assert (more - less) / 2e-6 == pytest.approx(column, rel=1e-3, abs=1e-3 * np.abs(columns).max())


@few
@given(surfaces, st.integers(0, 99))
def test_a_step_and_its_inverse_cancel_to_the_second_order(surface, seed):
    rays = clear_hits(surface)
    assume(rays.shape[1])
    step = 1e-5 * np.random.default_rng(seed).uniform(-1, 1, len(surface.units(1.0)))
    back = surface.stepped(step).stepped(-step)
    there = np.abs(surface.stepped(step).trace(rays).depth_m - surface.trace(rays).depth_m).max()
    assert np.abs(back.trace(rays).depth_m - surface.trace(rays).depth_m).max() < 1e-2 * there + 1e-12
    assert back.size_m == pytest.approx(surface.size_m, abs=1e-15)


@few
@given(st.one_of(cylinders, cones), st.integers(0, 99))
def test_an_axis_stays_a_unit_vector_in_a_rotation(surface, seed):
    stepped = surface.stepped(np.random.default_rng(seed).uniform(-0.3, 0.3, len(surface.units(1.0))))
    assert stepped.turn @ stepped.turn.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(stepped.turn) == pytest.approx(1.0)
    if not surface.tapers:
        assert stepped.slope == surface.slope


@given(st.one_of(cylinders, cones), st.floats(-0.3, 0.3))
def test_heights_are_along_the_axis_from_its_centre(surface, height_m):
    across, toward, axis = surface.turn
    points = surface.center_m + height_m * axis + 0.05 * np.stack([across, toward, across - toward])
    assert surface.heights(points) == pytest.approx(height_m)


def test_a_ray_through_the_middle_of_a_ball_meets_it_a_radius_before_and_behind():
    ball = Ball(np.array([0.0, 0.0, 0.8]), 0.1, FOCAL_PX)
    middle = np.array([[0.0], [0.0], [1.0]])
    assert ball.trace(middle).depth_m == pytest.approx(0.7)
    assert replace(ball, side=1).trace(middle).depth_m == pytest.approx(0.9)
    assert ball.off_middle(middle) == pytest.approx(0.0)
    assert ball.tangency(middle).depth_m == pytest.approx(0.8)

"""Starts of the robust loop: near enough to follow, whatever is wrong with a part of what they are read off."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.camera import PinholeCamera
from rotrecon.drawing import Drawing, cut_sections
from rotrecon.frame import Frame
from rotrecon.primitives import Primitive, Sphere
from rotrecon.rays.starts import (
    CONE_ANGLES_RAD,
    Ridge,
    ball_starts,
    cone_starts,
    cylinder_starts,
    medians,
    ridge,
    robust_circle,
    robust_line,
)
from rotrecon.segmentation import segment
from rotrecon.settings import Settings
from tests.exact import CAMERA, cone, cylinder, direction_of, drawing_along, exact_frame, noisy

few = settings(max_examples=15, deadline=None)
FOCAL_PX = CAMERA.focal_px


def seen(frame: Frame, drawing: Drawing, camera: PinholeCamera = CAMERA) -> tuple[Ridge, np.ndarray]:
    """The ridge of a drawing, and the points (N, 3) of its segmented pixels."""
    segments = cut_sections(drawing.area, drawing.stroke, (camera.width, camera.height))
    points_m = frame.points_m.reshape(-1, 3)[segments.pixel].astype(np.float64)
    known = segments.inside & np.isfinite(points_m[..., 2])
    kept = segment(points_m[..., 2].astype(np.float32), known, segments.inside, Settings()).kept
    return ridge(camera, points_m[..., 2], segments, kept), points_m[kept]


def seen_of(solid: Primitive, seed: int | None = None) -> tuple[Ridge, np.ndarray]:
    frame = exact_frame(solid)
    return seen(frame if seed is None else noisy(frame, seed), drawing_along(solid, 0.7))


@few
@given(st.floats(-40, 40), st.floats(0, 360), st.floats(0.04, 0.1))
def test_a_ridge_lies_nearest_along_the_middle_and_is_as_wide_as_the_object(tilt, roll, diameter):
    solid = cylinder(np.array([0.0, 0.0, 0.8]), direction_of(tilt, roll), diameter)
    edge, _ = seen_of(solid)
    pixel_m = 0.8 / FOCAL_PX
    assert np.median(np.abs(solid.distance(edge.points_m))) < pixel_m
    assert np.median(edge.width_m) == pytest.approx(diameter, abs=5 * pixel_m)
    toward = edge.points_m - solid.center_m
    toward -= np.outer(toward @ solid.direction, solid.direction)
    nearest = -(solid.center_m - (solid.center_m @ solid.direction) * solid.direction)
    cosine = toward @ nearest / np.linalg.norm(toward, axis=1) / np.linalg.norm(nearest)
    assert np.median(cosine) > np.cos(np.deg2rad(15))
    middle, along = robust_line(edge.points_m)
    assert along @ solid.direction > np.cos(np.deg2rad(3))
    assert abs(float(solid.distance(middle))) < 2 * pixel_m


@few
@given(st.floats(-40, 40), st.floats(0, 360), st.floats(0.04, 0.1), st.integers(0, 99))
def test_one_of_the_cylinders_is_near(tilt, roll, diameter, seed):
    solid = cylinder(np.array([0.0, 0.0, 0.8]), direction_of(tilt, roll), diameter)
    edge, points_m = seen_of(solid, seed)
    starts = cylinder_starts(edge, points_m, None, FOCAL_PX)
    assert min(abs(start.radius_m - diameter / 2) for start in starts) < 0.15 * diameter / 2
    for start in starts:
        assert start.side == -1
        assert not start.tapers
        assert abs(start.direction @ solid.direction) > np.cos(np.deg2rad(5))
    assert min(np.linalg.norm(across(start.center_m, solid)) for start in starts) < 0.2 * diameter


def across(point_m: np.ndarray, solid: Primitive) -> np.ndarray:
    offset = point_m - solid.center_m
    return offset - (offset @ solid.direction) * solid.direction


def test_a_direction_that_is_known_is_that_of_every_start():
    solid = cylinder(np.array([0.0, 0.0, 0.8]), direction_of(10, 70), 0.06)
    edge, points_m = seen_of(solid)
    held = -direction_of(14, 70)
    for start in cylinder_starts(edge, points_m, held, FOCAL_PX):
        assert start.direction == pytest.approx(-held), "along the stroke"
    assert all(abs(start.direction @ held) > 0.9 for start in cone_starts(edge, held, FOCAL_PX))
    assert len(cone_starts(edge, held, FOCAL_PX)) < len(CONE_ANGLES_RAD)


def test_a_surface_seen_from_inside_starts_so():
    u, v = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    rays = CAMERA.unproject(np.stack([u, v], axis=-1), np.ones(u.shape))
    a, b, c = rays[..., 0] ** 2 + 1, -0.3, 0.3**2 - 0.25**2
    points_m = (rays * ((-b + np.sqrt(b**2 - a * c)) / a)[..., None])[60:180:5, 60:260:5]
    edge = Ridge(points_m[:, 20], np.full(24, 0.3))
    starts = cylinder_starts(edge, points_m.reshape(-1, 3), None, FOCAL_PX)
    inside = [start for start in starts if start.side == 1]
    assert len(inside) == 1
    assert inside[0].radius_m == pytest.approx(0.25, rel=0.02)


def test_cones_have_the_ridge_as_a_generator_and_one_of_them_is_near():
    solid = cone(np.array([0.0, 0.0, 0.7]), np.array([0.0, 1.0, 0.0]), 0.1, 14.0, 0.2)
    edge, _ = seen_of(solid)
    starts = cone_starts(edge, None, FOCAL_PX)
    assert [np.arctan(start.slope) for start in starts] == pytest.approx(CONE_ANGLES_RAD)
    for start in starts:
        height = start.heights(edge.points_m)
        offset = edge.points_m - start.center_m - height[:, None] * start.direction
        off_m = np.linalg.norm(offset, axis=1) - (start.radius_m + start.slope * height)
        assert np.median(np.abs(off_m)) < 0.005
    near = min(starts, key=lambda start: abs(start.slope - np.tan(np.deg2rad(14.0))))
    turned_rad = abs(np.arctan(near.slope) - np.deg2rad(14.0))
    assert near.direction @ solid.direction == pytest.approx(np.cos(turned_rad), abs=0.005)


@few
@given(st.floats(0.12, 0.22), st.integers(0, 99))
def test_one_of_the_balls_is_near(diameter, seed):
    solid = Sphere(np.array([0.01, 0.02, 0.8]), np.array([0.0, 1.0, 0.0]), diameter / 2)
    starts = ball_starts(*seen_of(solid, seed), FOCAL_PX)
    assert min(abs(start.radius_m - solid.radius_m) for start in starts) < 0.15 * solid.radius_m
    assert min(np.linalg.norm(start.center_m - solid.center_m) for start in starts) < 0.2 * diameter


@given(st.integers(0, 2**31))
def test_a_line_goes_through_most_of_the_points_in_their_order(seed):
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    point = rng.normal(size=3)
    points = point + np.linspace(-0.1, 0.1, 60)[:, None] * direction + 1e-4 * rng.normal(size=(60, 3))
    points[rng.choice(60, 12, replace=False)] += rng.uniform(0.03, 0.1, (12, 3))
    middle, along = robust_line(points)
    assert along @ direction > np.cos(np.deg2rad(1))
    assert np.linalg.norm(np.cross(middle - point, direction)) < 1e-3
    assert robust_line(points[::-1])[1] == pytest.approx(-along)


@given(st.integers(0, 2**31), st.sampled_from([2, 3]))
def test_a_circle_or_a_sphere_goes_through_most_of_the_points(seed, dimensions):
    rng = np.random.default_rng(seed)
    center, radius = rng.uniform(-0.1, 0.1, dimensions), rng.uniform(0.02, 0.2)
    way = rng.normal(size=(200, dimensions))
    way[:, -1] = -np.abs(way[:, -1])
    points = center + radius * way / np.linalg.norm(way, axis=1, keepdims=True)
    points[:30] += rng.uniform(-0.5, 0.5, (30, dimensions)) * radius
    found = robust_circle(points)
    assert found is not None
    assert found[0] == pytest.approx(center, abs=0.01 * radius)
    assert found[1] == pytest.approx(radius, rel=0.01)


def test_one_place_is_no_circle():
    assert robust_circle(np.zeros((50, 2))) is None


@given(st.integers(0, 2**31))
def test_medians_are_of_the_smallest_values_of_each_row(seed):
    rng = np.random.default_rng(seed)
    count = rng.integers(1, 9, 5).astype(np.int32)
    values = np.full((5, 9), np.inf)
    for row, known in zip(values, count, strict=True):
        row[rng.permutation(9)[:known]] = rng.normal(size=known)
    expected = [np.sort(row)[(known - 1) // 2] for row, known in zip(values, count, strict=True)]
    assert medians(values, count).tolist() == expected

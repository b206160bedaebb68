"""Directions that the operator holds an axis to."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.drawing_text import parse_area, parse_axis
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import Constraints, Direction, Drawing, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.outcome import FailureReason, FitFailure
from rotrecon.scene.reading import read_scene
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate
from rotrecon.stroke.axis_direction import held_direction
from rotrecon.stroke.axis_proposal import propose_axis
from tests.exact import CAMERA, cone, cylinder, direction_of, drawing_along, exact_frame, noisy
from tests.recordings import recording
from tests.standing import UP, area_round, table_with, upright


def held(frame: Frame, drawing: Drawing, direction: Direction) -> np.ndarray:
    result = held_direction(frame, replace(drawing, constraints=Constraints(direction=direction)))
    assert isinstance(result, np.ndarray), result
    assert np.linalg.norm(result) == pytest.approx(1)
    return result


def refused(frame: Frame, drawing: Drawing, direction: Direction) -> FitFailure:
    result = held_direction(frame, replace(drawing, constraints=Constraints(direction=direction)))
    assert isinstance(result, FitFailure), result
    assert result.reason == FailureReason.CONSTRAINED
    return result


def degrees_between(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip(one @ other, -1, 1))))


def backwards(drawing: Drawing) -> Drawing:
    return replace(drawing, axis=ObjectAxis(drawing.stroke.end_px, drawing.stroke.start_px))


def standing() -> tuple[Frame, Drawing]:
    solid = upright()
    return table_with(solid), replace(drawing_along(solid), area=area_round(solid, 1.3))


def turned_base(frame: Frame, up: np.ndarray, yaw_rad: float, shift_m: np.ndarray) -> Frame:
    """The frame with a base whose z is `up` in camera coordinates."""
    across = np.cross(up, [1.0, 0.3, 0.2])
    across /= np.linalg.norm(across)
    forward = np.cross(up, across)
    x = np.cos(yaw_rad) * across + np.sin(yaw_rad) * forward
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, np.cross(up, x), up])
    pose[:3, 3] = shift_m
    return replace(frame, T_base_camera=pose)


def test_free_axis_is_not_held():
    frame, drawing = standing()
    assert held_direction(frame, drawing) is None


@settings(deadline=None, max_examples=20)
@given(st.floats(0, 6.28), st.floats(-1, 1), st.floats(-1, 1))
def test_vertical_is_the_up_of_the_base_wherever_that_stands(yaw_rad, x_m, y_m):
    frame, drawing = standing()
    based = turned_base(frame, UP, yaw_rad, np.array([x_m, y_m, 0.3]))
    assert degrees_between(held(based, drawing, "vertical"), UP) < 1e-4
    assert degrees_between(held(based, backwards(drawing), "vertical"), -UP) < 1e-4


def test_plane_is_square_to_the_table():
    frame, drawing = standing()
    assert degrees_between(held(frame, drawing, "plane"), UP) < 0.05
    assert degrees_between(held(frame, backwards(drawing), "plane"), -UP) < 0.05
    assert degrees_between(held(noisy(frame, seed=2), drawing, "plane"), UP) < 0.5


def test_plane_is_refused_where_none_is_seen():
    """Not the side of a thin thing itself, where it leaves the area, though that is flat within a tolerance."""
    for diameter_m in (0.015, 0.08):
        solid = cylinder([0, 0, 0.8], [0.1, 1, 0], diameter_m, length_m=0.2)
        failure = refused(exact_frame(solid, wall_m=np.inf), drawing_along(solid), "plane")
        assert "draw the area larger" in failure.advice


def test_plane_is_refused_where_most_of_the_rest_is_not_on_it():
    frame, drawing = standing()
    thing = np.isfinite(exact_frame(upright(), wall_m=np.inf).depth_m)
    v, u = np.indices(thing.shape)
    waves = np.where(thing | (v > 175), 0, 0.05 * np.sin(u / 6.0) * np.sin(v / 7.0))
    rough = replace(frame, points_m=CAMERA.cloud(frame.depth_m + waves))
    large = replace(drawing, area=area_round(upright(), 2.0))
    assert isinstance(held_direction(frame, replace(large, constraints=Constraints(direction="plane"))), np.ndarray)
    refused(rough, large, "plane")


@settings(deadline=None, max_examples=30, derandomize=True)
@given(st.builds(direction_of, st.floats(-35, 35), st.floats(0, 360)), st.floats(0.03, 0.09))
def test_drawn_is_parallel_to_the_axis_of_a_cylinder(direction, diameter_m):
    solid = cylinder([0.03, -0.02, 0.8], direction, diameter_m, length_m=0.2)
    frame, drawing = exact_frame(solid), drawing_along(solid)
    assert degrees_between(held(frame, drawing, "drawn"), solid.direction) < 0.3
    assert degrees_between(held(frame, backwards(drawing), "drawn"), -solid.direction) < 0.3
    assert degrees_between(held(noisy(frame, seed=4), drawing, "drawn"), solid.direction) < 1.5


def test_drawn_leans_by_the_half_angle_of_a_cone():
    solid = cone([0, 0, 0.8], [0.1, 1, 0], 0.1, 12, length_m=0.15)
    drawn = held(exact_frame(solid), drawing_along(solid), "drawn")
    assert degrees_between(drawn, solid.direction) == pytest.approx(12, abs=0.3)


def test_drawn_does_not_mind_outliers_on_the_surface():
    solid = cylinder([0, 0, 0.8], [0.1, 1, 0.2], 0.08, length_m=0.2)
    frame, drawing = exact_frame(solid), drawing_along(solid)
    depth = frame.depth_m.copy()
    depth[100:112, 150:170] -= 0.01
    assert degrees_between(held(replace(frame, points_m=CAMERA.cloud(depth)), drawing, "drawn"), solid.direction) < 0.5


def test_stroke_beside_the_thing_is_refused():
    frame, drawing = standing()
    beside = replace(drawing, axis=ObjectAxis((60.0, 60.0), (60.0, 120.0)))
    assert "under the stroke" in refused(frame, beside, "drawn").advice


def test_direction_across_the_stroke_is_refused():
    frame, drawing = standing()
    lying = turned_base(frame, np.array([1.0, 0, 0]), 0.0, np.zeros(3))
    assert "across the stroke" in refused(lying, drawing, "vertical").advice


@pytest.mark.parametrize("direction", ["drawn", "plane"])
def test_scene_turned_about_the_sight_line_has_turned_directions(direction):
    """A quarter turn of the picture: x becomes y, and y becomes -x."""
    frame, drawing = standing()
    camera = PinholeCamera(240, 320, np.array([[400.0, 0, 119.5], [0, 400.0, 159.5], [0, 0, 1]]))
    depth = np.rot90(frame.depth_m, k=-1)
    turned = replace(frame, points_m=camera.cloud(depth), camera=camera, image=np.zeros((320, 240, 3), np.uint8))

    def turn(px: tuple[float, float]) -> tuple[float, float]:
        return (239 - px[1], px[0])

    area = replace(drawing.area, vertices_px=tuple(turn(px) for px in drawing.area.vertices_px))
    there = replace(drawing, area=area, axis=ObjectAxis(turn(drawing.stroke.start_px), turn(drawing.stroke.end_px)))
    x, y, z = held(frame, drawing, direction)
    assert held(turned, there, direction) == pytest.approx(np.array([-y, x, z]), abs=2e-3)


def test_drawing_without_an_axis_is_a_mistake_of_the_caller():
    frame, drawing = standing()
    with pytest.raises(ValueError, match="no axis"):
        held(frame, replace(drawing, axis=None), "drawn")


@pytest.mark.parametrize("name", ["leg", "wire", "pipe"])
def test_drawn_is_parallel_to_the_axis_on_matched_depth(name):
    for seed in range(2):
        scene = simulate(name, seed, supersampling=1)
        drawn = held(scene.frame, scene.drawing, "drawn")
        assert abs(drawn @ scene.solid_in_camera.direction) > np.cos(np.deg2rad(1.0))


TIN = ("270,50 380,232", "325,75 325,222")


def test_recorded_tin_stands_square_to_its_table():
    """Two ways to one direction; a stroke drawn by hand is 3 degrees off the axis, the proposed one half a degree."""
    frame = read_scene(recording("tin")).frame()
    assert isinstance(frame, Frame)
    area = parse_area(TIN[0])
    by_hand = Drawing(area, parse_axis(TIN[1]))
    proposed = Drawing(area, propose_axis(frame, area, Settings()))
    assert degrees_between(held(frame, by_hand, "plane"), held(frame, by_hand, "drawn")) < 4
    assert degrees_between(held(frame, proposed, "plane"), held(frame, proposed, "drawn")) < 1.5

"""The contact that is proposed instead of one that is blocked: free, and the nearest that is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.contact import Place, limits_of
from rotrecon.free_contact import STEP_M, nearest_free
from rotrecon.grasp import grasp_of
from rotrecon.primitives import Sphere
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.tool_table import default_tools
from rotrecon.workspace import Workspace
from tests.exact import drawing_along, exact_frame
from tests.test_grasp import grasp, measured, with_point

CUTTER = default_tools()[0]


def is_free(result: Reconstruction, place: Place) -> bool:
    found = grasp(result, place)
    return not len(found.at_contact.pixel) and not len(found.on_way.pixel) and not found.unreachable


def beside(along_m: float, part: int = 0) -> np.ndarray:
    """A point in a part of the tool's steel when the tool is at that place."""
    return grasp(measured(), Place(0.0, along_m)).envelope.solid[part].center_m


@settings(max_examples=12, deadline=None)
@given(st.floats(-0.08, 0.08), st.integers(0, 2), st.floats(-0.08, 0.08))
def test_it_is_free_and_nothing_nearer_is(along_m: float, part: int, here_m: float) -> None:
    result, _ = with_point(measured(), beside(along_m, part))
    result = replace(result, drawing=replace(result.drawing, contact=Place(0.0, here_m)))
    found = nearest_free(result, CUTTER)
    assert found is not None
    assert is_free(result, found)
    steps = round((found.along_m - here_m) / STEP_M)
    assert found.along_m == pytest.approx(here_m + steps * STEP_M)
    for step in range(1, abs(steps)):
        for along in (here_m + step * STEP_M, here_m - step * STEP_M):
            assert not is_free(result, Place(0.0, along))


def test_the_side_that_the_operator_has_chosen_is_kept() -> None:
    result, _ = with_point(measured(), grasp(measured(), Place(0.5)).envelope.body.center_m)
    found = nearest_free(replace(result, drawing=replace(result.drawing, contact=Place(0.5))), CUTTER)
    assert found is not None
    assert found.angle_rad == 0.5
    assert found.along_m != 0


def test_the_arm_gets_there() -> None:
    y_m = float(grasp(measured()).contact.point_m[1])
    box_m = np.array([[-2.0, y_m + 0.022, -2.0], [2.0, 2.0, 2.0]])
    result = replace(measured(), frame=replace(measured().frame, workspace=Workspace(box_m=box_m)))
    found = nearest_free(result, CUTTER)
    assert found is not None
    assert abs(found.along_m) == pytest.approx(0.025)
    assert is_free(result, found)


def test_a_ball_has_one_too() -> None:
    ball = Sphere(np.array([0.1, 0.05, 1.0]), np.array([0.0, 1.0, 0.0]), 0.06)
    result = reconstruct(exact_frame(ball), drawing_along(ball), Settings())
    grip = default_tools()[-1]
    now = grasp_of(result, grip, Place(0.0, 0.01))
    assert now is not None
    hit, _ = with_point(result, now.envelope.jaws[0].center_m)
    found = nearest_free(replace(hit, drawing=replace(hit.drawing, contact=Place(0.0, 0.01))), grip)
    assert found is not None
    there = grasp_of(hit, grip, found)
    assert there is not None
    assert not len(there.at_contact.pixel)
    assert not len(there.on_way.pixel)


def test_where_nothing_is_free_there_is_none() -> None:
    solid = measured().solid
    assert solid is not None
    result, most_m = measured(), limits_of(solid).along_m
    cloud = result.frame.points_m.copy()
    along_m = np.arange(-most_m, most_m, 0.01)
    cloud[3, : len(along_m)] = [beside(float(along)) for along in along_m]
    blocked = replace(result, frame=replace(result.frame, points_m=cloud))
    assert nearest_free(blocked, CUTTER) is None
    assert nearest_free(replace(measured(), readings=()), CUTTER) is None
    ball_tool = default_tools()[-1]
    assert nearest_free(measured(), ball_tool) is None, "it does not take it anywhere"

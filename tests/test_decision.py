"""The decision as the controller is told: nobody has decided, and the pose of the tool is one."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.decision import Decision, contact_pose, proposal
from rotrecon.primitives import Frustum, Sphere
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate
from rotrecon.tools import NoTool

UNIT = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array).filter(lambda v: np.linalg.norm(v) > 0.1)


@given(UNIT, UNIT, st.booleans())
def test_the_contact_pose_is_rigid_and_its_axes_are_what_they_are_called(axis, approach, ball):
    axis, approach = axis / np.linalg.norm(axis), approach / np.linalg.norm(approach)
    contact_m = np.array([0.1, 0.2, 0.3])
    solid = Sphere(np.zeros(3), axis, 0.1) if ball else Frustum("cylinder", np.zeros(3), axis, 0.3, 0.03)
    pose = contact_pose(solid, contact_m, approach)
    assert np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3))
    assert np.linalg.det(pose) == pytest.approx(1.0)
    assert np.allclose(pose[:3, 2], approach)
    assert np.allclose(pose[:3, 3], contact_m)
    along = np.array([0, 0, 1.0]) if ball else axis
    assert pose[:3, 1] @ along >= -1e-9
    assert abs(pose[:3, 0] @ along) < 1e-6


@pytest.fixture(scope="module")
def result():
    scene = simulate("leg", 0, supersampling=1)
    return reconstruct(scene.frame, scene.drawing, Settings())


def test_a_result_with_a_tool_is_proposed_and_nobody_has_decided(result):
    told = proposal(result, "digest")
    assert (told.state, told.digest, told.tool) == ("proposed", "digest", result.tool.tool.name)
    assert (told.who, told.valid_until) == (None, None)
    assert np.allclose(told.T_base_contact[:3, 3], result.tool.contact_point_m)


def test_without_a_tool_nothing_is_proposed_and_the_reasons_are_told(result):
    told = proposal(replace(result, tool=NoTool(("too thick",))), "digest")
    assert (told.state, told.tool, told.T_base_contact, told.reasons) == ("idle", None, None, ("too thick",))
    assert told.kind == "cylinder"


def test_without_a_result_there_is_nothing_to_tell(result):
    for nothing in (None, replace(result, solid=None)):
        told = proposal(nothing, "digest")
        assert vars(told) == vars(Decision())


def test_what_is_told_cannot_be_changed(result):
    with pytest.raises(ValueError, match="read-only"):
        proposal(result, None).T_base_contact[0, 0] = 2.0

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from rotrecon.primitives import Frustum, Sphere
from rotrecon.tool_table import ToolTableError, default_tools, read_tools
from rotrecon.tools import NoTool, Reading, ToolProposal, propose_tool

CAMERA_M = np.zeros(3)
CUTTER = '[cutter]\nname = "cutter"\ntakes = ["cylinder"]\ndiameter_mm = [20, 100]\n'


def pipe(diameter_m=0.06, length_m=0.3, kind: Literal["cylinder", "rod", "cone"] = "cylinder"):
    return Frustum(kind, np.array([0, 0, 0.8]), np.array([0, 1.0, 0]), length_m, diameter_m / 2)


def test_default_table_is_table_1_of_the_paper():
    ball = Sphere(np.array([0, 0, 0.8]), np.array([0, 1.0, 0]), 0.1)
    cases = [
        (pipe(), "mechanical cutter"),
        (pipe(0.02, kind="rod"), "clipper"),
        (replace(pipe(kind="cone"), half_angle_rad=0.2), "grip"),
        (ball, "grip"),
    ]
    for solid, name in cases:
        proposal = propose_tool((Reading(solid),), CAMERA_M, False, default_tools())
        assert isinstance(proposal, ToolProposal)
        assert proposal.tool.name == name


def test_no_tool_says_why_each_is_ruled_out():
    answer = propose_tool((Reading(pipe(diameter_m=0.4)),), CAMERA_M, False, default_tools())
    assert isinstance(answer, NoTool)
    assert len(answer.reasons) == len(default_tools())
    assert "400.0 mm" in answer.reasons[0]


def test_too_short_for_its_thickness_and_out_of_reach(tmp_path):
    file = tmp_path / "tools.toml"
    file.write_text(CUTTER + "min_length_over_diameter = 3\nreach_m = 0.5\n")
    short = propose_tool((Reading(pipe(length_m=0.1)),), CAMERA_M, False, read_tools(file))
    far = propose_tool((Reading(pipe()),), CAMERA_M, False, read_tools(file))
    assert isinstance(short, NoTool)
    assert "3 times as long as thick" in short.reasons[0]
    assert isinstance(far, NoTool)
    assert "reaches 0.5 m" in far.reasons[0]


def test_inside_of_a_pipe_gets_no_tool():
    assert isinstance(propose_tool((Reading(pipe()),), CAMERA_M, True, default_tools()), NoTool)


def test_camera_on_the_axis_still_gets_an_approach():
    solid = Frustum("cylinder", np.array([0, 0, 0.8]), np.array([0, 0, 1.0]), 0.3, 0.03)
    proposal = propose_tool((Reading(solid),), CAMERA_M, False, default_tools())
    assert isinstance(proposal, ToolProposal)
    assert np.linalg.norm(proposal.approach) == pytest.approx(1)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "holds no tool"),
        ("[cutter", "is not TOML"),
        ('cutter = "sharp"', r"\[cutter\]"),
        ('[cutter]\nname = "x"\n', "missing required field"),
        (CUTTER + "colour = 3\n", "unknown field `colour`"),
        (CUTTER + "opening_mm = 50\n", "widen the opening"),
        (CUTTER.replace("[20, 100]", "[100, 20]"), "is not a range"),
        (CUTTER.replace("[20, 100]", "[-1, 20]"), "diameter_mm"),
        (CUTTER.replace("[20, 100]", "[20, inf]"), "is not a range"),
        (CUTTER.replace('["cylinder"]', "[]"), "at least one"),
        (CUTTER.replace('["cylinder"]', '["cylinder", "cylinder"]'), "each once"),
        (CUTTER.replace('"cutter"', '" "'), "has no name"),
        (CUTTER + "min_length_over_diameter = inf\n", "not finite"),
        (CUTTER.replace('["cylinder"]', '["brick"]'), "brick"),
        (CUTTER + CUTTER.replace("[cutter]", "[other]"), "two tools have the name"),
    ],
)
def test_tables_that_contradict_themselves(tmp_path, text, says):
    file = tmp_path / "tools.toml"
    file.write_text(text)
    with pytest.raises(ToolTableError, match=says) as caught:
        read_tools(file)
    assert str(file) in str(caught.value)


def test_missing_table(tmp_path):
    with pytest.raises(ToolTableError, match="cannot be read"):
        read_tools(tmp_path / "none.toml")

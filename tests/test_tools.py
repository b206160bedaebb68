"""Which tool fits: table 1 of the paper, and what doubts matter to it."""

from math import inf, radians

import msgspec
import numpy as np
import pytest

from rotrecon.clearance import clearances
from rotrecon.objections import STRAIGHT_RAD
from rotrecon.primitives import Frustum, Kind, Sphere
from rotrecon.reading import Reading
from rotrecon.tool_table import Tool, ToolTable, default_tools
from rotrecon.tools import WHICH_KIND, NoTool, ToolProposal, propose_tool
from tests.solids import ALONG, CAMERA_M, CENTER_M, pipe


def choice(read: tuple[Reading, ...], *tools: Tool) -> ToolProposal | NoTool:
    return propose_tool(read, CAMERA_M, False, tools)


def no_tool(read: tuple[Reading, ...], tools: ToolTable | None = None) -> NoTool:
    answer = choice(read, *(default_tools() if tools is None else tools))
    assert isinstance(answer, NoTool)
    return answer


def test_default_table_is_table_1_of_the_paper():
    ball = Sphere(CENTER_M, ALONG, 0.1)
    cases = [
        (pipe(), "mechanical cutter"),
        (pipe(0.02, kind="rod"), "clipper"),
        (pipe(kind="cone", half_angle_rad=0.2), "grip"),
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


def test_too_short_for_its_thickness_and_out_of_reach():
    tool = Tool(name="cutter", takes=("cylinder",), diameter_mm=(20, 100), min_length_over_diameter=3, reach_m=0.5)
    for solid, why in ((pipe(length_m=0.1), "3 times as long as thick"), (pipe(), "reaches 0.5 m")):
        answer = propose_tool((Reading(solid),), CAMERA_M, False, (tool,))
        assert isinstance(answer, NoTool)
        assert answer.unsure == ()
        assert why in answer.reasons[0]


def test_inside_of_a_pipe_gets_no_tool():
    assert isinstance(propose_tool((Reading(pipe()),), CAMERA_M, True, default_tools()), NoTool)


def test_camera_on_the_axis_still_gets_an_approach():
    solid = Frustum("cylinder", np.array([0, 0, 0.8]), np.array([0, 0, 1.0]), 0.3, 0.03)
    proposal = propose_tool((Reading(solid),), CAMERA_M, False, default_tools())
    assert isinstance(proposal, ToolProposal)
    assert np.linalg.norm(proposal.approach) == pytest.approx(1)


def test_a_size_across_a_limit_is_not_sure_and_says_what_would_settle_it():
    answer = no_tool((Reading(pipe(0.1605), (0.158, 0.163)),))
    assert answer.unsure == answer.reasons[:1]
    assert answer.reasons[0] == (
        "mechanical cutter: takes 15 to 160 mm, the cylinder has 158.0 to 163.0 mm: not sure; "
        "look at it from nearer, or from the side"
    )
    assert answer.reasons[1:] == (
        "clipper: does not take a cylinder: ruled out",
        "grip: does not take a cylinder: ruled out",
    )


def test_a_later_tool_that_surely_fits_is_proposed_and_the_doubt_about_an_earlier_one_told():
    small = Tool(name="small", takes=("cylinder",), diameter_mm=(10, 160))
    large = Tool(name="large", takes=("cylinder",), diameter_mm=(90, 400))
    proposal = choice((Reading(pipe(0.16), (0.158, 0.163)),), small, large)
    assert isinstance(proposal, ToolProposal)
    assert proposal.tool is large
    assert [reason.partition(":")[0] for reason in proposal.unsure] == ["small"]
    other = choice((Reading(pipe(0.3), (0.29, 0.31)),), small, large)
    assert isinstance(other, ToolProposal)
    assert other.unsure == (), "one that is ruled out is no doubt"


@pytest.mark.parametrize(("degrees", "tool"), [(1.0, "mechanical cutter"), (-1.0, "mechanical cutter"), (5.0, None)])
def test_a_slight_taper_that_cannot_be_excluded_matters_to_no_tool(degrees: float, tool: str | None):
    cylinder, cone = Reading(pipe()), Reading(pipe(kind="cone", half_angle_rad=radians(degrees)))
    for read in ((cylinder, cone), (cone, cylinder)):
        answer = choice(read, *default_tools())
        assert (answer.tool.name if isinstance(answer, ToolProposal) else None) == tool
        if isinstance(answer, NoTool):
            assert "choose its kind" in answer.reasons[0]
            assert "does not take a cone of 5.0 degrees: not sure" in answer.reasons[0]
            assert "does not take a cylinder: not sure" in answer.reasons[2]


def test_a_wire_that_may_taper_goes_to_the_clipper():
    read = (Reading(pipe(0.02, kind="rod")), Reading(pipe(0.02, kind="cone", half_angle_rad=0.01)))
    answer = choice(read, *default_tools())
    assert isinstance(answer, ToolProposal)
    assert answer.tool.name == "clipper"


def test_a_taper_across_what_tools_mind_is_not_sure_for_the_cutter_alone():
    across = (STRAIGHT_RAD[1] - 0.02, STRAIGHT_RAD[1] + 0.02)
    reading = Reading(pipe(kind="cone", half_angle_rad=STRAIGHT_RAD[1]), half_angle_rad=across)
    answer = choice((reading,), *default_tools())
    assert isinstance(answer, ToolProposal)
    assert answer.tool.name == "grip"
    assert "half angle up to 2.9 degrees, the cone has 1.7 to 4.0 degrees: not sure" in answer.unsure[0]


def test_ball_or_cone_is_gripped_either_way():
    ball = Reading(Sphere(CENTER_M, ALONG, 0.1), (0.19, 0.21))
    answer = choice((ball, Reading(pipe(0.2, kind="cone", half_angle_rad=0.2), (0.18, 0.22))), *default_tools())
    assert isinstance(answer, ToolProposal)
    assert answer.tool.name == "grip"


def test_a_ball_is_as_long_as_thick_whatever_its_size():
    ball = Reading(Sphere(CENTER_M, ALONG, 0.1), (0.19, 0.21))
    grip = Tool(name="grip", takes=("sphere",), diameter_mm=(10, 250), min_length_over_diameter=1)
    assert isinstance(choice((ball,), grip), ToolProposal)


def test_an_open_end_may_be_long_enough_but_a_closed_one_is_not():
    rod = pipe(0.02, 0.05, "rod")
    clipper = default_tools()[1:2]
    open_end, closed = (no_tool((Reading(rod, None, length),), clipper) for length in ((0.05, inf), (0.049, 0.051)))
    assert "the rod is at least 2.5 times: not sure; draw more of its length" in open_end.reasons[0]
    assert "2.5 times: ruled out" in closed.reasons[0]
    assert (len(open_end.unsure), len(closed.unsure)) == (1, 0)


def test_what_is_no_interval_or_nothing_at_all_is_the_callers_mistake():
    for interval in ((2.0, 1.0), (float("nan"), 1.0)):
        with pytest.raises(ValueError, match="not an interval"):
            Reading(pipe(), interval)
    with pytest.raises(ValueError, match="no reading"):
        propose_tool((), CAMERA_M, False, default_tools())


def test_a_class_marked_dangerous_gets_only_what_may_be_put_to_one():
    cutter, *others = default_tools()
    safe = msgspec.structs.replace(cutter, name="long cutter", dangerous_ok=True)
    marked = frozenset[Kind]({"cylinder"})
    tools = (cutter, safe, *others)
    answer = propose_tool((Reading(pipe()),), CAMERA_M, False, tools, dangerous=marked)
    assert isinstance(answer, ToolProposal)
    assert answer.tool is safe
    none = propose_tool((Reading(pipe()),), CAMERA_M, False, default_tools(), dangerous=marked)
    assert isinstance(none, NoTool)
    assert none.reasons[0] == "mechanical cutter: may not be put to a cylinder, which is marked dangerous: ruled out"
    (shown, *_) = clearances((Reading(pipe()),), np.zeros(3), False, default_tools(), marked)
    assert shown.verdict == "ruled out"


def test_what_may_be_dangerous_is_not_sure_and_says_what_settles_it():
    cutter, *_ = default_tools()
    both = msgspec.structs.replace(cutter, takes=("cylinder", "cone"))
    readings = (Reading(pipe()), Reading(pipe(kind="cone", half_angle_rad=0.2)))
    answer = propose_tool(readings, CAMERA_M, False, (both,), dangerous=frozenset({"cone"}))
    assert isinstance(answer, NoTool)
    assert answer.unsure
    assert WHICH_KIND in answer.unsure[0]

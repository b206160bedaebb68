"""Which tool fits, for all that an object may be: laws over intervals and readings."""

import re
from itertools import product
from typing import Literal, get_args

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from rotrecon.primitives import Sphere
from rotrecon.reading import Reading
from rotrecon.tool_table import Tool
from rotrecon.tools import NoTool, ToolProposal, propose_tool
from tests.solids import ALONG, CAMERA_M, CENTER_M, pipe

Simple = Literal["cylinder", "rod", "cone", "sphere"]
DIAMETERS_M, LENGTHS_M, HALF_ANGLES_RAD = (0.001, 0.4), (0.001, 1.2), (-0.2, 0.2)


def ranges(low: float, high: float) -> st.SearchStrategy[tuple[float, float]]:
    ends = st.floats(low, high)
    return st.tuples(ends, ends).map(lambda pair: (min(pair), max(pair)))


@st.composite
def readings(draw: st.DrawFn) -> Reading:
    """A solid in the middle of its intervals."""
    kind: Simple = draw(st.sampled_from(get_args(Simple)))
    diameter_m = draw(ranges(*DIAMETERS_M))
    if kind == "sphere":
        return Reading(Sphere(CENTER_M, ALONG, sum(diameter_m) / 4), diameter_m)
    length_m = draw(ranges(*LENGTHS_M))
    taper_rad = draw(ranges(*HALF_ANGLES_RAD)) if kind == "cone" else None
    middle_rad = 0.0 if taper_rad is None else sum(taper_rad) / 2
    return Reading(pipe(sum(diameter_m) / 2, sum(length_m) / 2, kind, middle_rad), diameter_m, length_m, taper_rad)


@st.composite
def some_tools(draw: st.DrawFn) -> Tool:
    """One tool; what it takes and its limits are any."""
    takes: set[Simple] = draw(st.sets(st.sampled_from(get_args(Simple)), min_size=1))
    limits_mm = draw(ranges(1, 400))
    return Tool(
        name=draw(st.text("abcdef", min_size=8, max_size=8)),
        takes=tuple(sorted(takes)),
        diameter_mm=limits_mm,
        min_length_over_diameter=draw(st.floats(0, 10)),
        reach_m=draw(st.none() | st.floats(0.5, 1.0)),
    )


def choice(read: tuple[Reading, ...], *tools: Tool) -> ToolProposal | NoTool:
    return propose_tool(read, CAMERA_M, False, tools)


def fits(tool: Tool, *read: Reading) -> bool:
    return isinstance(choice(read, tool), ToolProposal)


def points_in(reading: Reading, shares: tuple[float, ...]) -> list[Reading]:
    """Points of a reading's intervals as readings of their own, at the same contact; shares run from 0 to 1."""

    def at(interval: tuple[float, float] | None) -> list[tuple[float, float] | None]:
        if interval is None:
            return [None]
        low, high = interval
        return [(value, value) for value in ((1 - share) * low + share * high for share in shares)]

    boxes = product(at(reading.diameter_m), at(reading.length_m), at(reading.half_angle_rad))
    return [Reading(reading.solid, *box) for box in boxes]


@given(some_tools(), readings())
def test_a_tool_fits_an_interval_when_it_fits_all_of_it(tool: Tool, reading: Reading) -> None:
    assert fits(tool, reading) == all(fits(tool, corner) for corner in points_in(reading, (0.0, 1.0)))


@given(some_tools(), readings())
def test_a_tool_is_ruled_out_only_where_it_fits_nothing_of_the_interval(tool: Tool, reading: Reading) -> None:
    answer = choice((reading,), tool)
    assume(isinstance(answer, NoTool))
    assert isinstance(answer, NoTool)
    assert ("not sure" if answer.unsure else "ruled out") in answer.reasons[0]
    assert all(re.search(r": not sure; \w+ \w+ ", why) for why in answer.unsure), "what would settle it is said"
    if not answer.unsure:
        assert not any(fits(tool, point) for point in points_in(reading, (0.0, 0.3, 0.6, 1.0)))


@given(some_tools(), readings(), st.floats(0, 1), st.floats(0, 1))
def test_a_wider_interval_never_makes_a_tool_fit(tool: Tool, reading: Reading, down: float, up: float) -> None:
    def wider(interval: tuple[float, float] | None, limits: tuple[float, float]) -> tuple[float, float] | None:
        if interval is None:
            return None
        return interval[0] + down * (limits[0] - interval[0]), interval[1] + up * (limits[1] - interval[1])

    wide = Reading(
        reading.solid,
        wider(reading.diameter_m, DIAMETERS_M),
        wider(reading.length_m, (LENGTHS_M[0], 2.0)),
        wider(reading.half_angle_rad, HALF_ANGLES_RAD),
    )
    assert fits(tool, reading) or not fits(tool, wide)


@given(some_tools(), st.lists(readings(), min_size=1, max_size=3), readings())
def test_one_more_reading_never_makes_a_tool_fit(tool: Tool, known: list[Reading], more: Reading) -> None:
    assert fits(tool, *known) or not fits(tool, *known, more)
    assert fits(tool, *known, known[0]) == fits(tool, *known)


@given(some_tools(), readings())
def test_an_interval_within_the_limits_says_what_the_number_says(tool: Tool, reading: Reading) -> None:
    number, interval = choice((Reading(reading.solid),), tool), choice((reading,), tool)
    assume(not (isinstance(interval, NoTool) and interval.unsure))
    assert isinstance(number, ToolProposal) == isinstance(interval, ToolProposal)
    if isinstance(number, ToolProposal) and isinstance(interval, ToolProposal):
        assert np.array_equal(number.contact_point_m, interval.contact_point_m)


@given(st.lists(some_tools(), max_size=4), st.lists(readings(), min_size=1, max_size=2))
def test_the_first_tool_that_fits_is_proposed_and_otherwise_each_has_its_reason(
    tools: list[Tool], read: list[Reading]
) -> None:
    answer = choice(tuple(read), *tools)
    alone = [tool for tool in tools if fits(tool, *read)]
    if isinstance(answer, ToolProposal):
        assert answer.tool is alone[0]
        assert len(answer.unsure) < tools.index(answer.tool) + 1
    else:
        assert alone == []
        assert len(answer.reasons) == len(tools)

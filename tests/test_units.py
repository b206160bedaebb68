"""Laws of inches: every length that a text says in mm is said in inches, as exactly, and nothing else is touched."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.events import Reconstructed
from app.object_drawing import ObjectDrawing
from app.result_text import result_html, why_html
from app.session import Session, step
from app.showing import in_session_unit
from app.stage_chart import STAGE_AXES, stage_scales
from app.tool_text import next_view_html, place_html, tools_html
from app.units import MM_PER, decimals_of, from_mm, in_unit, labels_in, scales_in, to_mm
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate

numbers = st.decimals(0, 5000, places=2).map(str) | st.integers(0, 3000).map(str)


@given(numbers, numbers)
def test_lengths_are_the_same_in_inches_to_the_last_digit_that_was_said(first: str, second: str) -> None:
    shapes = (
        "{} ± {} mm",
        "{} to {} mm",
        "between {} and {} mm",
        "{} &plusmn; {} mm",
        "{} mm, then {} mm",
        "{} mm/{} mm",
    )
    for shape in shapes:
        said = in_unit(shape.format(first, second), "inch")
        assert "mm" not in said
        found = [float(number) for number in re.findall(r"\d+\.\d+", said)]
        for number, digits in zip(found, (first, second), strict=True):
            last = 10.0 ** -len(digits.partition(".")[2])
            assert abs(25.4 * number - float(digits)) < last / 5


@pytest.mark.parametrize(
    "text",
    ["15 sections and 3 px", "2 m away", "0.5 degrees", "diameter_mm", 'data-value="12.345"', "mm along the axis"],
)
def test_what_is_no_length_in_mm_stays(text: str) -> None:
    assert in_unit(text, "inch") == text


def test_names_stay_as_they_are() -> None:
    text = "the 5 mm bit takes 4 to 6 mm"
    assert in_unit(text, "inch", ["5 mm bit", ""]) == "the 5 mm bit takes 0.16 to 0.24 inch"
    assert in_unit(text, "mm", ["5 mm bit"]) == text


@given(st.integers(-90000, 90000))
def test_what_is_typed_in_inches_comes_back(ten_thousandths: int) -> None:
    typed = ten_thousandths / 1e4
    assert from_mm(to_mm(typed, "inch"), "inch") == typed
    assert to_mm(typed, "mm") == from_mm(typed, "mm") == typed


def test_inputs_have_digits_for_their_steps() -> None:
    assert [decimals_of(step, "mm") for step in (0.1, 1, 5, 0.05)] == [1, 0, 0, 2]
    assert decimals_of(5, "inch") == 4


def test_charts_say_and_scale_lengths_only() -> None:
    assert [axis.get("label") for axis in labels_in(STAGE_AXES, "inch")] == [None, "depth, inch"]
    assert labels_in(STAGE_AXES, "mm") == STAGE_AXES
    scales = stage_scales(None) | {"y": {"range": (25.4, 50.8)}}
    scaled = scales_in(scales, ("y",), "inch")
    assert np.allclose(scaled["y"]["range"], (1.0, 2.0))
    assert scaled["x"] == scales["x"]


def test_nothing_that_is_said_of_a_result_is_left_in_mm() -> None:
    scene = simulate("leg", 0)
    result = reconstruct(scene.frame, scene.drawing, Settings())
    session = Session((640, 480), (ObjectDrawing(scene.drawing.area, scene.drawing.axis),), unit="inch")
    session = step(session, Reconstructed(0, result))
    texts = [result_html(session), why_html(session), tools_html(result), place_html(result), next_view_html(result)]
    assert sum(len(re.findall(r"\d mm\b", text)) for text in texts) > 10
    for text in texts:
        shown = re.sub(r"<[^>]*>", "", in_session_unit(text, session))
        assert not re.search(r"\bmm\b", shown), shown
    said = re.search(r"(\d+\.\d+) ± ", in_session_unit(texts[0], session))
    diameter = re.search(r'data-field="diameter_mm" data-value="([\d.]+)"', texts[0])
    assert said is not None
    assert diameter is not None
    assert abs(MM_PER["inch"] * float(said.group(1)) - float(diameter.group(1))) < 0.1

"""What is known is shown with its interval, what is not certain is said, and what is null is left out."""

import re
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app import charts, result_text
from app.answers import answer_of
from app.describe import describe
from app.events import Reconstructed
from app.object_drawing import ObjectDrawing
from app.session import Session, step
from app.wording import certainty, decimals_for, from_to, measured, plus_minus
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate
from rotrecon.tools import NoTool, ToolProposal
from tests.sure_answers import sure_answer

NOT_CERTAIN = "not certain: cylinder or cone of 1.2°"


@pytest.fixture(scope="module")
def result() -> Reconstruction:
    scene = simulate("pipe", 0, noise=None)
    return reconstruct(scene.frame, scene.drawing, Settings(method="paper"))


@pytest.fixture(scope="module")
def session(result: Reconstruction) -> Session:
    camera = result.frame.camera
    drawn = ObjectDrawing(result.drawing.area, result.drawing.axis)
    return step(Session((camera.width, camera.height), (drawn,)), Reconstructed(0, result))


@pytest.mark.parametrize(
    ("value", "interval", "text"),
    [
        (66.8, None, "66.8 mm"),
        (66.8, [65.9, 67.7], "66.8 ± 0.9 mm"),
        (66.83, [66.79, 66.87], "66.83 ± 0.04 mm"),
        (66.8, [66.8, 66.8], "66.8 ± 0.0 mm"),
        (66.8, [60.0, 67.7], "66.8 mm"),
    ],
)
def test_a_number_is_shown_with_its_interval(value: float, interval: list[float] | None, text: str) -> None:
    assert measured(value, interval, " mm") == text


@given(st.floats(1, 1000), st.floats(0, 50), st.floats(0, 50))
def test_what_is_shown_holds_the_interval_to_the_last_digit(value: float, below: float, above: float) -> None:
    interval = [value - below, value + above]
    digit = 10.0 ** -decimals_for(interval, 1)
    low, high = map(float, re.findall(r"-?[\d.]+", from_to(interval, " mm")))
    assert abs(low - interval[0]) <= digit
    assert abs(high - interval[1]) <= digit
    off = plus_minus(value, interval)
    if off is not None:
        assert value - off <= interval[0] + 1e-9
        assert value + off >= interval[1] - 1e-9
        assert digit <= 0.1
        assert off == 0 or digit <= 2 * off or digit == pytest.approx(0.001)


def test_intervals_at_the_terminal(result: Reconstruction) -> None:
    text = describe(sure_answer(result))
    lines = text.splitlines()
    assert lines[0] == "cylinder, 66.8 ± 0.9 mm in diameter (95 %: 65.9 to 67.7 mm)"
    assert lines[1:3] == ["  certain", "  112 ± 2 mm long"]
    assert "axis known within: 0.3 degrees" in text
    assert "depth errs by: 0.60 mm, 0.15 px" in text
    assert "this noise is: estimated from the frame" in text
    assert "cone of 1.2° 66.8 ± 0.9 mm (score 0.33), sphere 66.8 ± 0.9 mm (score 0.33, excluded)" in text
    open_end = {"start": "closed", "end": "open"}
    assert "at least 112 mm long: beyond the area at its end" in describe(sure_answer(result, ends=open_end))
    cone = sure_answer(result, half_angle_deg=6.9, half_angle_interval_deg=[6.5, 7.3])
    assert "half angle 6.9 ± 0.4 degrees" in describe(cone)


def test_doubts_about_the_kind_name_the_kinds(result: Reconstruction) -> None:
    assert certainty(sure_answer(result)) == "certain"
    assert certainty(sure_answer(result, certain=False)) == NOT_CERTAIN
    alone = sure_answer(result, certain=False, candidates=[])
    assert certainty(alone | {"tool": None}) == "not certain"
    assert certainty(alone) == "not certain: the interval is wide"
    assert "anything round" in certainty(alone | {"kind": "revolution"})
    assert "the paper's method has no measure" in certainty(answer_of(result))


def test_nothing_is_shown_of_what_is_not_known(result: Reconstruction, session: Session) -> None:
    html = result_text.result_html(session) + result_text.why_html(session)
    shown = describe(answer_of(result)) + re.sub(r'title="[^"]*"', "", html)
    assert "None" not in shown
    assert "95 %" not in shown
    assert "known" not in shown
    assert "±" not in shown


def test_intervals_on_the_page(result: Reconstruction, session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(result_text, "answer_of", sure_answer)
    html = result_text.result_html(session)
    assert "&oslash; 66.8 ± 0.9 mm</div>" in html
    assert "65.9 to 67.7 mm (95 %)" in html
    assert 'class="rr-sure" data-field="certain" data-value="true">certain<' in html
    assert ">112 ± 2 mm<" in html
    why = result_text.why_html(session)
    assert ">(margin 4.2)<" in why
    assert "<td>standard error of the radius</td><td>0.69 %</td>" in why
    unsure = {"certain": False, "ends": {"start": "open", "end": "closed"}}
    monkeypatch.setattr(result_text, "answer_of", lambda result: sure_answer(result, **unsure))
    html = result_text.result_html(session)
    assert f'class="rr-unsure" data-field="certain" data-value="false">{NOT_CERTAIN}<' in html
    assert ">&ge; 112 mm<" in html


def test_a_tool_that_is_not_sure_is_said_in_amber_with_what_settles_it(
    result: Reconstruction, session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Session, "proposal_told", True)
    doubt = "cutter: takes 15 to 160 mm, the cylinder has 158.0 to 163.0 mm: not sure; look at it from nearer"
    unsure = replace(result, tool=NoTool(("saw: does not take a cylinder: ruled out", doubt), (doubt,)))
    session = step(session, Reconstructed(session.revision, unsure))
    assert "rr-amber" in result_text.hint_html(session)
    assert "look at it from nearer." in result_text.hint_html(session)
    assert "<b>No tool</b> &ndash; not sure, see" in result_text.result_html(session)
    assert isinstance(result.tool, ToolProposal)
    passed_over = replace(result, tool=replace(result.tool, unsure=(doubt,)))
    session = step(session, Reconstructed(session.revision, passed_over))
    assert "rr-amber" not in result_text.hint_html(session), "the tool that is named fits either way"
    assert doubt in result_text.why_html(session)
    assert doubt in describe(answer_of(passed_over))


def test_the_chart_has_a_band_where_the_profile_has_an_interval(
    result: Reconstruction, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(charts, "radius_chart", charts.radius_chart.__wrapped__)
    without = charts.radius_chart(result, 0)
    monkeypatch.setattr(charts, "answer_of", sure_answer)
    along, high, low, fitted, *_ = chart = charts.radius_chart(result, 0)
    assert all(len(column) == len(along) for column in chart)
    assert (high - low) == pytest.approx(3)
    assert ((low < fitted) & (fitted < high)).all()
    assert not (without[1] > 0).any()
    assert not (without[2] > 0).any()
    bottom, top = charts.radius_scales(chart)["y"]["range"]
    assert bottom < low.min() < high.max() < top

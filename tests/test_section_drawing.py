"""One section in words: what each step of the segmentation did on its line of pixels."""

import re
from dataclasses import replace

import pytest

from app.charts import section_count
from app.inspection import line_in
from app.section_drawing import line_text, section_svg, section_text
from app.stage_chart import stage_text
from rotrecon.outcome import FailureReason, FitFailure
from rotrecon.overlay import first_cut_line
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate

REFUSAL = FitFailure(FailureReason.NOT_ROUND, "draw anew")


@pytest.fixture(scope="module", params=["robust", "paper"])
def result(request: pytest.FixtureRequest) -> Reconstruction:
    scene = simulate("pipe", 0, noise=None)
    return reconstruct(scene.frame, scene.drawing, Settings(method=request.param))


def test_the_line_of_a_section_says_what_each_step_did(result: Reconstruction) -> None:
    row = first_cut_line(result, 20)
    assert row is not None
    text = line_text(result, 20)
    for step, count in result.segmentation.counts(row).items():
        assert f"{count} {step.replace('with', 'with usable')}" in text or not count
    assert f"mean depth {1000 * result.segmentation.mean_m[-1, row]:.1f} mm" in text
    assert f"sigma {1000 * result.segmentation.sigma_m[-1, row]:.1f} mm" in text


def test_what_each_step_did_adds_up_to_what_is_kept(result: Reconstruction) -> None:
    for section in range(0, section_count(result), 7):
        line = line_in(result, section)
        if line is None:
            continue
        assert total(line_text(result, section)) == line.stages[-1].members.sum()
        before = line.stages[0].members.sum()
        for step, stage in enumerate(line.stages):
            text = stage_text(line, step)
            assert total(text) == stage.members.sum()
            assert re.search(rf": {before} ", text)
            before = stage.members.sum()


def total(text: str) -> int:
    """Of the sum that a text is, which has to be what it says."""
    terms = re.findall(r"(?:: |([+\u2212]) )(\d+) ", text)
    number = sum(-int(count) if sign == "\u2212" else int(count) for sign, count in terms)
    said = re.search(r"= (\d+) ", text)
    assert said is None or int(said.group(1)) == number
    return number


def test_a_refusal_has_sections_to_look_at(result: Reconstruction) -> None:
    refused = replace(result, fit=REFUSAL)
    assert "Radius" in section_text(refused, 20)
    assert "<svg" in section_svg(refused, 20)
    assert line_text(refused, 20) == line_text(result, 20)


def test_where_there_is_no_second_cut_it_says_why(result: Reconstruction) -> None:
    assert section_text(None, 0) == "No sections yet."
    refused = replace(result, fit=REFUSAL, sections=None, second_cut=None)
    by_paper = result.settings.method == "paper"
    assert ("no axis" if by_paper else "nothing round") in section_text(refused, 0)
    assert section_svg(refused, 0) == line_text(refused, 0) == line_text(None, 0) == ""


def test_a_section_has_its_circle_and_the_three_points_only_where_it_goes_through_them(result: Reconstruction) -> None:
    text = section_text(result, 20)
    assert "used. Radius 50.0" in text
    assert "0.0" in text.split("lie")[1], "exact depth lies on it"
    svg = section_svg(result, 20)
    assert svg.count("<text") == (3 if result.settings.method == "paper" else 0)
    assert 'r="50.0' in svg

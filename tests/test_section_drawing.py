"""One section in words: what each step of the segmentation did on its line of pixels."""

from dataclasses import replace

import pytest

from app.section_drawing import line_text, section_svg, section_text
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
        assert f"{count} {step}" in text
    assert f"mean depth {1000 * result.segmentation.mean_m[-1, row]:.1f} mm" in text
    assert f"sigma {1000 * result.segmentation.sigma_m[-1, row]:.1f} mm" in text


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

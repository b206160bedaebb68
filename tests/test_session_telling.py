"""What a session tells: notices, hints, and what becomes of a measurement."""

from dataclasses import replace
from html import escape

import pytest

from app.events import (
    Cleared,
    HandleMoved,
    Reconstructed,
    Refused,
    SectionsRestored,
    SectionToggled,
    ToolChosen,
    Undone,
)
from app.hints import hint
from app.object_drawing import ObjectDrawing
from app.result_text import hint_html, result_html, why_html
from app.session import Session, sentence, step
from rotrecon.drawing import ObjectAxis
from rotrecon.outcome import Fit
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate
from rotrecon.tools import NoTool
from tests.test_session import AREA, AXIS, EMPTY, after


@pytest.fixture(scope="module")
def measured() -> tuple[Session, Reconstruction]:
    scene = simulate("pipe", 0, noise=None)
    drawn = ObjectDrawing(scene.drawing.area, scene.drawing.axis)
    session = replace(EMPTY, objects=(drawn,))
    result = reconstruct(scene.frame, scene.drawing, Settings())
    return after(Reconstructed(session.revision, result), session=session), result


def test_a_refusal_is_told_once_a_revision_and_not_during_a_drag() -> None:
    dragging = after(AREA, replace(AXIS, finished=False))
    dragging = step(dragging, Reconstructed(dragging.revision, Refused("the axis has no length")))
    assert dragging.notice is None
    released = step(dragging, AXIS)
    assert released.notice is not None
    assert released.notice.text == "The axis has no length."
    again = step(released, Reconstructed(released.revision, Refused("the axis has no length")))
    assert again.notice == released.notice


def test_a_notice_goes_with_the_drawing_it_is_about() -> None:
    session = after(AREA, AXIS)
    session = step(session, Reconstructed(session.revision, Refused("the axis has no length")))
    told = session.notice
    assert told is not None
    assert step(session, ToolChosen("axis")).notice is told
    moved = step(session, HandleMoved("axis", 1, (160.0, 250.0)))
    assert moved.notice is None
    again = step(moved, Reconstructed(moved.revision, Refused("the axis has no length"))).notice
    assert again is not None
    assert again != told, "it is told once more"
    assert step(session, Undone()).notice is None


def test_the_hint_tells_of_a_measurement_only_when_it_is_one_of_the_drawing_shown(
    measured: tuple[Session, Reconstruction],
) -> None:
    assert "Measured." in hint(measured[0])
    assert hint(after(AREA, AXIS)).startswith("Measuring")
    refused = after(AREA, AXIS)
    refused = step(refused, Reconstructed(refused.revision, Refused("the axis has no length")))
    assert hint(refused) == "The axis has no length."
    assert hint(step(refused, HandleMoved("axis", 1, (160.0, 250.0)))).startswith("Measuring")
    dragged = HandleMoved("axis", 1, (160.0, 250.0), finished=False)
    assert hint(step(refused, dragged)) == hint(step(measured[0], dragged)), "it does not flicker during a drag"


def test_the_hint_tells_of_an_axis_that_was_put_right(measured: tuple[Session, Reconstruction]) -> None:
    session, result = measured
    longer = replace(result, drawing=replace(result.drawing, axis=ObjectAxis((1.0, 2.0), (300.0, 200.0))))
    assert "the object's own axis" in hint(step(session, Reconstructed(session.revision, longer)))
    assert "the object's own axis" not in hint(session)


def test_thin_evidence_and_refusals_are_said_in_amber(measured: tuple[Session, Reconstruction]) -> None:
    good, result = measured
    assert "rr-amber" not in hint_html(good)
    assert "doubtful" not in result_html(good)
    assert "Candidates, by score" in why_html(good)
    assert isinstance(result.fit, Fit)
    doubts = ("doubtful: only 3 of 90 sections have a circle", "doubtful: <noise>")
    thin = replace(result, fit=replace(result.fit, doubts=doubts), tool=NoTool(doubts))
    doubtful = step(good, Reconstructed(good.revision, thin))
    assert hint(doubtful) == "Doubtful: only 3 of 90 sections have a circle."
    assert "rr-amber" in hint_html(doubtful)
    assert "<b>No tool</b> &ndash; doubtful, see" in result_html(doubtful)
    assert all(escape(sentence(doubt)) in why_html(doubtful) for doubt in doubts)
    refused = step(good, Reconstructed(good.revision, Refused("the axis has no length")))
    assert "rr-amber" in hint_html(refused)
    assert "Not measured" in result_html(refused)
    assert "The axis has no length." in why_html(refused)
    assert "Nothing measured yet." in result_html(EMPTY)
    assert "rr-amber" not in hint_html(step(refused, HandleMoved("axis", 1, (300.0, 250.0))))


def test_each_method_says_how_sure_it_is_and_what_that_rests_on(measured: tuple[Session, Reconstruction]) -> None:
    session, result = measured
    by_paper = replace(session, measured=None)
    paper = reconstruct(result.frame, result.drawing, Settings(method="paper"))
    by_paper = step(by_paper, Reconstructed(by_paper.revision, paper))
    assert 'data-value="true">certain<' in result_html(session)
    assert "(95 %)" in result_html(session)
    assert "Diameter by the cut" not in why_html(session)
    assert "estimated from the frame" in why_html(session)
    assert "not certain, no interval" in result_html(by_paper)
    assert "Across the drawn axis" in why_html(by_paper)
    assert "%" not in why_html(by_paper)


def test_sections_taken_out_until_nothing_is_left_can_be_put_back_one_by_one(
    measured: tuple[Session, Reconstruction],
) -> None:
    session, result = measured
    assert result.second_cut is not None
    every = frozenset(range(len(result.second_cut.circles.state)))
    emptied = reconstruct(result.frame, replace(result.drawing, excluded_sections=every), result.settings)
    session = replace(session, objects=(replace(session.shown, excluded_sections=every),))
    session = step(session, Reconstructed(session.revision, emptied))
    assert "excluded by hand" in hint(session)
    assert "excluded by hand" in why_html(session)
    assert step(session, SectionToggled(5)).shown.excluded_sections == every - {5}


def test_a_section_is_taken_out_and_put_back_and_forgotten_with_the_drawing(
    measured: tuple[Session, Reconstruction],
) -> None:
    session, result = measured
    assert session.reconstruction is result
    out = step(session, SectionToggled(5))
    assert out.shown.excluded_sections == {5}
    assert not out.up_to_date
    back = after(Reconstructed(out.revision, result), SectionToggled(5), session=out)
    assert back.shown.excluded_sections == frozenset()
    assert step(out, SectionsRestored()).objects == session.objects
    assert step(session, SectionsRestored()) == session
    assert step(session, SectionToggled(100_000)) == session
    assert step(out, HandleMoved("axis", 0, (300.0, 200.0))).shown.excluded_sections == frozenset()


def test_clearing_takes_the_result_away() -> None:
    session = after(AREA, AXIS)
    session = step(session, Reconstructed(session.revision, Refused("no")))
    cleared = step(session, Cleared())
    assert cleared.measured is None
    assert cleared.up_to_date

"""The tour ticks itself off by what is done, in its order, and is never in the way."""

from dataclasses import replace

import pytest

from app.deciding.events import ControlTaken, PageCame
from app.deciding.states import Armed, Case, Decided, Proposed
from app.events import PointerDragged, Reconstructed
from app.hints import hint, warning
from app.page import DarkChosen, PageState, SectionChosen, TourClosed, TourStarted, ViewChosen, page_step
from app.result_text import hint_html
from app.session import Session, step
from app.tour import END, STATIONS, sentence_of, ticked, tour_html
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate
from tests.deciding.desk import ANN, OFFER

NAMES = [station.name for station in STATIONS]
TOURING = PageState(tour=0)


@pytest.fixture(scope="module")
def way() -> list[tuple[str, Session, PageState]]:
    """A session and a page, each with one more station reached."""
    scene = simulate("leg", 0)
    empty = Session((640, 480))
    controlled = step(step(empty, PageCame(0.0, ANN, "Ann")), ControlTaken(0.0, ANN))
    corners, axis = scene.drawing.area.vertices_px, scene.drawing.axis
    drawn = step(controlled, PointerDragged(axis.start_px, axis.end_px, shift=True))
    drawn = step(drawn, PointerDragged(corners[0], corners[2]))
    measured = step(drawn, Reconstructed(drawn.revision, reconstruct(scene.frame, scene.drawing, Settings())))
    looked = page_step(TOURING, SectionChosen(3), 100)
    turned = page_step(looked, ViewChosen("3D"), 100)
    case = Case(1, replace(OFFER, revision=measured.revision), ready=True)
    stages = (Armed(ANN, 0.0, 10.0), Decided("confirmed", "Ann", ANN, 120.0))
    armed, held = (
        replace(measured, decision=replace(measured.decision, case=replace(case, stage=stage))) for stage in stages
    )
    back = page_step(turned, ViewChosen("camera"), 100)
    return [
        ("", empty, TOURING),
        ("control", controlled, TOURING),
        ("area", drawn, TOURING),
        ("result", measured, TOURING),
        ("section", measured, looked),
        ("3D", measured, turned),
        ("arm", armed, back),
        ("hold", held, back),
    ]


def test_each_step_is_ticked_by_what_is_done(way: list[tuple[str, Session, PageState]]) -> None:
    assert [name for name, _, _ in way[1:]] == NAMES
    count = 0
    for number, (_, session, page) in enumerate(way):
        page = ticked(replace(page, tour=count), session, ANN)
        assert page.tour == number
        assert sentence_of(page) == (STATIONS[number].sentence if number < len(STATIONS) else END)
        assert tour_html(page).count("✓") == number
        count = number


def test_what_is_done_before_its_turn_is_ticked_when_that_comes(way: list[tuple[str, Session, PageState]]) -> None:
    _, session, page = way[5]
    assert ticked(replace(page, tour=0), session, ANN).tour == 5
    assert ticked(replace(page, tour=0), session, ANN + 1).tour == 0, "another page is in control"


def test_what_was_ticked_stays_so(way: list[tuple[str, Session, PageState]]) -> None:
    _, empty, page = way[0]
    assert ticked(replace(page, tour=4), empty, ANN).tour == 4
    again = replace(way[6][1].decision.case, stage=Proposed())  # type: ignore[type-var]
    session = replace(way[6][1], decision=replace(way[6][1].decision, case=again))
    assert "arm again" in (sentence_of(ticked(replace(page, tour=6), session, ANN)) or "")


def test_it_is_closed_and_started_again() -> None:
    closed = page_step(replace(TOURING, tour=3, section=5), TourClosed(), 0)
    assert (closed.tour, sentence_of(closed), tour_html(closed)) == (None, None, "")
    assert ticked(closed, Session((640, 480)), ANN) == closed
    started = page_step(closed, TourStarted(), 0)
    assert (started.tour, started.section) == (0, None)
    assert page_step(started, DarkChosen(False), 0).tour == 0


def test_what_is_wrong_comes_first_and_what_is_being_drawn_is_said(way: list[tuple[str, Session, PageState]]) -> None:
    for number, (_, session, _) in enumerate(way[1:], 1):
        led = STATIONS[number].sentence if number < len(STATIONS) else END
        said = hint_html(session, led)
        if warning(session) is None and session.up_to_date:
            assert led in said
            assert "rr-amber" not in said
    session = step(way[1][1], PointerDragged((10.0, 10.0), (200.0, 300.0), finished=False))
    assert hint(session, "led") == hint(session)
    assert hint(way[2][1], "led").startswith("Measuring")

"""Who is in control, by the rules: one at a time, and never one that has left or does not answer."""

from app.deciding.events import (
    ClockTicked,
    ControlAsked,
    ControlGiven,
    ControlTaken,
    HandoverAnswered,
    PageCame,
    PageHeard,
    PageWent,
    PicturesSent,
)
from app.deciding.settings import DecisionSettings
from tests.deciding.desk import ANN, BOB, Table

SILENCE = DecisionSettings(silent_s=5.0)


def test_one_is_in_control_and_it_is_asked_for(table: Table) -> None:
    table.do(ControlTaken(table.now, BOB))
    assert table.deciding.control.holder == ANN
    assert "ask for it" in table.said_to(BOB)
    table.do(ControlAsked(table.now, BOB), HandoverAnswered(table.now, ANN, False))
    assert table.deciding.control.holder == ANN
    assert "keeps control" in table.said_to(BOB)
    table.do(ControlAsked(table.now, BOB), HandoverAnswered(table.now, BOB, True))
    assert table.deciding.control.holder == ANN, "the one who asks cannot answer"
    table.do(HandoverAnswered(table.now, ANN, True))
    assert table.deciding.control.holder == BOB


def test_after_a_hand_over_nothing_is_armed_before_the_pictures_are_on_the_other_page(table: Table) -> None:
    table.do(ControlAsked(table.now, BOB), HandoverAnswered(table.now, ANN, True))
    table.arm(BOB)
    assert table.state == "proposed"
    table.do(PicturesSent(table.now, ANN, table.number))
    table.arm(BOB)
    assert table.state == "proposed"
    table.do(PicturesSent(table.now, BOB, table.number))
    table.arm(BOB)
    assert table.state == "armed"


def test_whoever_does_not_answer_loses_control(table: Table) -> None:
    table.do(ControlAsked(table.now, BOB))
    table.do(ClockTicked(table.later(table.deciding.settings.answer_s - 1)))
    assert table.deciding.control.holder == ANN
    table.do(ClockTicked(table.later(1.5)))
    assert table.deciding.control.holder == BOB


def test_a_page_in_control_that_falls_silent_loses_it_and_is_told() -> None:
    table = Table(SILENCE)
    table.arm()
    table.do(PageHeard(table.later(4.0), ANN), PageHeard(table.later(4.0), BOB))
    assert table.deciding.control.holder == ANN
    assert table.state == "armed"
    table.do(ClockTicked(table.later(1.5)))
    assert table.deciding.control.holder is None, "what others say does not keep it"
    assert table.state == "proposed"
    assert table.written[-1].kind == "disarmed"
    assert "did not answer for 5 s" in table.said_to(ANN)
    table.do(PageHeard(table.now, ANN))
    assert table.deciding.control.holder is None, "a page that comes back watches"
    table.do(ControlTaken(table.later(60.0), ANN))
    assert table.deciding.control.holder == ANN, "and may take it again"


def test_control_goes_from_a_silent_page_to_the_one_that_asks() -> None:
    table = Table(SILENCE)
    table.do(PageHeard(table.later(1.0), ANN), ControlAsked(table.later(4.0), BOB), ClockTicked(table.later(1.5)))
    assert table.deciding.control.holder == BOB
    table.do(ClockTicked(table.later(4.0)))
    assert table.deciding.control.holder == BOB, "whose time begins when it gets it"


def test_what_a_silent_page_does_too_late_does_nothing() -> None:
    table = Table(SILENCE)
    table.arm()
    table.later(5.5)
    table.hold(1.3)
    assert table.state == "proposed"
    assert "confirmed" not in table.kinds


def test_control_given_back_goes_to_whoever_asked_or_to_nobody(table: Table) -> None:
    table.do(ControlGiven(table.now, BOB))
    assert table.deciding.control.holder == ANN
    table.do(ControlGiven(table.now, ANN))
    assert table.deciding.control.holder is None
    table.do(ControlTaken(table.now, ANN), ControlAsked(table.now, BOB), ControlGiven(table.now, ANN))
    assert table.deciding.control.holder == BOB


def test_control_ends_with_the_connection_and_a_page_that_comes_back_watches(table: Table) -> None:
    table.arm()
    table.do(PageWent(table.now, ANN))
    assert (table.state, table.deciding.control.holder) == ("proposed", None)
    assert table.written[-1].kind == "disarmed"
    table.do(PageCame(table.now, ANN, "Ann"))
    assert table.deciding.control.holder is None
    table.hold()
    assert table.state == "proposed"


def test_a_page_that_is_not_open_cannot_take_control(table: Table) -> None:
    table.do(ControlGiven(table.now, ANN), PageWent(table.now, BOB), ControlTaken(table.now, BOB))
    assert table.deciding.control.holder is None

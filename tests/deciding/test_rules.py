"""Each rule of the decision by itself."""

import pytest

from app.deciding.events import (
    ArmPressed,
    ClockTicked,
    HoldTicked,
    NotWritten,
    Offered,
    OverrideTyped,
    RejectPressed,
    Unmeasured,
    Voided,
    Written,
)
from app.deciding.states import Decided, obstacles
from app.deciding.step import decide
from app.record.entries import Entry
from tests.deciding.desk import ANN, BOB, OFFER, WHY, Table, offer


def test_arm_and_a_hold_of_one_second_confirm_and_the_record_has_each_step(table: Table) -> None:
    table.arm()
    assert table.state == "armed"
    table.hold()
    assert table.state == "decided"
    assert table.kinds == ["proposal", "armed", "confirmed"]
    assert {entry.digest for entry in table.written} == {OFFER.digest}
    assert table.written[-1].who == "Ann"
    assert table.written[-1].payload["tool"] == "cutter"
    assert table.written[-1].payload["frame"] == "recorded"


def test_a_hold_that_was_not_armed_confirms_nothing(table: Table) -> None:
    table.hold(5.0)
    assert table.state == "proposed"
    assert "declined" in table.kinds
    assert "Arm first" in table.said_to(ANN)


def test_a_click_is_no_hold_and_clicks_do_not_add_up(table: Table) -> None:
    table.arm()
    for _ in range(8):
        table.hold(0.0)
        table.later(0.5)
    assert table.state == "armed"


@pytest.mark.parametrize(
    ("every_s", "confirms"), [(0.1, True), (0.19, True), (0.39, False), (0.41, False), (0.6, False)]
)
def test_a_hold_needs_enough_ticks_without_a_gap(table: Table, every_s: float, confirms: bool) -> None:
    table.arm()
    table.hold(1.25, every_s=every_s)
    assert (table.state == "decided") == confirms


def test_many_ticks_at_once_are_no_second(table: Table) -> None:
    table.arm()
    table.hold(0.5, every_s=0.001)
    assert table.state == "armed"


def test_a_hold_of_two_pages_is_none(table: Table) -> None:
    table.arm()
    for count in range(40):
        table.do(HoldTicked(table.later(0.1), ANN if count % 10 < 9 else BOB, table.number))
    assert table.state in ("decided", "armed")
    assert not any(entry.who == "Bob" for entry in table.written if entry.kind == "confirmed")


def test_what_is_armed_ends_after_its_time_and_a_hold_across_the_end_counts_for_nothing(table: Table) -> None:
    table.arm()
    table.later(table.deciding.settings.arm_s - 0.5)
    table.hold()
    assert table.state == "proposed"
    assert "disarmed" in table.kinds
    assert "confirmed" not in table.kinds


def test_what_is_confirmed_ends_after_its_time_and_is_then_another_proposal(table: Table) -> None:
    table.arm()
    table.hold()
    before = table.number
    table.do(ClockTicked(table.later(table.deciding.settings.valid_s + 2)))
    assert table.state == "proposed"
    assert table.number == before + 1
    assert table.kinds[-1] == "voided"


def test_a_changed_drawing_voids_whatever_was_done(table: Table) -> None:
    for act in (lambda: None, table.arm, lambda: (table.arm(), table.hold())):
        act()
        table.do(Voided(table.now, "the drawing was changed"))
        assert table.state == "nothing"
        assert table.written[-1].kind == "voided"
        table.propose()


def test_controls_of_an_older_proposal_are_refused_and_recorded(table: Table) -> None:
    old = table.number
    table.propose(offer("digest 1"))
    table.do(ArmPressed(table.now, ANN, old))
    assert table.state == "proposed"
    assert table.written[-1].kind == "declined"
    assert "earlier proposal" in table.said_to(ANN)
    table.arm()
    table.hold(number=old)
    assert table.state == "armed"


def test_nothing_is_armed_before_its_pictures_have_been_sent(table: Table) -> None:
    table.do(Offered(table.now, offer("digest 1"), Entry("proposal", "Ann", "digest 1")))
    table.arm()
    assert table.state == "proposed"
    assert "pictures" in table.said_to(ANN)


def test_a_watcher_can_neither_arm_nor_hold_nor_reject_nor_override(table: Table) -> None:
    table.do(RejectPressed(table.now, BOB, table.number, WHY))
    table.do(OverrideTyped(table.now, BOB, table.number, "clipper", WHY))
    table.arm(BOB)
    assert table.state == "proposed"
    table.arm()
    table.hold(page=BOB)
    assert table.state == "armed"
    assert "Ann is in control" in table.said_to(BOB)
    assert {entry.who for entry in table.written if entry.kind == "declined"} == {"Bob"}


@pytest.mark.parametrize("after", ["arm", "confirm"])
def test_an_act_that_is_not_on_disk_has_not_happened(table: Table, after: str) -> None:
    table.deciding = decide(table.deciding, ArmPressed(table.now, ANN, table.number))
    if after == "confirm":
        table.deciding = decide(table.deciding, Written(table.now, 1))
        for _ in range(14):
            table.deciding = decide(table.deciding, HoldTicked(table.later(0.1), ANN, table.number))
        assert isinstance(table.deciding.case and table.deciding.case.stage, Decided)
    table.deciding = decide(table.deciding, NotWritten(table.now, "the disk is full"))
    assert table.state == "proposed"
    assert "the disk is full" in obstacles(table.deciding)[0]
    assert [entry.kind for entry in table.deciding.outbox] == ["disarmed"]
    table.deciding = decide(table.deciding, ArmPressed(table.now, ANN, table.number))
    assert table.state == "proposed"
    table.deciding = decide(table.deciding, Written(table.now, len(table.deciding.outbox)))
    table.arm()
    assert table.state == "armed"


def test_a_drawing_without_a_solid_is_recorded_and_proposes_nothing(table: Table) -> None:
    table.do(Unmeasured(table.now, Entry("refusal", "Ann", "none")))
    assert table.state == "nothing"
    assert table.kinds[-2:] == ["voided", "refusal"]
    table.do(ArmPressed(table.now, ANN, 1))
    assert table.state == "nothing"


def test_a_refusal_is_told_and_recorded_once_while_a_button_is_held(table: Table) -> None:
    table.hold(3.0)
    assert table.kinds.count("declined") == 1
    table.later(table.deciding.settings.quiet_s + 1)
    table.hold(0.0)
    assert table.kinds.count("declined") == 2


def test_a_clock_that_goes_back_confirms_nothing_early(table: Table) -> None:
    table.arm()
    for at in (200.0, 100.0, 300.0, 50.0) * 5:
        table.deciding = decide(table.deciding, HoldTicked(at, ANN, table.number))
    assert table.state == "proposed"

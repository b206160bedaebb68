"""Each rule of the decision by itself."""

import pytest

from app.deciding.events import (
    ArmPressed,
    ClassNamed,
    ClockTicked,
    ControlAsked,
    ControlGiven,
    ControlTaken,
    HandoverAnswered,
    HoldTicked,
    NotWritten,
    Offered,
    OverrideDropped,
    OverrideTyped,
    PageCame,
    PageHeard,
    PageWent,
    PicturesSent,
    RejectPressed,
    Unmeasured,
    Voided,
    Written,
)
from app.deciding.settings import DecisionSettings
from app.deciding.states import Decided, obstacles
from app.deciding.step import decide
from app.record.entries import Entry
from tests.deciding.desk import ANN, BOB, OFFER, Table, offer

WHY = "the cutter is blunt today"
SILENCE = DecisionSettings(silent_s=5.0)
DANGEROUS = DecisionSettings(dangerous=frozenset({"cylinder"}))


@pytest.fixture
def table() -> Table:
    return Table()


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


def test_a_rejection_takes_a_reason_and_is_final_until_the_drawing_changes(table: Table) -> None:
    table.do(RejectPressed(table.now, ANN, table.number, "  no  "))
    assert table.state == "proposed"
    table.do(RejectPressed(table.now, ANN, table.number, WHY))
    assert table.state == "rejected"
    assert table.written[-1].payload["reason"] == WHY
    table.arm()
    table.hold()
    assert table.state == "rejected"


def test_what_was_confirmed_can_be_withdrawn(table: Table) -> None:
    table.arm()
    table.hold()
    table.do(RejectPressed(table.now, ANN, table.number, WHY))
    assert table.state == "rejected"


def test_an_override_takes_a_typed_reason_and_the_same_two_actions(table: Table) -> None:
    for tool, reason in (("clipper", ""), ("clipper", " . . "), ("hammer", WHY), ("cutter", WHY)):
        table.do(OverrideTyped(table.now, ANN, table.number, tool, reason))
        assert table.deciding.case is not None
        assert table.deciding.case.override is None
    table.do(OverrideTyped(table.now, ANN, table.number, "clipper", WHY))
    assert table.state == "proposed"
    table.arm()
    table.hold()
    assert table.kinds[-1] == "overridden"
    assert table.written[-1].payload["tool"] == "clipper"
    assert table.written[-1].payload["override"] == WHY


def test_a_tool_with_something_in_its_way_is_armed_only_by_an_override_that_says_so() -> None:
    hit = "At the object it would hit 3 points of the cloud."
    table = Table(offer=offer("digest 0", in_the_way={"cutter": (hit,)}))
    table.arm()
    assert table.state == "proposed"
    assert table.said_to(ANN) == hit
    assert obstacles(table.deciding)[-1].startswith("Turn the approach or move the contact")
    table.do(OverrideTyped(table.now, ANN, table.number, "cutter", "   "))
    table.arm()
    assert table.state == "proposed", "without a reason it is none"
    table.do(OverrideTyped(table.now, ANN, table.number, "cutter", "that is a loose cable, it gives way"))
    table.arm()
    table.hold()
    assert table.kinds[-1] == "overridden"
    assert table.written[-1].payload["in_the_way"] == hit
    assert table.written[-1].payload["tool"] == "cutter"


def test_what_is_in_the_way_of_another_tool_blocks_nothing() -> None:
    table = Table(offer=offer("digest 0", in_the_way={"clipper": ("It would hit something.",)}))
    assert obstacles(table.deciding) == ()
    assert table.deciding.case is not None
    assert table.deciding.case.offer.choices == ("clipper", "grip")


def test_choosing_another_tool_disarms(table: Table) -> None:
    table.arm()
    table.do(OverrideTyped(table.now, ANN, table.number, "clipper", WHY))
    assert table.state == "proposed"
    table.arm()
    table.do(OverrideDropped(table.now, ANN, table.number))
    assert table.state == "proposed"


def test_without_a_tool_only_an_override_can_be_confirmed() -> None:
    table = Table(offer=offer("thin", tool=None))
    table.arm()
    table.hold()
    assert table.state == "proposed"
    table.do(OverrideTyped(table.now, ANN, table.number, "cutter", WHY))
    table.arm()
    table.hold()
    assert table.kinds[-1] == "overridden"


def test_a_dangerous_class_is_named_before_it_is_shown_and_a_disagreement_blocks() -> None:
    table = Table(DANGEROUS, offer("d", tool="grip"))
    assert table.deciding.veiled
    table.arm()
    assert table.state == "proposed"
    table.do(ClassNamed(table.now, ANN, table.number, "sphere"))
    assert not table.deciding.veiled
    table.arm()
    assert "You named a sphere" in table.said_to(ANN)
    table.do(ClassNamed(table.now, ANN, table.number, "cylinder"))
    table.arm()
    assert table.state == "proposed", "it is named once"
    table.propose(offer("d2", tool="grip"))
    table.do(ClassNamed(table.now, ANN, table.number, "cylinder"))
    table.arm()
    table.hold()
    assert table.state == "decided"
    assert table.written[-1].payload["named"] == "cylinder"


def test_a_tool_that_is_not_for_dangerous_classes_is_not_put_to_one() -> None:
    table = Table(DANGEROUS)
    table.do(ClassNamed(table.now, ANN, table.number, "cylinder"))
    table.arm()
    assert table.state == "proposed"
    assert "may not be put" in table.said_to(ANN)


def test_a_disagreement_about_harmless_classes_blocks_nothing() -> None:
    table = Table(DANGEROUS, offer("d", kind="cone"))
    table.do(ClassNamed(table.now, ANN, table.number, "sphere"))
    table.arm()
    assert table.state == "armed"


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

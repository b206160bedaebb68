"""The watch over the frame: what it finds is shown and blocks."""

from dataclasses import replace

import pytest

from app.deciding.events import ClockTicked, DecisionEvent, FrameArrived, FrameOpened, FrameReopened
from app.deciding.states import obstacles
from app.deciding.watchdog import FrameFacts
from tests.deciding.desk import ANN, BOB, FRAME, OFFER, WALL_S, Table

LIVE = FrameFacts("pixels", "live", sequence=7, captured_s=WALL_S - 1.0, every_s=1.0)


def newer(table: Table, facts: FrameFacts, changed: bool = False) -> FrameArrived:
    return FrameArrived(table.now, facts, WALL_S, changed)


def blocked(table: Table, says: str) -> None:
    assert any(says in sentence for sentence in obstacles(table.deciding)), obstacles(table.deciding)
    assert table.state == "proposed", "an armed state does not outlive it"
    table.arm()
    assert table.state == "proposed"


@pytest.mark.parametrize("facts", [FRAME, LIVE])
def test_a_frame_that_is_too_old_disarms_and_blocks(facts: FrameFacts) -> None:
    table = Table(frame=replace(facts, every_s=None))
    table.do(ClockTicked(table.later(table.deciding.settings.max_age_s - 5)))
    table.arm()
    assert table.state == "armed"
    table.do(ClockTicked(table.later(5.5)))
    blocked(table, "10 minutes old")


def test_a_live_frame_is_as_old_as_its_capture_and_a_recording_as_its_opening() -> None:
    old_s = WALL_S - 1e6
    blocked(Table(frame=FrameFacts("pixels", "live", captured_s=old_s)), "minutes old")
    table = Table(frame=FrameFacts("pixels", captured_s=old_s))
    table.arm()
    assert table.state == "armed"


def test_a_recorded_frame_is_opened_again_by_the_one_in_control_as_another_proposal() -> None:
    table = Table()
    before = table.number
    table.do(ClockTicked(table.later(1000.0)))
    table.do(FrameReopened(table.now, BOB, WALL_S))
    blocked(table, "minutes old")
    table.do(FrameReopened(table.now, ANN, WALL_S))
    assert table.number == before + 1
    assert "voided" in table.kinds
    assert not any("old" in sentence for sentence in obstacles(table.deciding))
    live = Table(frame=LIVE)
    live.do(FrameReopened(live.now, ANN, WALL_S))
    assert "take a new one" in live.said_to(ANN)


def test_a_clock_that_is_wrong_blocks() -> None:
    blocked(Table(frame=replace(LIVE, captured_s=WALL_S + 3.0)), "ahead of this machine's clock")
    table = Table(frame=replace(LIVE, captured_s=WALL_S + 1.0))
    table.arm()
    assert table.state == "armed"
    table.do(newer(table, FrameFacts("others", "live", 8, WALL_S + 60.0)))
    blocked(table, "60 s ahead")


@pytest.mark.parametrize(
    ("facts", "says"),
    [
        (FrameFacts("others", "live", 7, WALL_S), "stalled"),
        (FrameFacts("others", "live", 3, WALL_S), "stalled"),
        (FrameFacts("pixels", "live", 8, WALL_S), "identical pixels"),
    ],
)
def test_a_camera_that_stands_still_disarms_and_blocks_until_it_goes_on(facts: FrameFacts, says: str) -> None:
    table = Table(frame=LIVE)
    table.arm()
    table.do(newer(table, facts))
    blocked(table, says)
    table.do(newer(table, FrameFacts("more", "live", 9, WALL_S)))
    table.arm()
    assert table.state == "armed"


def test_a_camera_that_falls_silent_blocks() -> None:
    table = Table(frame=LIVE)
    table.do(ClockTicked(table.later(2.9)))
    table.arm()
    assert table.state == "armed"
    table.do(ClockTicked(table.later(0.2)))
    blocked(table, "stalled")


def test_a_change_in_the_area_blocks_until_the_newer_frame_is_opened() -> None:
    table = Table(frame=LIVE)
    table.arm()
    table.do(newer(table, FrameFacts("others", "live", 8, WALL_S), changed=True))
    blocked(table, "shows a change")
    opened: DecisionEvent = FrameOpened(table.now, FrameFacts("others", "live", 8, WALL_S), WALL_S)
    table.do(opened)
    assert table.state == "nothing", "another frame is other evidence"
    table.propose(replace(OFFER, digest="of the other frame"))
    table.arm()
    assert table.state == "armed"

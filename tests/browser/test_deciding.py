"""The decision, taken with a real mouse: two different actions confirm, and nothing else does."""

from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from app.clock import seconds
from app.console import Console
from app.decided import decision_of
from app.deciding.events import ArmPressed, ClockTicked
from app.deciding.settings import DecisionSettings
from app.events import Cleared
from app.record.errors import StoreError
from app.record.store import Record
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated
from tests.browser.conftest import SLOW_PAGE, opened_page
from tests.browser.operator import Operator
from tests.browser.steps import arm, button, hold, kinds, state
from tests.browser.test_page import drawing_events

WHY = "the cutter is blunt today"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("record")


@pytest.fixture(scope="module")
def shared(scene: Simulated, browser: Browser, folder: Path) -> Iterator[Operator]:
    """One page for all of these tests: opening one takes as long as five of them."""
    yield from _opened(scene, browser, folder, SLOW_PAGE)


def _opened(scene: Simulated, browser: Browser, folder: Path, deciding: DecisionSettings) -> Iterator[Operator]:
    with closing(Record.open(folder)) as record:
        console = Console(scene.frame, "A pipe", Settings(), port=0, cloud_points=10, record=record, deciding=deciding)
        console.start()
        with opened_page(browser) as page:
            yield Operator(page, console)
        console.stop()


@pytest.fixture
def proposed(shared: Operator, scene: Simulated) -> Operator:
    """The scene's object, drawn anew."""
    shared.send(Cleared(), *drawing_events(scene))
    state(shared, "proposed")
    expect(button(shared, "1. Arm")).to_be_enabled()
    return shared


def test_clicks_and_keys_confirm_nothing(proposed: Operator, folder: Path) -> None:
    arm(proposed)
    for _ in range(3):
        button(proposed, "2. Hold").click()
        proposed.settle()
    button(proposed, "2. Hold").focus()
    for key in ("Enter", "Space", "Enter"):
        proposed.page.keyboard.press(key)
        proposed.settle()
    state(proposed, "armed")
    assert "confirmed" not in kinds(folder)


def test_a_button_that_is_disabled_confirms_nothing_and_says_why(proposed: Operator) -> None:
    button(proposed, "2. Hold").get_by_text("2. Hold").hover(force=True)
    proposed.page.mouse.down()
    expect(proposed.page.get_by_text("Arm first, then hold.")).to_be_visible()
    proposed.page.mouse.up()
    state(proposed, "proposed")


def test_a_changed_drawing_voids_what_was_armed_and_what_was_confirmed(
    proposed: Operator, scene: Simulated, folder: Path
) -> None:
    arm(proposed)
    number = proposed.console.session.decision.count
    button(proposed, "Undo").click()
    proposed.until(lambda: proposed.console.session.decision.count > number, "another drawing is proposed")
    state(proposed, "proposed")
    assert kinds(folder) == ["proposal"]
    proposed.send(ArmPressed(seconds(), proposed.client_id, number))
    expect(proposed.page.get_by_text("That was for an earlier proposal")).to_be_visible()
    state(proposed, "proposed")
    assert kinds(folder)[-1] == "declined"
    arm(proposed)
    hold(proposed, "confirmed")
    start, end = scene.drawing.axis.start_px, scene.drawing.axis.end_px
    proposed.drag(start, (end[0] + 5, end[1]), shift=True)
    proposed.until(lambda: decision_of(proposed.console.told).state != "confirmed", "it is confirmed no more")


def test_an_override_and_a_rejection_take_a_typed_reason(proposed: Operator, folder: Path) -> None:
    proposed.page.get_by_text("Reject or override").click()
    button(proposed, "Override, for that reason").click()
    expect(proposed.page.get_by_text("Type the reason")).to_be_visible()
    proposed.page.get_by_text("Reason", exact=True).locator("xpath=../../..").get_by_role("textbox").fill(WHY)
    button(proposed, "Override, for that reason").click()
    expect(proposed.page.get_by_test_id("decision")).to_contain_text("override: clipper")
    arm(proposed)
    hold(proposed, "overridden")
    assert kinds(folder)[-1] == "overridden"
    assert decision_of(proposed.console.told).tool == "clipper"
    button(proposed, "Reject, for that reason").click()
    state(proposed, "rejected")
    assert decision_of(proposed.console.told).state == "rejected"


def test_a_disk_that_does_not_obey_blocks_confirming_and_says_so(
    proposed: Operator, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, folder: Path
) -> None:
    arm(proposed)

    def full(*_: object) -> None:
        raise StoreError("the disk is full")

    with monkeypatch.context() as patched:
        patched.setattr(Record, "append", full)
        hold(proposed, "proposed")
        expect(proposed.page.get_by_test_id("against")).to_contain_text("Nothing can be recorded: the disk is full")
        assert decision_of(proposed.console.told).state == "idle"
        expect(button(proposed, "1. Arm")).to_be_disabled()
    expect(button(proposed, "1. Arm")).to_be_enabled()
    assert "the disk is full" in caplog.text
    assert "confirmed" not in kinds(folder)
    arm(proposed)
    hold(proposed, "confirmed")


@pytest.fixture
def careful(scene: Simulated, browser: Browser, tmp_path: Path) -> Iterator[Operator]:
    """A page on which cylinders are dangerous."""
    yield from _opened(scene, browser, tmp_path, replace(SLOW_PAGE, dangerous=frozenset({"cylinder"})))


def test_a_dangerous_class_is_named_before_anything_of_it_is_shown(careful: Operator, scene: Simulated) -> None:
    careful.send(*drawing_events(scene))
    expect(button(careful, "Name it")).to_be_visible()
    expect(careful.page.get_by_test_id("hint")).to_contain_text("say in the Decision panel what the object is")
    expect(careful.page.locator('[data-field="kind"]')).to_have_count(0)
    expect(careful.page.get_by_test_id("decision")).not_to_contain_text("cutter")
    careful.page.get_by_label("The object is a").click()
    careful.page.get_by_role("option", name="rod").click()
    careful.settle()
    button(careful, "Name it").click()
    expect(careful.page.locator('[data-field="kind"]')).to_be_visible()
    expect(careful.page.get_by_test_id("against")).to_contain_text("You named a rod")
    expect(button(careful, "1. Arm")).to_be_disabled()


def test_an_old_frame_blocks_until_it_is_opened_again(proposed: Operator) -> None:
    """After it the decision's clock is ahead of the machine's, and stands until that has caught up."""
    proposed.send(ClockTicked(seconds() + SLOW_PAGE.max_age_s + 1))
    expect(proposed.page.get_by_test_id("against")).to_contain_text("minutes old")
    expect(button(proposed, "1. Arm")).to_be_disabled()
    button(proposed, "Open the frame again").click()
    expect(button(proposed, "1. Arm")).to_be_enabled()

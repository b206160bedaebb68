"""A whole shift through the guarded door, as people work: log in, draw, inspect, decide, look back, hand over."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from app.clock import seconds
from app.console import Console
from app.decided import decision_of
from app.deciding.events import ArmPressed, ClockTicked, ControlTaken
from app.door.door import Door
from app.door.hidden_viser import HiddenViser
from app.door.listening import listen
from app.door.people import with_person, write_people
from app.events import Cleared
from app.record.store import Record
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated
from tests.browser.conftest import SLOW_PAGE, opened_page
from tests.browser.operator import Operator
from tests.browser.steps import arm, button, hold, kinds, state
from tests.browser.test_page import drawing_events

SECRET = "ten letters or more"
UNEXPLAINED = """() => {
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), found = [];
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const ours = node.parentElement.closest('[class^="rr-"]');
        const explained = node.parentElement.closest("[data-from], .rr-help");
        if (ours && /[0-9]/.test(node.data) && !explained) found.push(node.data);
    }
    return found;
}"""
"""Numbers in the program's own texts that do not say where they come from."""


@dataclass
class Shift:
    """What everybody in it works with."""

    door: Door
    console: Console
    folder: Path
    """Of the record."""
    scene: Simulated


@pytest.fixture
def shift(scene: Simulated, tmp_path: Path) -> Iterator[Shift]:
    people = with_person({}, "Walt", "watcher", SECRET)
    write_people(tmp_path / "users.json", with_person(people, "Olga", "operator", SECRET))
    hidden = HiddenViser()
    record = Record.open(tmp_path / "record")
    console = Console(
        scene.frame,
        "A pipe",
        Settings(),
        cloud_points=10,
        open_viser=hidden.open,
        record=record,
        deciding=SLOW_PAGE,
        name_of=hidden.name_of,
    )
    console.start()
    people_file = tmp_path / "users.json"
    door = Door(
        hidden, people_file, listen("127.0.0.1", 0, people_file, None), camera_commands=console.panels.camera_commands
    )
    door.start()
    yield Shift(door, console, tmp_path / "record", scene)
    door.stop()
    console.stop()
    record.close()


@pytest.fixture
def pages(browser: Browser) -> Iterator[tuple[Page, Page]]:
    with opened_page(browser) as first, opened_page(browser) as second:
        yield first, second


def test_a_shift(shift: Shift, pages: tuple[Page, Page]) -> None:
    first, second = pages
    said: list[str] = []
    first.on("console", lambda message: said.append(message.text))
    early = Operator(first, shift.console, lambda page: page.goto(shift.door.link or ""))
    name = shift.door.name_of(early.client_id) or ""
    assert name.endswith("(local)")
    assert first.url == f"{shift.door.address}/", "nothing of the link stays in the address"
    draws_and_inspects(early, shift)
    confirms(early, shift, name)
    finds_it_and_replays_it(early)
    assert set(shift.door.guard.refused) <= {"disabled"}, "nothing of it was refused but a hold after its second"
    a_watcher_looks(second, shift)
    late = a_second_operator_asks_and_is_handed_control(second, early, shift)
    opens_it_again_and_goes_away(late, shift)
    what_is_armed_expires(early, shift)
    assert not [line for line in said if "Content Security Policy" in line]
    elsewhere_is_blocked(first)


def tab(operator: Operator, name: str) -> None:
    operator.page.get_by_role("tab", name=name, exact=True).click()


def draws_and_inspects(operator: Operator, shift: Shift) -> None:
    """With the mouse, and again as the scene has it; a section that is taken out is another measurement."""
    page, console, axis = operator.page, shift.console, shift.scene.drawing.axis
    operator.drag((60, 30), (150, 220))
    operator.drag(axis.start_px, axis.end_px, shift=True)
    operator.until(lambda: len(console.session.past) == 2, "both are drawn")
    button(operator, "Undo").click()
    operator.until(lambda: len(console.session.future) == 1, "one is undone")
    operator.send(Cleared(), *drawing_events(shift.scene))
    state(operator, "proposed")
    before = console.session.decision.count
    tab(operator, "Sections")
    button(operator, "Exclude this section").click()
    expect(page.get_by_test_id("section")).to_contain_text("excluded by hand")
    operator.until(lambda: console.session.decision.count > before, "it is proposed anew")
    tab(operator, "Tool")
    expect(page.locator('[data-tool="mechanical cutter"]')).to_have_attribute("data-verdict", "fits")
    page.get_by_label("Approach turned by, °").fill("10")
    expect(page.get_by_test_id("place")).to_contain_text("turned by 10°")
    expect(page.get_by_test_id("place")).to_have_attribute("data-clear", "true")
    operator.until(lambda: console.session.decision.count > before + 1, "and again with another contact")
    operator.settle()


def confirms(operator: Operator, shift: Shift, name: str) -> None:
    """With two actions, which are in the record and told to the robot with the place that was chosen."""
    tab(operator, "Decision")
    arm(operator)
    expect(operator.page.get_by_test_id("countdown")).to_contain_text(" s")
    assert decision_of(shift.console.told).valid_until is None
    hold(operator, "confirmed")
    assert kinds(shift.folder) == ["proposal", "armed", "confirmed"]
    told, result = decision_of(shift.console.told), shift.console.session.reconstruction
    assert (told.state, told.tool, told.who) == ("confirmed", operator.value("tool"), name)
    assert told.valid_until is not None
    assert any("recorded" in reason for reason in told.reasons)
    assert result is not None
    assert result.drawing.contact.angle_rad == pytest.approx(np.deg2rad(10))
    assert told.T_base_contact is not None
    assert np.allclose(told.T_base_contact[:3, 2], result.tool.approach)  # type: ignore[union-attr]
    expect(operator.page.get_by_test_id("decision")).to_contain_text(f"by {name}")


def finds_it_and_replays_it(operator: Operator) -> None:
    """In the history, with its report; and by then every number on the page says where it comes from."""
    page = operator.page
    tab(operator, "History")
    found = page.get_by_test_id("history").locator("[data-kind=confirmed]")
    expect(found).to_have_count(1)
    said = re.search(r"⌀ ([\d.]+)", found.inner_text())
    assert said is not None
    assert float(said[1]) == pytest.approx(float(operator.value("diameter_mm") or 0), abs=0.05)
    number = found.get_attribute("data-entry") or ""
    page.get_by_role("button", name=number, exact=True).click()
    expect(page.get_by_test_id("entry")).to_have_attribute("data-entry", number)
    button(operator, "Replay").click()
    expect(page.get_by_test_id("told")).to_have_attribute("data-same", "true")
    button(operator, "Save").click()
    expect(page.get_by_test_id("told")).to_contain_text(f"rotrecon-{number}.html is ready")
    with page.expect_download() as download:
        page.get_by_role("link", name=f"rotrecon-{number}.html").click()
    assert re.search("<h1>Confirmed</h1>", download.value.path().read_text())
    words = page.get_by_text("With the words", exact=True).locator("xpath=../../..").get_by_role("textbox")
    words.fill("nobody ever said this")
    expect(found).to_have_count(0)
    words.fill("")
    expect(found).to_have_count(1)
    expect(page.get_by_test_id("head")).to_contain_text(f"{number}:")
    assert page.evaluate(UNEXPLAINED) == []


def log_in(page: Page, shift: Shift, name: str) -> None:
    page.context.clear_cookies()
    page.goto(shift.door.address)
    page.get_by_label("Name").fill(name)
    page.get_by_label("Secret").fill(SECRET)
    page.get_by_role("button", name="Log in").click()


def a_watcher_looks(page: Page, shift: Shift) -> None:
    """And can do nothing else, whatever the page would let him."""
    watcher = Operator(page, shift.console, lambda page: log_in(page, shift, "Walt"))
    assert shift.door.name_of(watcher.client_id) == "Walt"
    before = shift.console.session
    watcher.drag((60, 30), (150, 220))
    expect(page.get_by_text("You are watching", exact=True)).to_be_visible()
    page.keyboard.press("v")
    watcher.until(lambda: watcher.view.state.view == "3D", "the watcher has the 3D view")
    now = shift.console.session
    assert replace(now, decision=replace(now.decision, now=before.decision.now)) == before
    assert set(shift.door.guard.refused) - {"disabled"} == {"only watching"}


def a_second_operator_asks_and_is_handed_control(page: Page, early: Operator, shift: Shift) -> Operator:
    """Until then what she does changes nothing, and says so; what was armed for another is not armed for her."""
    late = Operator(page, shift.console, lambda page: log_in(page, shift, "Olga"))
    early.send(Cleared(), *drawing_events(shift.scene))
    state(early, "proposed")
    tab(early, "Decision")
    arm(early)
    state(late, "armed")
    for name in ("1. Arm", "2. Hold", "Take control"):
        expect(button(late, name)).to_have_count(0)
    drawn, number = shift.console.session.objects, shift.console.session.decision.count
    late.drag((60, 30), (150, 220))
    expect(page.get_by_text("You are watching").last).to_be_visible()
    button(late, "Undo").click()
    late.send(ControlTaken(seconds(), late.client_id), ArmPressed(seconds(), late.client_id, number))
    assert shift.console.session.objects == drawn
    assert early.in_control
    state(late, "armed")
    button(late, "Ask for control").click()
    button(early, "Hand it over").click()
    late.until(lambda: late.in_control, "control is handed over")
    state(early, "proposed")
    expect(button(early, "1. Arm")).to_have_count(0)
    arm(late)
    hold(late, "confirmed")
    assert decision_of(shift.console.told).who == "Olga"
    return late


def opens_it_again_and_goes_away(late: Operator, shift: Shift) -> None:
    """An old decision is shown and proposed, never armed; whoever comes back watches, and nothing is armed."""
    page, console = late.page, shift.console
    held = console.frame
    tab(late, "History")
    listed = page.get_by_test_id("history").locator("[data-entry]")
    expect(listed).to_have_count(2)
    number = listed.last.get_attribute("data-entry") or ""
    late.settle()
    page.get_by_role("button", name=number, exact=True).click()
    expect(page.get_by_test_id("entry")).to_have_attribute("data-entry", number)
    button(late, "Open again").click()
    late.until(lambda: console.session.entry == int(number), "its frame is held")
    state(late, "proposed")
    assert console.frame is not held
    assert console.session.shown.contact.angle_rad == pytest.approx(np.deg2rad(10)), "as it was confirmed"
    expect(page.get_by_test_id("decision")).to_contain_text(f"Frame of entry {number} of the record")
    late.until(late._picture_in_place, "its picture is where it belongs")
    tab(late, "Decision")
    arm(late)
    before = late.client_id
    page.reload()
    late.until(lambda: before not in console.pages and len(console.pages) == 2, "the page is back")
    state(late, "proposed")
    assert console.session.decision.control.holder is None
    assert kinds(shift.folder)[-1] == "disarmed"
    expect(button(late, "Take control")).to_be_visible()
    expect(button(late, "1. Arm")).to_have_count(0)


def what_is_armed_expires(operator: Operator, shift: Shift) -> None:
    """Back on what was there before. The decision's clock is then ahead of the machine's, until that has caught up."""
    tab(operator, "Decision")
    button(operator, "Take control").click()
    tab(operator, "History")
    button(operator, "Back to what was open before").click()
    operator.until(lambda: shift.console.session.entry is None, "the scene is back")
    tab(operator, "Decision")
    expect(button(operator, "1. Arm")).to_be_enabled()
    arm(operator)
    operator.send(ClockTicked(seconds() + SLOW_PAGE.arm_s + 1))
    state(operator, "proposed")
    assert kinds(shift.folder)[-1] == "disarmed"


def elsewhere_is_blocked(page: Page) -> None:
    """The stock page obeys whatever server its address names, and runs what that sends: the policy stops both."""
    page.evaluate(
        """() => new Promise(blocked => {
            document.addEventListener("securitypolicyviolation", event => blocked(event.blockedURI));
            try { new WebSocket("ws://127.0.0.1:9") } catch (error) {}
        })"""
    )
    evaluated = page.evaluate(
        """() => new Promise(done => setTimeout(() => {
            try { done(eval("'it ran'")) } catch (error) { done(error.name) }
        }))"""
    )
    assert evaluated == "EvalError"

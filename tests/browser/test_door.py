"""The page through the guarded door, as people reach it."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from app.console import Console
from app.decided import decision_of
from app.door.door import Door
from app.door.hidden_viser import HiddenViser
from app.door.listening import listen
from app.door.people import with_person, write_people
from app.record.store import Record
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated
from tests.browser.conftest import SLOW_PAGE, opened_page
from tests.browser.operator import Operator
from tests.browser.test_deciding import arm, hold
from tests.browser.test_page import drawing_events

SECRET = "ten letters or more"


@pytest.fixture
def door(scene: Simulated, tmp_path: Path) -> Iterator[tuple[Door, Console]]:
    people = tmp_path / "users.json"
    write_people(people, with_person({}, "Walt", "watcher", SECRET))
    hidden = HiddenViser()
    record = Record.open(tmp_path / "record")
    console = Console(
        scene.frame,
        "A pipe",
        Settings(),
        cloud_points=500,
        open_viser=hidden.open,
        record=record,
        deciding=SLOW_PAGE,
        name_of=hidden.name_of,
    )
    console.start()
    bound = listen("127.0.0.1", 0, people, None)
    door = Door(hidden, people, bound, camera_commands=console.panels.camera_commands)
    door.start()
    yield door, console
    door.stop()
    console.stop()
    record.close()


@pytest.fixture
def pages(browser: Browser) -> Iterator[tuple[Page, Page]]:
    with opened_page(browser) as first, opened_page(browser) as second:
        yield first, second


def test_an_operator_comes_in_by_the_link_and_draws_and_a_watcher_logs_in_and_looks(
    door: tuple[Door, Console], pages: tuple[Page, Page], scene: Simulated
) -> None:
    door_, console = door
    said: list[str] = []
    page, second = pages
    page.on("console", lambda message: said.append(message.text))
    operator = Operator(page, console, lambda page: page.goto(door_.link or ""))
    assert page.url == f"{door_.address}/"
    assert (door_.name_of(operator.client_id) or "").endswith("(local)")
    axis = scene.drawing.axis
    operator.drag((60, 30), (150, 220))
    operator.drag(axis.start_px, axis.end_px, shift=True)
    operator.page.get_by_role("button", name="Undo").click()
    operator.send(*drawing_events(scene))
    assert operator.value("diameter_mm")
    assert door_.guard.refused.total() == 0, "nothing that the page itself does is refused"
    arm(operator)
    hold(operator, "confirmed")
    assert (decision_of(console.told).who or "").endswith("(local)")

    watcher = Operator(second, console, lambda page: _log_in(page, door_))
    assert door_.name_of(watcher.client_id) == "Walt"
    before = console.session
    watcher.drag((60, 30), (150, 220))
    expect(watcher.page.get_by_text("You are watching", exact=True)).to_be_visible()
    watcher.page.keyboard.press("v")
    watcher.until(lambda: watcher.view.state.view == "3D", "the watcher has the 3D view")
    now = console.session
    assert replace(now, decision=replace(now.decision, now=before.decision.now)) == before
    assert set(door_.guard.refused) - {"disabled"} == {"only watching"}, "but a hold that goes on after its second"
    assert not [line for line in said if "Content Security Policy" in line]
    _elsewhere_is_blocked(page)


def _log_in(page: Page, door: Door) -> None:
    page.goto(door.address)
    page.get_by_label("Name").fill("Walt")
    page.get_by_label("Secret").fill(SECRET)
    page.get_by_role("button", name="Log in").click()


def _elsewhere_is_blocked(page: Page) -> None:
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

"""A newcomer at the page: the tour from an empty frame to a confirmed tool, settings, inches, reading it, and touch."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, ViewportSize, expect

from app.clock import seconds
from app.console import Console
from app.decided import decision_of
from app.deciding.events import ControlGiven
from app.events import Cleared
from app.last_session import LastSessions
from app.page import DarkChosen
from app.panels import TABS
from app.record.store import Record
from app.tour import END, STATIONS
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated
from tests.browser.conftest import SLOW_PAGE, VIEWPORT
from tests.browser.operator import TIMEOUT_S, Operator
from tests.browser.steps import arm, button, hold, state
from tests.browser.test_page import drawing_events

CONTRAST = (Path(__file__).parent / "contrast.js").read_text()
BEYOND = """() => [...document.querySelectorAll("button, input, [role=tab], label")]
    .filter(one => one.checkVisibility())
    .filter(one => { const box = one.getBoundingClientRect(); return box.width && box.right > innerWidth; })
    .map(one => one.outerHTML)"""
"""What stands out of the screen on the right, where nothing can be scrolled."""
SIZES: tuple[ViewportSize, ...] = ({"width": 1280, "height": 720}, {"width": 1024, "height": 768})


@pytest.fixture(scope="module")
def newcomer(scene: Simulated, browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Operator]:
    """One page for all of these tests, in the order that a newcomer goes."""
    folder: Path = tmp_path_factory.mktemp("people")
    with closing(Record.open(folder)) as record:
        console = Console(
            scene.frame,
            "A pipe",
            Settings(),
            port=0,
            cloud_points=10,
            record=record,
            deciding=SLOW_PAGE,
            last=LastSessions(folder),
            tour=True,
        )
        console.start()
        page = browser.new_page(viewport=VIEWPORT)
        yield Operator(page, console, takes_control=False)
        page.close()
        console.stop()


def tab(operator: Operator, name: str) -> None:
    one = operator.page.get_by_role("tab", name=name)

    def chosen() -> bool:
        """Clicks until it is, as tabs may move with the screen; no frame of software WebGL is waited for."""
        one.click(force=True)
        return one.get_attribute("aria-selected") == "true"

    operator.until(chosen, f"{name} is open")


def at_station(operator: Operator, number: int) -> None:
    """Wait until the tour is there, and its sentence is what the page says."""
    tour = operator.page.get_by_test_id("tour")
    expect(tour).to_have_attribute("data-step", str(number), timeout=1000 * TIMEOUT_S)
    sentence = STATIONS[number].sentence if number < len(STATIONS) else END
    expect(operator.page.get_by_test_id("hint")).to_contain_text(sentence)


def setting(operator: Operator, label: str) -> Locator:
    """The input under what is said of a setting."""
    said = operator.page.locator(".rr-setting", has_text=label)
    return said.locator("xpath=following::input[1]")


def test_the_tour_leads_to_a_confirmed_tool(newcomer: Operator, scene: Simulated) -> None:
    at_station(newcomer, 0)
    button(newcomer, "Take control").click()
    at_station(newcomer, 1)
    newcomer.send(*drawing_events(scene))
    at_station(newcomer, 3)
    tab(newcomer, "Sections")
    slider = newcomer.page.get_by_role("slider").last
    slider.focus()
    slider.press("ArrowRight")
    at_station(newcomer, 4)
    newcomer.page.keyboard.press("v")
    newcomer.until(lambda: newcomer.view.state.tour == 5, "the 3D view is ticked off")
    newcomer.page.keyboard.press("c")
    newcomer.settle()
    at_station(newcomer, 5)
    tab(newcomer, "Decision")
    arm(newcomer)
    at_station(newcomer, 6)
    hold(newcomer, "confirmed")
    at_station(newcomer, len(STATIONS))


def test_it_is_closed_and_started_again_under_help(newcomer: Operator) -> None:
    button(newcomer, "Close the tour").click()
    expect(newcomer.page.get_by_test_id("tour")).to_have_count(0)
    tab(newcomer, "Help")
    button(newcomer, "Start the tour").click()
    at_station(newcomer, 3)


def test_a_setting_that_is_typed_voids_what_was_confirmed_and_has_a_way_back(newcomer: Operator) -> None:
    console = newcomer.console
    before = console.session
    assert decision_of(console.told).state == "confirmed"
    tab(newcomer, "Settings")
    typed = setting(newcomer, "longer than thick")
    typed.fill("12")
    typed.blur()
    newcomer.until(lambda: console.session.settings.rod_length_over_diameter == 12.0, "the setting is taken")
    newcomer.settle()
    assert console.session.up_to_date
    assert decision_of(console.told).state == "proposed"
    assert decision_of(console.told).digest != decision_of(before).digest
    button(newcomer, "Back to 8").click()
    newcomer.until(lambda: console.session.chosen == console.session.defaults, "it is the default again")
    newcomer.settle()
    assert decision_of(console.told).digest == decision_of(before).digest
    expect(button(newcomer, "Back to")).to_have_count(0)


def test_inches_stand_wherever_mm_stood_and_the_robot_is_told_the_same(newcomer: Operator) -> None:
    page, told = newcomer.page, decision_of(newcomer.console.told)
    tab(newcomer, "Settings")
    page.get_by_label("Lengths in").click()
    page.get_by_role("option", name="inch").click()
    newcomer.until(lambda: newcomer.console.session.unit == "inch", "inches are chosen")
    newcomer.settle()
    expect(setting(newcomer, "A rod is at most")).to_have_value("1.1811")
    for name in ("Decision", "Sections", "Stages", "Tool", "Picture", "Why", "Settings"):
        tab(newcomer, name)
        text = page.locator("body").inner_text()
        assert " mm" not in text.replace("mm or inch", ""), f"{name}: {text}"
    assert "inch" in (page.get_by_test_id("result").text_content() or "")
    after = decision_of(newcomer.console.told)
    assert (after.digest, after.diameter_interval_m, after.state) == (told.digest, told.diameter_interval_m, "proposed")
    tab(newcomer, "Decision")
    state(newcomer, "proposed")


def test_every_text_can_be_read_in_the_dark_and_in_the_light(newcomer: Operator) -> None:
    for dark in (False, True):
        newcomer.send(DarkChosen(dark))
        for name in TABS:
            tab(newcomer, name)
            assert newcomer.page.evaluate(CONTRAST) == [], f"{name}, {'dark' if dark else 'light'}"
    tab(newcomer, "Decision")
    arm(newcomer)
    assert newcomer.page.evaluate(CONTRAST) == []


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size['width']}x{size['height']}")
def test_every_control_can_be_reached_on_the_screens_that_are_meant(newcomer: Operator, size: ViewportSize) -> None:
    page = newcomer.page
    page.set_viewport_size(size)
    for name in TABS:
        tab(newcomer, name)
        newcomer.until(lambda: page.evaluate(BEYOND) == [], f"{name} stands within the screen")
    for name in ("3D", "Camera", "Undo", "Redo", "Clear"):
        button(newcomer, name).scroll_into_view_if_needed()
    page.set_viewport_size(VIEWPORT)
    newcomer.settle()


def test_a_finger_draws_arms_and_holds(newcomer: Operator, browser: Browser, scene: Simulated) -> None:
    newcomer.send(Cleared(), ControlGiven(seconds(), newcomer.client_id))
    context = browser.new_context(viewport=VIEWPORT, has_touch=True)
    tablet = Operator(context.new_page(), newcomer.console)
    finger = context.new_cdp_session(tablet.page)

    def touch(kind: str, *at: tuple[float, float]) -> None:
        points = [{"x": x, "y": y} for x, y in at]
        finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    corners = scene.drawing.area.vertices_px
    places = [(choose(u for u, _ in corners), choose(v for _, v in corners)) for choose in (min, max)]
    start, end = (tablet.frame_to_screen(*place) for place in places)
    touch("touchStart", start)
    for share in (0.3, 0.7, 1.0):
        touch("touchMove", (start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])))
    touch("touchEnd")
    state(tablet, "proposed")
    assert tablet.console.session.shown.proposed, "the axis is the program's"
    box = button(tablet, "Undo").bounding_box()
    assert box is not None
    assert box["height"] >= 36
    button(tablet, "1. Arm").tap()
    state(tablet, "armed")
    button(tablet, "2. Hold").scroll_into_view_if_needed()
    box = button(tablet, "2. Hold").bounding_box()
    assert box is not None
    touch("touchStart", (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2))
    state(tablet, "confirmed")
    touch("touchEnd")
    tablet.settle()
    context.close()

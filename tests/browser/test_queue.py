"""The one queue: a newer drawing overtakes, what is under way is seen to be, and nothing ends the console."""

import asyncio
import gc
from collections.abc import Callable, Iterator
from functools import reduce
from threading import Event as Gate
from time import monotonic, sleep

import pytest

import app.measurements
from app.bench.wire import WirePage
from app.clock import seconds
from app.console import Console
from app.console_items import FromPage, PageClosed, PageOpened
from app.deciding.events import ArmPressed, ControlTaken, DecisionEvent, PageCame
from app.events import Event, HandleMoved, PointerDragged, Refused
from app.hints import hint
from app.measuring import measure
from app.scene_view import FAINT_OPACITY, SOLID_OPACITY
from app.session import Session
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated

WAIT_S = 10.0
NOBODYS = -1
"""Number of a page that no browser has opened."""


class SlowMeasure:
    """Stands in for the measurement and takes as long as the test wants, which may be longer for the first."""

    def __init__(self) -> None:
        self.started, self.may_end, self.first_may_end = Gate(), Gate(), Gate()
        self.drawings: list[Drawing] = []

    def __call__(self, frame: Frame, drawing: Drawing, settings: Settings) -> Refused:
        self.drawings.append(drawing)
        number = len(self.drawings)
        self.started.set()
        assert self.may_end.wait(WAIT_S)
        assert number > 1 or self.first_may_end.wait(WAIT_S)
        return Refused(f"measured {number}")

    def end(self) -> None:
        self.may_end.set()
        self.first_may_end.set()


@pytest.fixture
def slow(monkeypatch: pytest.MonkeyPatch) -> Iterator[SlowMeasure]:
    slow = SlowMeasure()
    monkeypatch.setattr(app.measurements, "measure", slow)
    yield slow
    slow.end()


def post(console: Console, *events: Event | DecisionEvent) -> None:
    for event in (PageCame(seconds(), NOBODYS, "Ann"), ControlTaken(seconds(), NOBODYS), *events):
        console.server.get_event_loop().call_soon_threadsafe(console.post, FromPage(NOBODYS, event))


def until(condition: Callable[[], bool]) -> None:
    end = monotonic() + WAIT_S
    while not condition():
        assert monotonic() < end
        sleep(0.01)


DRAWN = (
    PointerDragged((100.0, 60.0), (100.0, 190.0), shift=True),
    PointerDragged((50.0, 50.0), (150.0, 200.0)),
)
"""The axis first: an area alone would be measured too."""


def test_the_newest_drawing_overtakes_those_between(console: Console, slow: SlowMeasure) -> None:
    post(console, *DRAWN)
    assert slow.started.wait(WAIT_S)
    post(console, *(HandleMoved("axis", 1, (100.0 + n, 190.0)) for n in range(1, 30)))
    slow.end()
    console.wait_until_idle(WAIT_S)
    assert len(slow.drawings) <= 3
    assert slow.drawings[-1].axis.end_px == (129.0, 190.0)
    assert console.session.up_to_date


def test_the_newest_drawing_does_not_wait_for_an_older_one(console: Console, slow: SlowMeasure) -> None:
    slow.may_end.set()
    post(console, *DRAWN)
    assert slow.started.wait(WAIT_S)
    post(console, HandleMoved("axis", 1, (120.0, 190.0)))
    until(lambda: console.session.up_to_date and len(slow.drawings) == 2)
    newest = console.session.measured
    slow.end()
    console.wait_until_idle(WAIT_S)
    assert console.session.measured is newest, "the older drawing's result came too late"


def test_no_more_than_two_measurements_are_under_way(console: Console, slow: SlowMeasure) -> None:
    post(console, *DRAWN)
    assert slow.started.wait(WAIT_S)
    for n in range(1, 5):
        post(console, HandleMoved("axis", 1, (100.0 + n, 190.0)))
        until(lambda: len(slow.drawings) == 2)
    sleep(0.1)
    assert len(slow.drawings) == 2
    slow.end()
    console.wait_until_idle(WAIT_S)
    assert slow.drawings[-1].axis.end_px == (104.0, 190.0)


def test_a_measurement_is_shown_while_it_lasts(
    console: Console, slow: SlowMeasure, monkeypatch: pytest.MonkeyPatch
) -> None:
    hints: list[str] = []
    show = console.panels.show

    def watch(session: Session) -> None:
        show(session)
        hints.append(hint(session))

    monkeypatch.setattr(console.panels, "show", watch)
    post(console, *DRAWN)
    until(lambda: any("Measuring" in text for text in hints))
    slow.end()
    console.wait_until_idle(WAIT_S)
    assert "Measured 1." in hints[-1]


def test_a_solid_that_a_newer_one_will_replace_is_hardly_seen_and_cannot_be_decided_on(
    console: Console, scene: Simulated, request: pytest.FixtureRequest
) -> None:
    columns, rows = zip(*scene.drawing.area.vertices_px, strict=True)
    post(console, PointerDragged((min(columns), min(rows)), (max(columns), max(rows))))
    console.wait_until_idle(WAIT_S)
    assert shown(console) == (SOLID_OPACITY, True, True)
    case = console.session.decision.case
    assert case is not None
    slow: SlowMeasure = request.getfixturevalue("slow")
    end = scene.drawing.axis.end_px
    post(console, HandleMoved("axis", 1, (end[0] + 3.0, end[1])))
    until(lambda: shown(console) == (FAINT_OPACITY, False, False))
    assert console.told.reconstruction is not None, "still that of the drawing before"
    assert console.told.decision.case is None
    post(console, ArmPressed(seconds(), NOBODYS, case.number))
    until(lambda: any("Nothing is proposed" in said.text for said in console.told.decision.said))
    slow.end()
    console.wait_until_idle(WAIT_S)


def shown(console: Console) -> tuple[float, bool, bool]:
    """How solid the solid is, and whether its points, and its axis with the tool, are there."""
    node = console.server.scene.get_handle_by_name
    return node("/world/solid").opacity, node("/world/object").visible, node("/world/marks").visible


def test_the_programs_own_mistake_is_told_and_not_the_end(
    console: Console, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("app.measuring.reconstruct", broken)
    monkeypatch.setattr(app.measurements, "measure", measure)
    post(console, *DRAWN)
    console.wait_until_idle(WAIT_S)
    assert console.session.notice is not None
    assert "its own mistake" in console.session.notice.text
    assert "ZeroDivisionError" in caplog.text


def test_closing_the_console_leaves_nothing_running(
    scene: Simulated, slow: SlowMeasure, caplog: pytest.LogCaptureFixture
) -> None:
    console = Console(scene.frame, "A pipe", Settings(), port=0, cloud_points=10)
    console.start()
    loop = console.server.get_event_loop()
    post(console, *DRAWN)
    assert slow.started.wait(WAIT_S)
    console.stop()
    assert loop.is_closed()
    assert not asyncio.all_tasks(loop)
    slow.end()
    del console, loop
    gc.collect()
    assert not caplog.records


@pytest.mark.filterwarnings("ignore:Queued a .* on a closed connection")
def test_the_console_survives_pages_that_close_while_they_are_built(
    console: Console, caplog: pytest.LogCaptureFixture
) -> None:
    for number in range(40):
        WirePage(console.address, number, console.frame).close()
    page = WirePage(console.address, 40, console.frame)
    until(lambda: set(console.pages) == set(console.server.get_clients()) == {40})
    page.close()
    until(lambda: not console.pages)
    post(console, *DRAWN)
    console.wait_until_idle(WAIT_S)
    assert console.session.up_to_date
    assert not [record for record in caplog.records if record.name.startswith("app.")]


def test_a_page_that_closes_before_it_is_built_does_not_stay(console: Console) -> None:
    page = WirePage(console.address, 0, console.frame)
    until(lambda: 0 in console.pages)
    client = console.pages[0].client

    def open_and_close() -> None:
        console.post(PageOpened(client))
        console.post(PageClosed(0))

    console.server.get_event_loop().call_soon_threadsafe(open_and_close)
    until(lambda: not console.pages)
    page.close()


@pytest.mark.parametrize("broken", ["panels.show", "_shown._scene.show", "_shown._new_view", "_take"])
def test_a_mistake_in_showing_is_logged_and_not_the_end(
    console: Console, broken: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    with monkeypatch.context() as patched:
        patched.setattr(*_place(console, broken), fail)
        page = WirePage(console.address, 0, console.frame)
        until(lambda: "ZeroDivisionError" in caplog.text)
        console.wait_until_idle(WAIT_S)
    post(console, *DRAWN)
    console.wait_until_idle(WAIT_S)
    assert console.session.up_to_date
    page.close()


def _place(console: Console, path: str) -> tuple[object, str]:
    *owners, name = path.split(".")
    return (reduce(getattr, owners, console), name)

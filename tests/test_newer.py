"""Newer frames: announced, taken by the one in control alone, held with the drawing that fits, and never armed."""

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.deciding.events import (
    ArmPressed,
    ClockTicked,
    ControlAsked,
    ControlTaken,
    FrameOpened,
    HandoverAnswered,
    Offered,
    PageCame,
    PageWent,
    PicturesSent,
)
from app.deciding.settings import DecisionSettings
from app.deciding.states import Deciding, obstacles
from app.events import ContactPlaced, Event, FrameTaken, KindChosen, PointerDragged, Reconstructed, Refused
from app.held import Held, Newer
from app.newer_frames import ENOUGH_PIXELS, facts_of, has_changed, newer_facts
from app.newer_panel import newer_line
from app.newer_steps import NewerCame, NewerEvent, NewerPrepared, NewerReady, NewerUnusable
from app.object_drawing import ObjectDrawing
from app.record.entries import Entry
from app.session import Done, Session, step
from rotrecon.camera import PinholeCamera
from rotrecon.capture import Capture
from rotrecon.contact import PROPOSED
from rotrecon.drawing import AreaOfInterest
from rotrecon.frame import Frame, View
from tests.deciding.desk import ANN, BOB, OFFER, WALL_S

K = np.array([[300.0, 0, 160.0], [0, 300.0, 120.0], [0, 0, 1]])
NOW = datetime.fromtimestamp(WALL_S, UTC)
AREA = PointerDragged((100.0, 60.0), (200.0, 180.0))
AXIS = PointerDragged((150.0, 70.0), (150.0, 170.0), shift=True)


def frame_of(width: int = 320, height: int = 240, level: int = 90, **more: object) -> Frame:
    camera = PinholeCamera(width, height, K)
    image = np.full((height, width, 3), level, np.uint8)
    return Frame(image, camera.cloud(np.ones((height, width))), camera, **more)  # type: ignore[arg-type]


def held_of(frame: Frame, name: str = "held") -> Held:
    return Held(frame, name, Capture(name, recorded=frame))


def newer_of(number: int = 1, level: int = 91, **more: object) -> Newer:
    capture = Capture(f"newer {number}", recorded=frame_of(level=level, **more))
    return Newer(number, capture, "arm", NOW, newer_facts(capture, NOW))


class Room:
    """Ann draws, Bob watches."""

    def __init__(self) -> None:
        held, self.now = held_of(frame_of()), 100.0
        self.session = Session(held.size_px, decision=Deciding(DecisionSettings()), held=held)
        self.session = step(self.session, FrameOpened(self.now, facts_of(held.frame), WALL_S))
        for event in (PageCame(self.now, ANN, "Ann"), PageCame(self.now, BOB, "Bob"), ControlTaken(self.now, ANN)):
            self.session = step(self.session, event)

    def do(self, *events: Event | NewerEvent, page: int = ANN) -> None:
        for event in events:
            by_page = not isinstance(event, NewerEvent | Reconstructed)
            self.session = step(self.session, Done(page, event) if by_page else event)

    def comes(self, newer: Newer, changed: bool = False) -> None:
        self.do(NewerCame(self.now, newer, WALL_S, changed))

    def ready(self, newer: Newer, frame: Frame | None = None) -> None:
        held = Held(frame or newer.capture.recorded or frame_of(), newer.capture.name, newer.capture)
        self.do(NewerReady(self.now, newer.number, held, WALL_S))

    def propose(self) -> None:
        self.do(Reconstructed(self.session.revision, Refused("not of interest here")))
        offer = replace(OFFER, revision=self.session.revision)
        self.session = step(self.session, Offered(self.now, offer, Entry("proposal", "Ann", offer.digest)))
        self.session = step(self.session, PicturesSent(self.now, ANN, self.session.decision.count))

    @property
    def drawn(self) -> ObjectDrawing:
        return self.session.objects[0]


def test_what_comes_is_announced_and_changes_nothing() -> None:
    room, newer = Room(), newer_of()
    room.do(AREA, AXIS)
    before = room.session
    room.comes(newer)
    now = room.session
    assert replace(now, newer=None, decision=before.decision) == before
    assert "newer 1, from arm" in newer_line(now)


def test_only_the_one_in_control_takes_it() -> None:
    room, newer = Room(), newer_of()
    room.do(FrameTaken())
    assert room.session.taking is None, "there is nothing to take"
    room.comes(newer)
    room.do(FrameTaken(), page=BOB)
    assert room.session.taking is None
    assert "in control" in room.session.decision.said[-1].text
    room.do(FrameTaken())
    assert room.session.taking is not None
    assert room.session.taking.newer is newer


def test_what_is_taken_is_held_with_the_drawing_measured_anew_and_nothing_armed() -> None:
    room, newer = Room(), newer_of()
    room.do(AREA, AXIS, KindChosen("cylinder"), ContactPlaced(10.0, 5.0))
    room.propose()
    room.session = step(room.session, ArmPressed(room.now, ANN, room.session.decision.count))
    assert room.session.decision.armed is not None
    room.comes(newer, changed=True)
    assert room.session.decision.armed is None, "what changed in the area is not confirmed"
    drawn, revision = room.drawn, room.session.revision
    room.do(FrameTaken())
    room.ready(newer)
    session = room.session
    assert session.held is not None
    assert (session.held.name, session.newer, session.taking) == ("newer 1", None, None)
    assert (session.revision, session.measured, session.past) == (revision + 1, None, ())
    assert (room.drawn.area, room.drawn.axis, room.drawn.kind) == (drawn.area, drawn.axis, drawn.kind)
    assert room.drawn.contact == PROPOSED, "it was chosen on what was measured before"
    assert session.decision.case is None
    assert session.decision.watched is not None
    assert session.decision.watched.held == newer.facts
    assert not session.decision.watched.changed


def test_a_drawing_does_not_fit_on_a_picture_of_another_size() -> None:
    room, newer = Room(), newer_of()
    room.do(AREA, AXIS, KindChosen("cone"))
    room.comes(newer)
    room.do(FrameTaken())
    room.ready(newer, frame_of(640, 480))
    assert (room.drawn.area, room.drawn.axis, room.drawn.kind) == (None, None, "cone")
    assert room.session.size_px == (640, 480)
    assert room.session.shown.complete is None


def test_a_drag_that_goes_on_over_the_change_counts_for_nothing() -> None:
    room, newer = Room(), newer_of()
    room.comes(newer)
    room.do(FrameTaken(), replace(AREA, finished=False))
    room.ready(newer)
    room.do(replace(AREA, finished=False), AREA)
    assert room.drawn.area is None
    room.do(AREA)
    assert room.drawn.area is not None


def test_control_that_changes_ends_the_taking() -> None:
    room, newer = Room(), newer_of()
    room.comes(newer)
    room.do(FrameTaken())
    for event in (ControlAsked(room.now, BOB), HandoverAnswered(room.now, ANN, True)):
        room.session = step(room.session, event)
    assert room.session.taking is None
    before = room.session
    room.ready(newer)
    assert room.session == before, "it was Ann who wanted it"
    room.do(FrameTaken(), page=BOB)
    room.session = step(room.session, PageWent(room.now, BOB))
    assert room.session.taking is None


def test_what_cannot_be_used_is_said_and_is_not_taken_again() -> None:
    room, newer = Room(), newer_of()
    room.comes(newer)
    room.do(FrameTaken(), NewerPrepared(1))
    assert room.session.taking is not None
    assert room.session.taking.matching
    room.do(NewerUnusable(1, "the poses are too close; move the camera"))
    assert room.session.taking is None
    assert "The poses are too close" in newer_line(room.session)
    room.do(FrameTaken())
    assert room.session.taking is None
    room.comes(newer_of(2))
    room.do(FrameTaken())
    assert room.session.taking is not None


def test_one_that_comes_while_another_is_taken_waits_for_its_turn() -> None:
    room, first, second = Room(), newer_of(1), newer_of(2, level=95)
    room.comes(first)
    room.do(FrameTaken())
    room.comes(second)
    room.ready(first)
    assert room.session.held is not None
    assert (room.session.held.name, room.session.newer) == ("newer 1", second)
    room.ready(first)
    assert room.session.newer is second, "it is not taken twice"


def test_a_pushed_frame_is_as_old_as_it_says_or_as_its_arrival() -> None:
    room, newer = Room(), newer_of()
    assert newer.facts.source == "live"
    assert newer.facts.captured_s == WALL_S
    old = datetime.fromtimestamp(WALL_S - 700.0, UTC)
    assert newer_of(captured_at=old).facts.captured_s == WALL_S - 700.0
    room.comes(newer_of(captured_at=old))
    room.do(FrameTaken())
    room.ready(newer_of(captured_at=old))
    assert any("minutes old: take a new one" in why for why in obstacles(room.session.decision))
    views = Capture("views", views=tuple(View(frame_of().image, frame_of().camera, np.eye(4)) for _ in range(2)))
    assert newer_facts(views, NOW).captured_s == WALL_S


@given(st.lists(st.sampled_from(["comes", "takes", "bob takes", "ready", "stale", "unusable", "asks", "later"])))
def test_whatever_happens_what_is_held_was_taken_and_nothing_is_armed(happened: list[str]) -> None:
    room, count = Room(), 0
    taken: list[Newer] = []
    for what in happened:
        held, taking = room.session.held, room.session.taking
        match what:
            case "comes":
                count += 1
                room.comes(newer_of(count))
            case "takes":
                room.do(FrameTaken())
            case "bob takes":
                room.do(FrameTaken(), page=BOB)
            case "ready" if taking is not None:
                room.ready(taking.newer)
                taken.append(taking.newer)
            case "stale":
                room.ready(newer_of(count + 7))
            case "unusable" if taking is not None:
                room.do(NewerUnusable(taking.newer.number, "no texture"))
            case "asks":
                room.session = step(room.session, ControlAsked(room.now, BOB))
            case _:
                room.now += 20.0
                room.session = step(room.session, ClockTicked(room.now))
        if room.session.held is not held:
            assert what == "ready"
            assert room.session.held is not None
            assert room.session.held.capture is taken[-1].capture
            assert room.session.decision.case is None
        holder = room.session.decision.control.holder
        assert room.session.taking is None or holder is not None


def test_a_large_area_is_compared_by_some_of_its_pixels() -> None:
    held = frame_of(1000, 800)
    other = held.image.copy()
    assert held.image[..., 0].size > ENOUGH_PIXELS
    area = AreaOfInterest.rectangle((100.0, 100.0), (180.0, 160.0))
    assert not has_changed(held, other, np.eye(4), None)
    other[100:161, 100:181] += 60
    assert has_changed(held, other, np.eye(4), area)
    assert not has_changed(held, other, np.eye(4), AreaOfInterest.rectangle((400.0, 400.0), (500.0, 500.0)))
    assert has_changed(held, np.full_like(held.image, 120), np.eye(4), None)

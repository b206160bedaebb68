"""What a newer frame makes of the session: it is announced, taken by the one in control, and then held."""

from dataclasses import dataclass, replace

from app.deciding.events import FrameArrived, FrameOpened
from app.deciding.step import decide
from app.held import Held, Newer, Taking
from app.object_drawing import ObjectDrawing, without_proposal
from app.session_state import Session
from rotrecon.contact import PROPOSED


@dataclass(frozen=True, eq=False)
class NewerCame:
    """A newer recording has arrived; it replaces one that arrived before it and was not taken."""

    at: float
    newer: Newer
    wall_s: float
    """By this machine's clock, Unix time."""
    changed: bool
    """Whether it shows something else in the area."""


@dataclass(frozen=True)
class NewerPrepared:
    """The views of the one that is being taken are prepared; the whole picture is matched next."""

    number: int


@dataclass(frozen=True, eq=False)
class NewerReady:
    """A frame was made of the one that is being taken."""

    at: float
    number: int
    held: Held
    wall_s: float


@dataclass(frozen=True)
class NewerUnusable:
    """No frame can be made of the one that is being taken."""

    number: int
    reason: str


NewerEvent = NewerCame | NewerPrepared | NewerReady | NewerUnusable


def taken(session: Session) -> Session:
    """The session that takes what has come, unless it is at that already or nothing can be made of it."""
    newer = session.newer
    if session.taking is not None or newer is None or newer.unusable is not None:
        return session
    return replace(session, taking=Taking(newer))


def with_newer(session: Session, event: NewerEvent) -> Session:
    """The session after something about newer frames; what comes of one that is no longer being taken is dropped."""
    if isinstance(event, NewerCame):
        arrived = FrameArrived(event.at, event.newer.facts, event.wall_s, event.changed)
        return replace(session, newer=event.newer, decision=decide(session.decision, arrived))
    taking = session.taking
    if taking is None or taking.newer.number != event.number:
        return session
    match event:
        case NewerPrepared():
            return replace(session, taking=replace(taking, matching=True))
        case NewerReady():
            return _holding(session, taking.newer, event)
        case NewerUnusable():
            waits = session.newer is not None and session.newer.number == event.number
            newer = replace(taking.newer, unusable=event.reason) if waits else session.newer
            return replace(session, taking=None, newer=newer)


def _holding(session: Session, newer: Newer, event: NewerReady) -> Session:
    """The session on the newer frame, with the drawing kept where it fits on it."""
    fits = event.held.size_px == session.size_px
    waiting = session.newer if session.newer is not newer else None
    objects = tuple(_kept(drawn, fits) for drawn in session.objects)
    vertices_px = session.vertices_px if fits else ()
    session = replace(session, newer=waiting, objects=objects, vertices_px=vertices_px)
    return on_frame(session, event.held, FrameOpened(event.at, newer.facts, event.wall_s))


def on_frame(session: Session, held: Held, opened: FrameOpened) -> Session:
    """The session on another frame: nothing proposed, nothing measured, nothing that can be undone."""
    return replace(
        session,
        held=held,
        taking=None,
        left=None,
        size_px=held.size_px,
        preview=None,
        drag="none" if session.drag == "none" else "cancelled",
        past=(),
        future=(),
        revision=session.revision + 1,
        measured=None,
        notice=None,
        decision=decide(session.decision, opened),
    )


def _kept(drawn: ObjectDrawing, fits: bool) -> ObjectDrawing:
    """What is drawn and known of an object, without what rested on the measurement in another frame."""
    drawn = replace(without_proposal(drawn), excluded_sections=frozenset(), contact=PROPOSED)
    return drawn if fits else replace(drawn, area=None, axis=None)

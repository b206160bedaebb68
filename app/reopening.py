"""What opening an entry of the record makes of the session: shown again and decided anew, and there is a way back."""

from dataclasses import dataclass, replace

from app.deciding.control import no_control
from app.deciding.events import FrameOpened
from app.deciding.noting import refused
from app.deciding.watchdog import FrameFacts
from app.held import Held
from app.newer_steps import on_frame
from app.object_drawing import ObjectDrawing
from app.session_state import Left, Session


@dataclass(frozen=True, eq=False)
class OpenedAgain:
    """A page opens a frame of the record with what was drawn on it."""

    at: float
    """Seconds, by the decision's clock."""
    page: int
    wall_s: float
    """Unix time."""
    facts: FrameFacts
    held: Held
    drawn: ObjectDrawing


@dataclass(frozen=True)
class BroughtBack:
    """A page goes back to the frame and the drawings that were there before an entry was opened."""

    at: float
    page: int
    wall_s: float


Reopening = OpenedAgain | BroughtBack


def with_reopened(session: Session, event: Reopening) -> Session:
    """The session on the other frame, which as a recorded one is as new as that; only for the page in control."""
    why = no_control(session.decision, event.page)
    if why is None and isinstance(event, BroughtBack) and session.left is None:
        why = "No entry of the record is open: there is nothing to go back to."
    if why is not None:
        return replace(session, decision=refused(session.decision, event.page, why))
    if isinstance(event, OpenedAgain):
        left = _left(session)
        session = replace(session, objects=(event.drawn,), selected=0, vertices_px=())
        opened = FrameOpened(event.at, event.facts, event.wall_s)
        return replace(on_frame(session, event.held, opened), left=left)
    left = session.left
    assert left is not None
    session = replace(session, objects=left.objects, selected=left.selected, vertices_px=())
    return on_frame(session, left.held, FrameOpened(event.at, left.facts, event.wall_s))


def _left(session: Session) -> Left | None:
    """What there is to go back to: from one entry to the next it stays the same."""
    watched = session.decision.watched
    if session.entry is not None or session.held is None or watched is None:
        return session.left
    return Left(session.held, watched.held, session.objects, session.selected)

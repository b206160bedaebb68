"""What opening an entry of the record again makes of the session: shown again, and decided anew."""

from dataclasses import dataclass, replace

from app.deciding.control import no_control
from app.deciding.events import FrameOpened
from app.deciding.noting import refused
from app.deciding.watchdog import FrameFacts
from app.held import Held
from app.newer_steps import on_frame
from app.object_drawing import ObjectDrawing
from app.session_state import Session


@dataclass(frozen=True, eq=False)
class OpenedAgain:
    """A page opens a recorded frame with what was drawn on it, or the one that the console was started with."""

    at: float
    """Seconds, by the decision's clock."""
    page: int
    wall_s: float
    """Unix time."""
    facts: FrameFacts
    held: Held
    drawn: ObjectDrawing


def opened_again(session: Session, event: OpenedAgain) -> Session:
    """The session on that frame, which is as new as its opening; only for the page in control."""
    why = no_control(session.decision, event.page)
    if why is not None:
        return replace(session, decision=refused(session.decision, event.page, why))
    session = replace(session, objects=(event.drawn,), selected=0, vertices_px=())
    return on_frame(session, event.held, FrameOpened(event.at, event.facts, event.wall_s))

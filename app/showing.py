"""How handles are brought up to date: only what has changed is sent, and lengths are in the unit that is shown."""

from collections.abc import Callable
from html import escape
from typing import Any, Protocol

from app.deciding.states import Rejected
from app.events import Event
from app.page import PageEvent
from app.session import Session
from app.units import Unit, decimals_of, from_mm, in_unit


class Choosing(Protocol):
    """Makes a callback that posts the event that a control's value stands for, unless `read` is false."""

    def __call__(self, event_of: Callable[[Any], Event | PageEvent | None], read: bool = True) -> Any: ...


def set_to(handle: Any, name: str, value: Any) -> None:
    """Send an attribute only when it is another one."""
    if getattr(handle, name) != value:
        setattr(handle, name, value)


def show_unit(handle: Any, unit: Unit, label: str, step_mm: float) -> None:
    """Let an input of lengths say its unit in its label, and step by what `step_mm` is in it."""
    set_to(handle, "label", label.format(unit))
    set_to(handle, "step", from_mm(step_mm, unit))
    set_to(handle, "precision", decimals_of(step_mm, unit))


def in_session_unit(text: str, session: Session) -> str:
    """HTML with its lengths in the unit that the session shows; what people have named or typed stays as it is."""
    case = session.decision.case
    typed = [tool.name for tool in session.settings.tools]
    if case is not None:
        typed += [] if case.override is None else [case.override.reason]
        typed += [case.stage.reason] if isinstance(case.stage, Rejected) else []
    return in_unit(text, session.unit, {*typed, *map(escape, typed)})

"""What a setting that is changed makes of the session."""

from dataclasses import replace
from typing import get_args

from app.adjustable import with_value
from app.deciding.noting import resettled
from app.events import SettingTyped, UnitChosen
from app.session_state import Session
from app.units import Unit


def set_to(session: Session, event: SettingTyped | UnitChosen) -> Session:
    """The session after an event; what a page could not have sent by its controls leaves it as it is."""
    if isinstance(event, UnitChosen):
        return replace(session, unit=event.unit) if event.unit in get_args(Unit) else session
    chosen = with_value(session.chosen, event.key, event.value)
    if chosen is None or chosen == session.chosen:
        return session
    if chosen.measuring == session.settings:
        return replace(session, decision=resettled(session.decision, chosen.deciding))
    return replace(session, settings=chosen.measuring, revision=session.revision + 1, notice=None)

"""The session, and the pure step(session, event) -> session that everything goes through."""

from dataclasses import dataclass, replace

from app.deciding.control import no_control
from app.deciding.events import DecisionEvent, Voided
from app.deciding.noting import refused
from app.deciding.step import decide
from app.drawing_steps import drawn_on
from app.events import DrawingEvent, Event, PageLeft, Refused, SettingTyped, UnitChosen
from app.newer_steps import NewerEvent, with_newer
from app.object_drawing import with_axis
from app.reopening import Reopening, with_reopened
from app.session_state import Measured as Measured
from app.session_state import Notice as Notice
from app.session_state import Session as Session
from app.session_state import sentence as sentence
from app.session_state import with_selected
from app.setting_steps import set_to
from rotrecon.outcome import FitFailure
from rotrecon.reconstruction import Reconstruction


@dataclass(frozen=True)
class Done:
    """Something that a page does to the drawing, which only the one in control may."""

    page: int
    event: Event


def step(session: Session, event: Event | DecisionEvent | NewerEvent | Reopening | Done) -> Session:
    """The session after an event; an event that makes no sense leaves it as it is."""
    if isinstance(event, Done):
        why = no_control(session.decision, event.page)
        if why is not None:
            return replace(session, decision=refused(session.decision, event.page, why))
        event = event.event
    if isinstance(event, DecisionEvent):
        return _decided(session, event)
    if isinstance(event, NewerEvent):
        return with_newer(session, event)
    if isinstance(event, Reopening):
        return with_reopened(session, event)
    if isinstance(event, SettingTyped | UnitChosen):
        return _bound(session, set_to(session, event))
    return _bound(session, _drawn(session, event))


def _drawn(session: Session, event: DrawingEvent) -> Session:
    after = drawn_on(session, event)
    if after.shown != session.shown:
        after = replace(after, revision=session.revision + 1, notice=None)
        if after.shown.complete is None:
            after = replace(after, measured=None)
    elif after.vertices_px != session.vertices_px:
        after = replace(after, notice=None)
    return _told(_axis_adopted(after))


def _decided(session: Session, event: DecisionEvent) -> Session:
    """The session after something about the decision.

    What a page that is no longer in control has begun has no end: a drag, and the taking of a newer frame.
    """
    after = replace(session, decision=decide(session.decision, event))
    if after.decision.control.holder == session.decision.control.holder:
        return after
    after = replace(after, taking=None)
    return _bound(after, _drawn(after, PageLeft()))


def _bound(before: Session, after: Session) -> Session:
    """The session without a proposal whose evidence has changed."""
    case = after.decision.case
    if case is None or (after.revision == case.offer.revision and after.measured is before.measured):
        return after
    what = "the drawing was changed" if after.settings is before.settings else "a setting was changed"
    return replace(after, decision=decide(after.decision, Voided(after.decision.now, what)))


def _axis_adopted(session: Session) -> Session:
    """The session with the axis proposed for an area that was drawn without one: it is undone with the area."""
    drawn, measured = session.objects[session.selected], session.measured
    if session.preview is not None or drawn.area is None or drawn.axis is not None:
        return session
    if measured is None or measured.revision != session.revision or isinstance(measured.outcome, Refused):
        return session
    objects = with_selected(session, with_axis(drawn, measured.outcome.drawing.stroke, proposed=True))
    revision = session.revision + 1
    return replace(session, objects=objects, revision=revision, measured=replace(measured, revision=revision))


def _told(session: Session) -> Session:
    """The session with a notice of a failure, once a revision and not in the middle of a drag or a polygon."""
    measured = session.measured
    if measured is None or measured.revision != session.revision or measured.coarse:
        return session
    if session.preview is not None or session.vertices_px or session.notice is not None:
        return session
    if session.shown.axis is None:
        return session  # nothing to propose an axis by, of which the hint tells: the drawing goes on
    match measured.outcome:
        case Refused(reason):
            title, text = "This drawing cannot be measured", sentence(reason)
        case Reconstruction(fit=FitFailure(advice=advice)):
            title, text = "Nothing could be fitted", sentence(advice)
        case _:
            return session
    return replace(session, notice=Notice(session.revision, title, text))

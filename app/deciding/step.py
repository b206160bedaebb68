"""The decision's one pure function: step(deciding, event) -> deciding."""

from dataclasses import replace

from app.deciding.acting import Action, acted
from app.deciding.control import answered, came, given, heard, no_control, silent, taken, unanswered, went
from app.deciding.events import (
    AreaCompared,
    ClockTicked,
    ControlAsked,
    ControlGiven,
    ControlTaken,
    DecisionEvent,
    FrameArrived,
    FrameOpened,
    FrameReopened,
    HandoverAnswered,
    NotWritten,
    Offered,
    PageCame,
    PageHeard,
    PageWent,
    PicturesSent,
    Unmeasured,
    Voided,
    Written,
)
from app.deciding.noting import PROGRAM, disarmed, noted, proposed_again, refused, voided
from app.deciding.states import Armed, Case, Decided, Deciding, Proposed, obstacles
from app.deciding.watchdog import arrived, opened
from app.record.entries import EntryKind

ACTS: tuple[EntryKind, ...] = ("armed", "confirmed", "overridden", "rejected")
"""Entries of acts, which have not happened when they are not on disk; the others are of facts."""
MOST_KEPT = 100
"""Facts that wait for a disk that does not obey: each is some 100 kB, and nothing can be decided meanwhile."""


def decide(deciding: Deciding, event: DecisionEvent) -> Deciding:
    """The decision after an event; what is over by then is over before the event counts."""
    deciding = replace(deciding, now=max(deciding.now, event.at))
    return _guarded(_applied(_guarded(_expired(silent(unanswered(deciding)))), event))


def _applied(deciding: Deciding, event: DecisionEvent) -> Deciding:
    if isinstance(event, Action):
        return acted(deciding, event)
    match event:
        case PageCame():
            return came(deciding, event)
        case PageWent():
            return went(deciding, event)
        case PageHeard():
            return heard(deciding, event)
        case ControlTaken() | ControlAsked():
            return taken(deciding, event)
        case ControlGiven():
            return given(deciding, event)
        case HandoverAnswered():
            return answered(deciding, event)
        case FrameOpened() | FrameReopened() | FrameArrived() | AreaCompared():
            return _framed(deciding, event)
        case Offered() | Unmeasured() | Voided() | PicturesSent():
            return _proposed(deciding, event)
        case Written() | NotWritten():
            return _recorded(deciding, event)
        case ClockTicked():
            return deciding


def _expired(deciding: Deciding) -> Deciding:
    """The decision without what has run out: an armed state, or a confirmation that may be acted on no more."""
    case = deciding.case
    if case is None:
        return deciding
    if isinstance(case.stage, Armed) and deciding.now > case.stage.until:
        return disarmed(deciding, "its time ran out")
    if isinstance(case.stage, Decided) and deciding.now > case.stage.until:
        return proposed_again(noted(deciding, "voided", PROGRAM, reason="its time ran out"), case)
    return deciding


def _guarded(deciding: Deciding) -> Deciding:
    """The decision with nothing armed that may not be: by another page than the one in control, or blocked."""
    armed = deciding.armed
    if armed is None:
        return deciding
    if armed.page != deciding.control.holder:
        return disarmed(deciding, "control has changed")
    against = obstacles(deciding)
    return disarmed(deciding, against[0]) if against else deciding


def _proposed(deciding: Deciding, event: Offered | Unmeasured | Voided | PicturesSent) -> Deciding:
    case = deciding.case
    match event:
        case PicturesSent():
            due = case is not None and case.number == event.number and deciding.control.holder == event.page
            return replace(deciding, case=replace(case, ready=True)) if case is not None and due else deciding
        case Voided():
            return voided(deciding, event.what)
        case Unmeasured():
            deciding = voided(deciding, "another drawing was measured")
            return replace(deciding, outbox=(*deciding.outbox, event.entry))
        case Offered():
            deciding = voided(deciding, "another drawing was measured")
            count = deciding.count + 1
            outbox = (*deciding.outbox, event.entry)
            return replace(deciding, case=Case(count, event.offer), count=count, outbox=outbox)


def _framed(deciding: Deciding, event: FrameOpened | FrameReopened | FrameArrived | AreaCompared) -> Deciding:
    watched = deciding.watched
    match event:
        case FrameOpened():
            watched = opened(event.facts, deciding.now, event.wall_s)
            return replace(voided(deciding, "another frame was opened"), watched=watched)
        case FrameReopened():
            why = no_control(deciding, event.page)
            if why is None and (watched is None or watched.held.source != "recorded"):
                why = "A live frame does not get newer by itself: take a new one."
            if why is not None or watched is None:
                return refused(deciding, event.page, why or "")
            watched = replace(opened(watched.held, deciding.now, event.wall_s), changed=watched.changed)
            return replace(_renewed(deciding, "the frame was opened again"), watched=watched)
        case FrameArrived() if watched is not None:
            watched = arrived(watched, event.facts, deciding.now, event.wall_s, event.changed)
            return replace(deciding, watched=watched)
        case AreaCompared() if watched is not None:
            return replace(deciding, watched=replace(watched, changed=event.changed))
        case FrameArrived() | AreaCompared():
            return deciding


def _renewed(deciding: Deciding, why: str) -> Deciding:
    """The decision with its evidence proposed under a new number, because something has begun anew."""
    case = deciding.case
    return deciding if case is None else proposed_again(noted(deciding, "voided", PROGRAM, reason=why), case)


def _recorded(deciding: Deciding, event: Written | NotWritten) -> Deciding:
    if isinstance(event, Written):
        return replace(deciding, outbox=deciding.outbox[event.count :], fault=None)
    undone = deciding.armed is not None or any(entry.kind in ACTS for entry in deciding.outbox)
    facts = tuple(entry for entry in deciding.outbox if entry.kind not in ACTS)
    deciding = replace(deciding, outbox=facts[-MOST_KEPT:], fault=event.why)
    case = deciding.case
    if case is None or not undone:
        return deciding
    deciding = replace(deciding, case=replace(case, stage=Proposed(), hold=None))
    return noted(deciding, "disarmed", PROGRAM, reason="the record could not be written")

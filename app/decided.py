"""What the robot's controller is told of the decision: only what is on disk."""

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta

from app.clock import seconds
from app.deciding.states import Armed, Case, Decided, Deciding, Rejected
from app.decision import Decision, contact_pose, proposal
from app.session import Session
from rotrecon.arrays import Floats
from rotrecon.contact import contact_on
from rotrecon.outcome import Fit
from rotrecon.reconstruction import Reconstruction

CHANGED = "a frame that was pushed in since shows a change in the area"
RECORDED = "this is a recorded scene: nothing of it stands in front of the arm now"


def moment(at: float) -> datetime:
    """A time of the decision's clock as one of day."""
    return datetime.now(UTC) + timedelta(seconds=at - seconds())


def decision_of(session: Session, moment: Callable[[float], datetime] = moment) -> Decision:
    """The decision on what is shown; idle where nothing is proposed, or the record cannot be written."""
    deciding, result = session.decision, session.reconstruction
    case = deciding.case
    if case is None or result is None or deciding.fault is not None:
        return Decision()
    told = proposal(result, case.offer.digest)
    told = replace(told, reasons=(*_of_frame(deciding), *_words(case), *case.in_the_way, *told.reasons))
    if case.override is not None:
        told = replace(told, T_base_contact=_contact_pose(result))
    match case.stage:
        case Armed():
            return replace(told, state="armed", tool=case.tool)
        case Decided(how=how, who=who, until=until):
            return replace(told, state=how, tool=case.tool, who=who, valid_until=moment(until))
        case Rejected(who=who):
            return replace(told, state="rejected", who=who)
        case _:
            return told


def _contact_pose(result: Reconstruction) -> Floats | None:
    """Where a tool touches that the program has not proposed: at the place that was drawn; nowhere inside a hollow."""
    if result.solid is None or not isinstance(result.fit, Fit) or result.fit.concave:
        return None
    contact = contact_on(result.solid, result.frame.T_base_camera[:3, 3], result.drawing.contact)
    return contact_pose(result.solid, contact.point_m, contact.approach)


def _of_frame(deciding: Deciding) -> tuple[str, ...]:
    """What of the frame a controller should know before it acts."""
    watched = deciding.watched
    if watched is None:
        return ()
    recorded = (RECORDED,) if watched.held.source == "recorded" else ()
    return (*recorded, CHANGED) if watched.changed else recorded


def _words(case: Case) -> tuple[str, ...]:
    """What the operator has typed."""
    override = () if case.override is None else (f"overridden: {case.override.reason}",)
    return (*override, f"rejected: {case.stage.reason}") if isinstance(case.stage, Rejected) else override

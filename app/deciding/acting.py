"""What is done with a proposal by the page in control: named, armed, held, overridden, rejected."""

from dataclasses import replace

from app.deciding.control import no_control
from app.deciding.events import (
    ArmPressed,
    ClassNamed,
    HoldTicked,
    OnProposal,
    OverrideDropped,
    OverrideTyped,
    RejectPressed,
)
from app.deciding.noting import disarmed, noted, refused
from app.deciding.states import Armed, Case, Decided, Deciding, Hold, Override, Proposed, Rejected, obstacles

Action = ClassNamed | OverrideTyped | OverrideDropped | ArmPressed | HoldTicked | RejectPressed
NAMES = {
    ClassNamed: "name the class",
    OverrideTyped: "override",
    OverrideDropped: "drop the override",
    ArmPressed: "arm",
    HoldTicked: "confirm",
    RejectPressed: "reject",
}
"""What is recorded of an action that is declined."""


def acted(deciding: Deciding, event: Action) -> Deciding:
    """The decision after an action: declined unless it is done on the page in control with the present proposal."""
    case = deciding.case
    why = no_control(deciding, event.page) or _stale(case, event)
    if why is None and case is not None:
        outcome = _applied(deciding, case, event)
        if not isinstance(outcome, str):
            return outcome
        why = outcome
    if isinstance(event, HoldTicked) and case is not None:
        deciding = replace(deciding, case=replace(case, hold=None if _holds(case, event.page) else case.hold))
    return refused(deciding, event.page, why or "", NAMES[type(event)])


def _stale(case: Case | None, event: OnProposal) -> str | None:
    if case is None:
        return "Nothing is proposed any more."
    return None if case.number == event.number else "That was for an earlier proposal: look at the present one."


def _holds(case: Case, page: int) -> bool:
    return case.hold is not None and case.hold.page == page


def _applied(deciding: Deciding, case: Case, event: Action) -> Deciding | str:
    """The decision after an action of the one who may act, or why it is declined."""
    match event:
        case ClassNamed():
            return _named(deciding, case, event)
        case OverrideTyped():
            return _overriding(deciding, case, event)
        case OverrideDropped():
            return _with_override(deciding, case, None, "the override was dropped")
        case ArmPressed():
            return _armed(deciding, case, event)
        case HoldTicked():
            return _held(deciding, case, event)
        case RejectPressed():
            return _rejected(deciding, case, event)


def _named(deciding: Deciding, case: Case, event: ClassNamed) -> Deciding | str:
    if not deciding.settings.dangerous:
        return "No class is marked dangerous: there is nothing to name."
    if case.named is not None:
        return "The class is named once, before the proposal is shown."
    return replace(deciding, case=replace(case, named=event.kind))


def _overriding(deciding: Deciding, case: Case, event: OverrideTyped) -> Deciding | str:
    reason = " ".join(event.reason.split())
    if event.tool not in case.offer.tools:
        return "Choose a tool of the table."
    if event.tool not in case.offer.choices:
        return "That is the proposed tool: it needs no override."
    if len(reason) < deciding.settings.least_reason:
        return f"Type the reason, in at least {deciding.settings.least_reason} characters."
    return _with_override(deciding, case, Override(event.tool, reason), "another tool was chosen")


def _with_override(deciding: Deciding, case: Case, override: Override | None, why: str) -> Deciding | str:
    if not isinstance(case.stage, Proposed | Armed):
        return "It is decided: draw it anew to decide again."
    deciding = disarmed(deciding, why, deciding.control.name(deciding.control.holder))
    return replace(deciding, case=replace(case, override=override, stage=Proposed(), hold=None))


def _armed(deciding: Deciding, case: Case, event: ArmPressed) -> Deciding | str:
    if not isinstance(case.stage, Proposed):
        return "It is armed or decided already."
    against = obstacles(deciding)
    if against:
        return against[0]
    stage = Armed(event.page, deciding.now, deciding.now + deciding.settings.arm_s)
    deciding = replace(deciding, case=replace(case, stage=stage, hold=None))
    return noted(deciding, "armed", deciding.control.name(event.page), seconds=deciding.settings.arm_s)


def _held(deciding: Deciding, case: Case, event: HoldTicked) -> Deciding | str:
    """One more tick of the held button; the one that completes the second confirms."""
    settings, now = deciding.settings, deciding.now
    if isinstance(case.stage, Decided) and _holds(case, event.page):
        return replace(deciding, case=replace(case, hold=_after(case.hold, event.page, now, settings.hold_gap_s)))
    if not isinstance(case.stage, Armed) or case.stage.page != event.page:
        return "Arm first, then hold."
    hold = _after(case.hold, event.page, now, settings.hold_gap_s)
    deciding = replace(deciding, case=replace(case, hold=hold))
    if now - hold.started < settings.hold_s or hold.ticks < settings.hold_ticks:
        return deciding
    how = "confirmed" if case.override is None else "overridden"
    who = deciding.control.name(event.page)
    decided = Decided(how, who, event.page, now + settings.valid_s)
    deciding = replace(deciding, case=replace(case, stage=decided, hold=hold))
    recorded = deciding.watched is not None and deciding.watched.held.source == "recorded"
    named = None if case.named is None else str(case.named)
    return noted(deciding, how, who, seconds=settings.valid_s, named=named, frame="recorded" if recorded else "live")


def _after(hold: Hold | None, page: int, now: float, gap_s: float) -> Hold:
    if hold is None or hold.page != page or now - hold.last > gap_s:
        return Hold(page, now, now, 1)
    return replace(hold, last=now, ticks=hold.ticks + 1)


def _rejected(deciding: Deciding, case: Case, event: RejectPressed) -> Deciding | str:
    reason = " ".join(event.reason.split())
    if isinstance(case.stage, Rejected):
        return "It is rejected already."
    if len(reason) < deciding.settings.least_reason:
        return f"Type the reason, in at least {deciding.settings.least_reason} characters."
    who = deciding.control.name(event.page)
    rejected = Rejected(who, reason)
    return noted(replace(deciding, case=replace(case, stage=rejected, hold=None)), "rejected", who, reason=reason)

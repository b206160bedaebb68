"""The decision in words and as HTML; every text from outside is escaped."""

from dataclasses import dataclass
from html import escape
from math import ceil

from app.deciding.states import Armed, Decided, Deciding, Proposed, Rejected, obstacles
from app.deciding.watchdog import age_s, problems
from app.origins import from_
from app.session import Session
from app.wording import from_to
from rotrecon.primitives import in_words
from rotrecon.reconstruction import Reconstruction
from rotrecon.tools import NoTool, ToolProposal

MINUTE_S = 60.0
STYLES = {"proposed": "", "armed": " rr-armed", "confirmed": " rr-done", "overridden": " rr-done", "rejected": ""}


@dataclass(frozen=True)
class Face:
    """All that pages show of a decision and that time alone can change."""

    state: str
    seconds_left: int | None
    age_min: int | None
    against: tuple[str, ...]
    asked_s: int | None
    holder: int | None
    fault: str | None


def face(deciding: Deciding) -> Face:
    """What there is to be seen; equal for two moments between which nothing has to be shown again."""
    asked = deciding.control.asked
    return Face(
        state_name(deciding),
        seconds_left(deciding),
        age_min(deciding),
        obstacles(deciding),
        None if asked is None else _until(deciding, asked.until),
        deciding.control.holder,
        deciding.fault,
    )


def state_name(deciding: Deciding) -> str:
    """How far a proposal has got, in a word or two; it does not say of one that is veiled whether there is a tool."""
    case = deciding.case
    if case is None:
        return "idle"
    match case.stage:
        case Proposed():
            return "proposed" if case.tool is not None or deciding.veiled else "no tool"
        case Armed():
            return "armed"
        case Decided(how=how):
            return how
        case Rejected():
            return "rejected"


def seconds_left(deciding: Deciding) -> int | None:
    """Until what is armed or decided is over."""
    stage = None if deciding.case is None else deciding.case.stage
    return _until(deciding, stage.until) if isinstance(stage, Armed | Decided) else None


def age_min(deciding: Deciding) -> int | None:
    """Whole minutes that the frame is old."""
    watched = deciding.watched
    return None if watched is None else int(age_s(watched, deciding.now) // MINUTE_S)


def decision_html(session: Session) -> str:
    """The tool, what speaks for it and against deciding, how far it has got, and who is in control."""
    deciding = session.decision
    name, left = state_name(deciding), seconds_left(deciding)
    countdown = "" if left is None else f'<b data-testid="countdown" class="rr-count" {from_("times")}>{left} s</b>'
    return (
        f'<div class="rr-decision" data-testid="decision" data-state="{name}">'
        f'<div class="rr-state{STYLES.get(name, "")}"><b>{escape(name.upper())}</b>{countdown}'
        f"<span {from_('tool')}>{escape(_tool_line(session))}</span></div>"
        f'<div class="rr-caption" data-testid="against" {from_("reasons", "hits", "reach")}>'
        f"{_sentences(_lines(session))}</div>"
        f'<div class="rr-caption rr-dim" {from_("age")}>{escape(frame_line(session))}</div></div>'
    )


def control_html(deciding: Deciding, page: int) -> str:
    """Who is in control, and who asks for it."""
    control = deciding.control
    if control.holder is None:
        line = "Nobody is in control. Whoever takes it draws and decides; others watch."
    elif control.holder == page:
        line = "You are in control."
    else:
        line = f"{control.name(control.holder)} is in control; you are watching."
    if control.asked is not None:
        left = _until(deciding, control.asked.until)
        who = "You ask" if control.asked.page == page else f"{control.name(control.asked.page)} asks"
        line += f" {who} for it: without an answer it is handed over in {left} s."
    style = "rr-control" if control.holder == page else "rr-control rr-amber"
    return f'<div class="{style}" data-testid="control" {from_("times")}>{escape(line)}</div>'


def frame_line(session: Session) -> str:
    """Which frame is decided on."""
    deciding = session.decision
    watched = deciding.watched
    if watched is None:
        return "No frame is held."
    if watched.held.source == "live":
        return f"Live frame, {age_min(deciding)} min old."
    what = "Recorded scene" if session.entry is None else f"Frame of entry {session.entry} of the record"
    return f"{what}, opened {age_min(deciding)} min ago: nothing of it stands in front of the arm now."


def _tool_line(session: Session) -> str:
    deciding = session.decision
    case = deciding.case
    if deciding.fault is not None or deciding.veiled or case is None:
        return ""
    kind = in_words(case.offer.kind)
    match case.stage:
        case Rejected(who=who, reason=reason):
            return f"by {who}: {reason}"
        case Decided(who=who):
            return f"{case.tool} for the {kind}, by {who}"
        case _ if case.override is not None:
            return f"override: {case.tool} for the {kind} ({case.override.reason})"
        case _:
            return f"{case.tool} for the {kind}" if case.tool else f"for the {kind}"


def _lines(session: Session) -> tuple[str, ...]:
    """Why it cannot be decided now; or else what the proposal says."""
    deciding = session.decision
    case = deciding.case
    if case is None or deciding.fault is not None or deciding.veiled:
        return obstacles(deciding)
    if isinstance(case.stage, Decided | Rejected):
        return (*problems(deciding.watched, deciding.settings, deciding.now), "A changed drawing is another proposal.")
    past = () if case.override is None else case.in_the_way
    return (*obstacles(deciding), *past, *_reasons(session))


def _reasons(session: Session) -> tuple[str, ...]:
    """What speaks for the tool, or against each."""
    result: Reconstruction | None = session.reconstruction
    match None if result is None else result.tool:
        case ToolProposal(tool=tool, unsure=unsure):
            limits = from_to(tool.diameter_mm, " mm", 0)
            return (f"It takes {' or '.join(f'a {in_words(kind)}' for kind in tool.takes)} of {limits}.", *unsure)
        case NoTool(reasons=reasons):
            return reasons
        case _:
            return ()


def _sentences(lines: tuple[str, ...]) -> str:
    return "<br>".join(escape(line) for line in lines)


def _until(deciding: Deciding, moment: float) -> int:
    return max(ceil(moment - deciding.now), 0)

"""What a measurement becomes: an offer that is bound to its evidence, and the entry that the record has of it."""

from dataclasses import dataclass, replace

from app.clock import seconds
from app.deciding.events import Offered, Unmeasured
from app.deciding.states import Offer
from app.record.evidence import proposal
from app.session import Session
from app.tool_text import tools_in_the_way
from rotrecon.drawing import Drawing
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.tools import ToolProposal


@dataclass(frozen=True)
class Evidence:
    """What a proposal is about, beside the frame."""

    revision: int
    drawing: Drawing
    """The operator's, which has no axis where that was proposed."""
    settings: Settings
    result: Reconstruction


def evidence_shown(session: Session) -> Evidence | None:
    """What could be proposed of the drawing as it is: nothing while it is being drawn or measured."""
    drawing, result = session.shown.complete, session.reconstruction
    if drawing is None or result is None or session.preview is not None or not session.up_to_date:
        return None
    drawing = replace(drawing, axis=None) if session.shown.proposed else drawing
    return Evidence(session.revision, drawing, session.settings, result)


def offered(evidence: Evidence, who: str) -> Offered | Unmeasured:
    """The event that tells the decision of a measurement."""
    result, settings = evidence.result, evidence.settings
    entry = proposal(who, result.frame, evidence.drawing, settings, result)
    if result.solid is None or entry.digest is None:
        return Unmeasured(seconds(), entry)
    in_the_way = tools_in_the_way(result)
    offer = Offer(
        revision=evidence.revision,
        digest=entry.digest,
        kind=result.solid.kind,
        tool=result.tool.tool.name if isinstance(result.tool, ToolProposal) else None,
        tools=tuple(tool.name for tool in settings.tools),
        for_dangerous=frozenset(tool.name for tool in settings.tools if tool.dangerous_ok),
        in_the_way=in_the_way,
    )
    if in_the_way:
        said = " ".join(f"{tool}: {' '.join(lines)}" for tool, lines in in_the_way.items())
        entry = replace(entry, payload={**entry.payload, "in_the_way": said})
    return Offered(seconds(), offer, entry)

"""What is written of a decision, and what is told to a page that is refused."""

from dataclasses import replace

from app.deciding.settings import DecisionSettings
from app.deciding.states import Case, Deciding, Proposed, Rejected, Said
from app.record.entries import Entry, EntryKind

PROGRAM = "rotrecon"
"""Who did what nobody did."""


def noted(deciding: Deciding, kind: EntryKind, who: str, **said: object) -> Deciding:
    """The decision with one more entry to be written, about its proposal if there is one."""
    case = deciding.case
    payload = {name: value for name, value in said.items() if value is not None}
    if case is None:
        entry = Entry(kind, who, payload=payload)
    else:
        about: dict[str, object] = {"proposal": case.number, "tool": case.tool}
        if case.override is not None:
            about |= {"override": case.override.reason}
            about |= {"in_the_way": " ".join(case.in_the_way)} if case.in_the_way else {}
        entry = Entry(kind, who, case.offer.digest, {**about, **payload})
    return replace(deciding, outbox=(*deciding.outbox, entry))


def refused(deciding: Deciding, page: int, why: str, action: str | None = None) -> Deciding:
    """The decision as it was, with a word to the page; an `action` of the decision is recorded as declined."""
    before = next((said for said in deciding.said if said.page == page), None)
    if before is not None and before.text == why and deciding.now - before.at < deciding.settings.quiet_s:
        return deciding
    others = tuple(said for said in deciding.said if said.page != page)
    deciding = replace(deciding, said=(*others, Said(page, why, deciding.now)))
    if action is None:
        return deciding
    return noted(deciding, "declined", deciding.control.name(page), action=action, reason=why)


def disarmed(deciding: Deciding, why: str, who: str = PROGRAM) -> Deciding:
    """The decision with nothing armed, which is noted if something was."""
    if deciding.case is None or deciding.armed is None:
        return deciding
    case = replace(deciding.case, stage=Proposed(), hold=None)
    return noted(replace(deciding, case=case), "disarmed", who, reason=why)


def voided(deciding: Deciding, why: str) -> Deciding:
    """The decision with no proposal: whatever was done with it counts no more."""
    if deciding.case is None:
        return deciding
    return replace(noted(deciding, "voided", PROGRAM, reason=why), case=None)


def proposed_again(deciding: Deciding, case: Case) -> Deciding:
    """The decision with the same evidence proposed under a new number, as if nothing had been done with it."""
    count = deciding.count + 1
    return replace(deciding, case=Case(count, case.offer, named=case.named), count=count)


def resettled(deciding: Deciding, settings: DecisionSettings) -> Deciding:
    """The decision under other settings: what was armed or confirmed under the earlier ones is so no more."""
    case = deciding.case
    if case is not None and not isinstance(case.stage, Proposed | Rejected):
        deciding = proposed_again(noted(deciding, "voided", PROGRAM, reason="a setting was changed"), case)
    return replace(deciding, settings=settings)

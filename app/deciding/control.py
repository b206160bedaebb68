"""Who is in control: at most one page, by an act of its own, and never one that has left or does not answer."""

from dataclasses import replace

from app.deciding.events import (
    ControlAsked,
    ControlGiven,
    ControlTaken,
    HandoverAnswered,
    PageCame,
    PageHeard,
    PageWent,
)
from app.deciding.noting import disarmed, refused
from app.deciding.states import Asked, Control, Deciding, Page


def came(deciding: Deciding, event: PageCame) -> Deciding:
    """A page that comes is a watcher, also one that comes back."""
    control = deciding.control
    if any(page.id == event.page for page in control.pages):
        return deciding
    return replace(deciding, control=replace(control, pages=(*control.pages, Page(event.page, event.name))))


def went(deciding: Deciding, event: PageWent) -> Deciding:
    """A page that has gone takes its control and its question along."""
    control = deciding.control
    if control.holder == event.page:
        deciding = handed(deciding, None, "the page in control has gone")
    elif control.asked is not None and control.asked.page == event.page:
        deciding = replace(deciding, control=replace(control, asked=None))
    pages = tuple(page for page in deciding.control.pages if page.id != event.page)
    said = tuple(said for said in deciding.said if said.page != event.page)
    return replace(deciding, control=replace(deciding.control, pages=pages), said=said)


def taken(deciding: Deciding, event: ControlTaken | ControlAsked) -> Deciding:
    """Control goes to whoever takes or asks while nobody has it; else the one who has it is asked for it."""
    control, page = deciding.control, event.page
    if control.holder == page or not known(control, page):
        return deciding
    if control.holder is None:
        return handed(deciding, page, "control was taken")
    if isinstance(event, ControlTaken):
        return refused(deciding, page, f"{control.name(control.holder)} is in control: ask for it.")
    if control.asked is not None:
        who = "You have" if control.asked.page == page else f"{control.name(control.asked.page)} has"
        return refused(deciding, page, f"{who} asked already: wait for the answer.")
    asked = Asked(page, deciding.now + deciding.settings.answer_s)
    return replace(deciding, control=replace(control, asked=asked))


def given(deciding: Deciding, event: ControlGiven) -> Deciding:
    """Control goes to the page that asks for it, or back to nobody."""
    control = deciding.control
    if control.holder != event.page:
        return refused(deciding, event.page, "You are not in control.")
    return handed(deciding, None if control.asked is None else control.asked.page, "control was given back")


def answered(deciding: Deciding, event: HandoverAnswered) -> Deciding:
    """The page in control lets the one that asks have it, or not."""
    control = deciding.control
    if control.holder != event.page or control.asked is None:
        return refused(deciding, event.page, "Nobody asks you for control.")
    if event.granted:
        return handed(deciding, control.asked.page, "control was handed over")
    deciding = replace(deciding, control=replace(control, asked=None))
    return refused(deciding, control.asked.page, f"{control.name(control.holder)} keeps control.")


def unanswered(deciding: Deciding) -> Deciding:
    """Whoever is in control and was asked for it in vain is not there."""
    asked = deciding.control.asked
    if asked is None or deciding.now < asked.until:
        return deciding
    return handed(deciding, asked.page, "the page in control did not answer")


def heard(deciding: Deciding, event: PageHeard) -> Deciding:
    """The page in control is there; of the others nobody needs to know."""
    if deciding.control.holder != event.page:
        return deciding
    return replace(deciding, control=replace(deciding.control, heard=deciding.now))


def silent(deciding: Deciding) -> Deciding:
    """A page in control that does not answer has hung, or cannot be reached: control goes to whoever asks, or back."""
    control, limit_s = deciding.control, deciding.settings.silent_s
    if control.holder is None or deciding.now - control.heard <= limit_s:
        return deciding
    to = None if control.asked is None else control.asked.page
    deciding = handed(deciding, to, "the page in control has fallen silent")
    why = f"This page did not answer for {limit_s:g} s and has lost control: take it again (Decision panel)."
    return refused(deciding, control.holder, why)


def handed(deciding: Deciding, page: int | None, why: str) -> Deciding:
    """Control goes to a page or to nobody; nothing stays armed, and the pictures have to be sent to the new page."""
    deciding = disarmed(deciding, why)
    case = None if deciding.case is None else replace(deciding.case, ready=False, hold=None)
    return replace(deciding, control=Control(deciding.control.pages, page, heard=deciding.now), case=case)


def known(control: Control, page: int) -> bool:
    """Whether a page is open."""
    return any(open_.id == page for open_ in control.pages)


def no_control(deciding: Deciding, page: int) -> str | None:
    """Why what is done on a page does nothing, or None on the one in control."""
    control = deciding.control
    if control.holder == page:
        return None
    if control.holder is None:
        return "You are watching: take control first (Decision panel)."
    return f"You are watching: {control.name(control.holder)} is in control. Ask for it (Decision panel)."

"""The tour: a first way from an empty frame to a confirmed tool, which ticks itself off by what is done."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from app.deciding.states import Armed, Decided
from app.page import PageState
from app.session import Session

Reached = Callable[[Session, PageState, int], bool]
"""Whether a station is reached, on the page of a number."""


@dataclass(frozen=True)
class Station:
    """One step of it."""

    name: str
    sentence: str
    reached: Reached


def _stage(session: Session) -> object:
    return None if session.decision.case is None else session.decision.case.stage


def _measured(session: Session) -> bool:
    result = session.reconstruction
    return session.up_to_date and result is not None and result.solid is not None


STATIONS = (
    Station(
        "control",
        "Press “Take control” below, or ask for it: one page draws and decides, others watch.",
        lambda session, page, number: session.decision.control.holder == number,
    ),
    Station(
        "area",
        "Drag a rectangle round the object, from one corner to the other.",
        lambda session, page, number: session.shown.area is not None and session.preview is None,
    ),
    Station(
        "result",
        "The result follows by itself; where there is none, this line says why.",
        lambda session, page, number: _measured(session),
    ),
    Station(
        "section",
        "Measured, to within what stands behind ±: now open “Sections” and move its slider to see what that rests on.",
        lambda session, page, number: page.section is not None,
    ),
    Station(
        "3D",
        "Press “3D”, and drag to look at the solid and its tool from all sides.",
        lambda session, page, number: page.view == "3D",
    ),
    Station(
        "arm",
        "Open “Decision” and press “1. Arm”, if the tool is right.",
        lambda session, page, number: isinstance(_stage(session), Armed | Decided),
    ),
    Station(
        "hold",
        "Hold the red button for one second while the time runs; if it has run out, arm again.",
        lambda session, page, number: isinstance(_stage(session), Decided),
    ),
)
END = "The tool is confirmed, and the robot may ask for it now. That was the tour: “Help” starts it again."


def ticked(page: PageState, session: Session, number: int) -> PageState:
    """The page with the stations ticked off that were reached, in their order; what was ticked stays so.

    The tour ends with what it has led to.
    """
    if page.tour is None:
        return page
    if page.tour == len(STATIONS) and not isinstance(_stage(session), Decided):
        return replace(page, tour=None)
    count = page.tour
    while count < len(STATIONS) and STATIONS[count].reached(session, page, number):
        count += 1
    return replace(page, tour=count)


def sentence_of(page: PageState) -> str | None:
    """What to do next; None without a tour."""
    if page.tour is None:
        return None
    return STATIONS[page.tour].sentence if page.tour < len(STATIONS) else END


def tour_html(page: PageState) -> str:
    """How far it has got; nothing without a tour."""
    if page.tour is None:
        return ""
    marks = ("✓" if at < page.tour else "▸" if at == page.tour else "·" for at in range(len(STATIONS)))
    names = "".join(f"<span>{mark} {one.name}</span>" for mark, one in zip(marks, STATIONS, strict=True))
    return f'<div class="rr-tour" data-testid="tour" data-step="{page.tour}">{names}</div>'

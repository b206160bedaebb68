"""The newer frame that waits: what it is, the button on each page that takes it, and how far that is."""

from collections.abc import Callable
from html import escape
from typing import Any

from viser import ClientHandle, GuiEvent, GuiTabHandle

from app.events import Event, FrameTaken
from app.session import Session, sentence
from app.showing import set_to

PLACE = 0.9
"""In the tab of the decision: below who is in control, above what is proposed."""
STEP = 0.01
PREPARED = 50.0
"""Percent of the work, roughly, when the views are prepared."""


class NewerPanel:
    """Controls of one page."""

    def __init__(self, client: ClientHandle, tab: GuiTabHandle, post: Callable[[Event], None]) -> None:
        self._page = client.client_id
        with tab:
            self._take = client.gui.add_button("Take the newer frame", visible=False, order=PLACE)
            self._progress = client.gui.add_progress_bar(0.0, animated=True, visible=False, order=PLACE + STEP)

        async def clicked(event: GuiEvent[Any]) -> None:
            if event.client_id == self._page:
                post(FrameTaken())

        self._take.on_click(clicked)

    def show(self, session: Session) -> None:
        """Bring it up to date."""
        newer, taking = session.newer, session.taking
        can = newer is not None and newer.unusable is None and taking is None
        set_to(self._take, "visible", can and session.decision.control.holder == self._page)
        set_to(self._progress, "visible", taking is not None)
        set_to(self._progress, "value", PREPARED if taking is not None and taking.matching else 0.0)


def newer_html(session: Session) -> str:
    """What waits to be taken, or how far it has got, in a line; nothing while nothing does."""
    line = newer_line(session)
    return f'<div class="rr-hint rr-amber" data-testid="newer">{escape(line)}</div>' if line else ""


def newer_line(session: Session) -> str:
    """The same as plain text."""
    newer, taking = session.newer, session.taking
    if taking is not None:
        return f"Taking {taking.newer.capture.name}: {_work(len(taking.newer.capture.views), taking.matching)}"
    if newer is None:
        return ""
    if newer.unusable is not None:
        return f"The newer frame, {newer.capture.name}, cannot be used. {sentence(newer.unusable)}"
    return (
        f"A newer frame has arrived: {newer.capture.name}, from {newer.who} at {newer.arrived_at:%H:%M:%S} UTC. "
        "What you see is still the frame before it; the one in control can take it (Decision panel)."
    )


def _work(views: int, matching: bool) -> str:
    if not views:
        return "reading it \N{HORIZONTAL ELLIPSIS}"
    if matching:
        return f"2 of 2, matching its {views} views \N{HORIZONTAL ELLIPSIS}"
    return f"1 of 2, checking the poses of its {views} views \N{HORIZONTAL ELLIPSIS}"

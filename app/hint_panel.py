"""The line on top of a page that says what to do next, and leads on where a tour is on."""

from collections.abc import Callable
from html import escape
from typing import Any

from viser import ClientHandle, GuiEvent, GuiTabHandle

from app.page import PageEvent, PageState, TourClosed, TourStarted
from app.result_text import hint_html
from app.session import Session
from app.showing import in_session_unit, set_to
from app.tour import sentence_of, tour_html

NOBODY = "Nobody is in control: take it in the Decision panel below, then draw."
ON_TOP = -2.0
"""Order before everything that all pages share."""


class HintPanel:
    """One page's."""

    def __init__(self, client: ClientHandle, help_tab: GuiTabHandle, post: Callable[[PageEvent], None]) -> None:
        gui, self._post = client.gui, post
        self._hint = gui.add_html("", order=ON_TOP)
        self._close = gui.add_button("Close the tour", color="gray", visible=False, order=ON_TOP + 1)
        with help_tab:
            self._start = gui.add_button("Start the tour", color="gray", order=ON_TOP)
        self._close.on_click(self._posting(TourClosed()))
        self._start.on_click(self._posting(TourStarted()))

    def show(self, session: Session, page: PageState) -> None:
        """Bring it up to date."""
        set_to(self._hint, "content", in_session_unit(_html(session, page), session))
        set_to(self._close, "visible", page.tour is not None)

    def _posting(self, event: PageEvent) -> Any:
        async def clicked(clicked: GuiEvent[Any]) -> None:
            if clicked.client_id is not None:
                self._post(event)

        return clicked


def _html(session: Session, page: PageState) -> str:
    """What to do next; first of all somebody has to be in control."""
    led, progress = sentence_of(page), tour_html(page)
    if session.decision.control.holder is not None:
        return hint_html(session, led, progress)
    return f'<div class="rr-hint rr-amber" data-testid="hint">{escape(led or NOBODY)}</div>{progress}'

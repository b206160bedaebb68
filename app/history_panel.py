"""The tab of the record, one page's own: what was decided, looked through, computed again, saved, opened again."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from viser import ClientHandle, GuiEvent, GuiTabHandle

from app.browsing import (
    SHOWN,
    Asked,
    Browsed,
    Browsing,
    EntryChosen,
    ListFiltered,
    ListTurned,
    OpeningAsked,
    ReplayAsked,
    ReportAsked,
)
from app.clock import seconds, wall_s
from app.history_text import entry_html, head_html, list_html, typed_in
from app.record.history import Listing
from app.reopening import BroughtBack
from app.report.exports import ExportFormat
from app.session import Session
from app.showing import set_to
from app.units import in_unit

NEWER, OLDER = "Newer", "Older"
SAVE = "Save"
ACTS: dict[str, Any] = {"Replay": ReplayAsked, "Open again": OpeningAsked, SAVE: ReportAsked}
FORMATS: dict[str, ExportFormat] = {
    "report (HTML)": "html",
    "all that is known (JSON)": "json",
    "sections (CSV)": "csv",
    "points (PLY)": "ply",
    "solid (GLB)": "glb",
    "solid (STL)": "stl",
}


@dataclass(frozen=True)
class Looked:
    """What one page was told of the record."""

    listing: Listing = field(default_factory=Listing)
    problem: str | None = None
    number: int | None = None
    """Of the entry that the next two are about."""
    told: str = ""
    good: bool = False


class HistoryPanel:
    """A fixed number of controls; the list stands in one of them."""

    def __init__(
        self, client: ClientHandle, tab: GuiTabHandle, post: Callable[[Browsed | Asked | BroughtBack], None]
    ) -> None:
        self._gui, self._page, self._post = client.gui, client.client_id, post
        self._shown: tuple[Looked, Browsing] = (Looked(), Browsing())
        with tab:
            shown = self._gui.add_dropdown("Show", tuple(SHOWN), initial_value=Browsing().shown)
            text = self._gui.add_text("With the words", "")
            self._list = self._gui.add_html("")
            self._numbers = self._gui.add_button_group("Entry", ("-",), visible=False)
            turn = self._gui.add_button_group("More", (NEWER, OLDER))
            self._entry = self._gui.add_html("")
            self._do = self._gui.add_button_group("This entry", tuple(ACTS), visible=False)
            self._format = self._gui.add_dropdown("Save as", tuple(FORMATS), visible=False)
            self._back = self._gui.add_button("Back to what was open before", color="gray", visible=False)
            self._head = self._gui.add_html("")
        shown.on_update(self._doing(lambda value: ListFiltered(shown=value)))
        text.on_update(self._doing(lambda value: ListFiltered(text=value)))
        turn.on_click(self._doing(self._turned))
        self._numbers.on_click(self._doing(lambda value: EntryChosen(int(value))))
        self._do.on_click(self._doing(self._of_chosen))
        self._back.on_click(self._doing(lambda _: BroughtBack(seconds(), self._page, wall_s())))

    def show(self, session: Session, looked: Looked, browsing: Browsing) -> None:
        """Bring it up to date, sending only what has changed."""
        self._shown = (looked, browsing)
        listing = looked.listing
        set_to(self._list, "content", in_unit(list_html(listing, looked.problem), session.unit, typed_in(listing)))
        set_to(self._head, "content", head_html(listing.head))
        numbers = tuple(str(line.number) for line in listing.lines)
        if numbers and self._numbers.options != numbers:
            self._numbers.options = numbers
        set_to(self._numbers, "visible", bool(numbers))
        chosen = listing.chosen
        is_told = chosen is not None and looked.number == chosen.number
        set_to(self._entry, "content", entry_html(chosen, looked.told if is_told else "", is_told and looked.good))
        for part in (self._do, self._format):
            set_to(part, "visible", chosen is not None and chosen.answer is not None)
        holds = session.decision.control.holder == self._page
        set_to(self._back, "visible", holds and session.left is not None)

    def _turned(self, way: str) -> Browsed | None:
        looked, _ = self._shown
        if way == NEWER:
            return ListTurned(None)
        return None if looked.listing.older is None else ListTurned(looked.listing.older)

    def _of_chosen(self, act: str) -> Asked | None:
        _, browsing = self._shown
        if browsing.chosen is None:
            return None
        return ReportAsked(browsing.chosen, FORMATS[self._format.value]) if act == SAVE else ACTS[act](browsing.chosen)

    def _doing(self, event_of: Callable[[Any], Browsed | Asked | BroughtBack | None]) -> Any:
        """A callback that posts the event a value stands for, when this page and not the program has set it."""

        async def done(event: GuiEvent[Any]) -> None:
            made = event_of(event.target.value) if event.client_id == self._page else None
            if made is not None:
                self._post(made)

        return done

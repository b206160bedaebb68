"""What one page looks at of the record: which entries are listed, and which of them is chosen."""

from dataclasses import dataclass, replace
from typing import get_args

from app.record.entries import EntryKind
from app.report.exports import ExportFormat

DECIDED: tuple[EntryKind, ...] = ("confirmed", "overridden", "rejected")
SHOWN: dict[str, tuple[EntryKind, ...]] = {
    "decisions": DECIDED,
    "everything": (),
    **{kind: (kind,) for kind in get_args(EntryKind)},
}
"""What can be listed, by its name on the page; nothing stands for all kinds."""
LONGEST_TEXT = 100
"""Characters of what is looked for."""


@dataclass(frozen=True)
class Browsing:
    """One page's own choices."""

    shown: str = "decisions"
    text: str = ""
    """Words that all have to be in an entry."""
    before: tuple[int, ...] = ()
    """Where each page of the list after the first begins: with the newest entry before that number."""
    chosen: int | None = None
    """Number of the entry that is looked at."""


@dataclass(frozen=True)
class ListFiltered:
    """Another kind of entries, or other words, are asked for; what is None stays."""

    shown: str | None = None
    text: str | None = None


@dataclass(frozen=True)
class ListTurned:
    """On to the entries before a number, or back by None."""

    before: int | None


@dataclass(frozen=True)
class EntryChosen:
    number: int


@dataclass(frozen=True)
class ReplayAsked:
    """The chosen entry is to be computed again."""

    number: int


@dataclass(frozen=True)
class ReportAsked:
    """A file of the chosen entry is asked for."""

    number: int
    format: ExportFormat


@dataclass(frozen=True)
class OpeningAsked:
    """Frame and drawing of an entry are to be what is shown."""

    number: int


Browsed = ListFiltered | ListTurned | EntryChosen
Asked = ReplayAsked | ReportAsked | OpeningAsked
"""What takes longer than a page may wait for."""


def browse(browsing: Browsing, event: Browsed) -> Browsing:
    """The choices after an event; what a page could not have sent by its controls changes nothing."""
    match event:
        case ListFiltered(shown, text) if shown is None or shown in SHOWN:
            text = browsing.text if text is None else text[:LONGEST_TEXT]
            return replace(browsing, shown=shown or browsing.shown, text=text, before=())
        case ListTurned(None):
            return replace(browsing, before=browsing.before[:-1])
        case ListTurned(int(before)) if not browsing.before or before < browsing.before[-1]:
            return replace(browsing, before=(*browsing.before, before))
        case EntryChosen(number):
            return replace(browsing, chosen=number)
        case _:
            return browsing

"""Where the record is read for pages: beside the console's queue, on which it posts what has come of it."""

import asyncio
import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from app.browsing import SHOWN, Asked, Browsing, OpeningAsked, ReplayAsked, ReportAsked
from app.deciding.watchdog import FrameFacts
from app.held import Held
from app.newer_frames import facts_of
from app.object_drawing import ObjectDrawing, drawn_as
from app.record.errors import NoSuchEntry, StoreError
from app.record.evidence import evidence_of, replay
from app.record.history import NAMED, History, Listing, Wanted
from app.record.store import Record
from app.reopening import OpenedAgain
from app.replay_text import told_of
from app.report.exports import NothingToExport, export_entry, file_name
from rotrecon.capture import Capture
from rotrecon.drawing import DrawingError

VEILED = "Name the class of the object in the Decision panel first."
NO_RECORD = "This console was started without a record."
UNKNOWN = "The program failed on this entry, which is its own mistake."
CALM_S = 1.0
"""What was written is listed when nothing was for so long: whoever draws does not look at the list, and goes first."""
log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Listed:
    """What pages have asked to see of the record, or why they cannot."""

    pages: tuple[int, ...]
    listing: Listing
    problem: str | None = None


@dataclass(frozen=True)
class Told:
    """What has come of something that a page has asked for; `good` where numbers are the same."""

    pages: tuple[int, ...]
    number: int
    text: str
    good: bool = False


@dataclass(frozen=True, eq=False)
class Exported:
    """A file for a page."""

    pages: tuple[int, ...]
    number: int
    name: str
    content: bytes


@dataclass(frozen=True, eq=False)
class Fetched:
    """Frame and drawing of an entry."""

    page: int
    held: Held
    facts: FrameFacts
    drawn: ObjectDrawing

    def opening(self, at: float, wall_s: float) -> OpenedAgain:
        """What becomes of it: the page wants it to be what is shown."""
        return OpenedAgain(at, self.page, wall_s, self.facts, self.held, self.drawn)


Posted = Listed | Told | Exported | Fetched


class Archive:
    """Everything but what begins with `_read` runs in the console's event loop; each page waits for one thing."""

    def __init__(self, record: Record | None, post: Callable[[Posted], None]) -> None:
        self._record, self._post = record, post
        self._history = None if record is None else History(record)
        self._listed: dict[int, tuple[Wanted, int]] = {}
        self._written = self._calm = 0
        self._written_at = 0.0
        self._tasks: dict[int | Wanted, asyncio.Task[None]] = {}
        """By the page that waits, or by what is listed for some of them."""

    @property
    def busy(self) -> bool:
        """Whether anything is being read or computed."""
        return bool(self._tasks)

    def look(self, pages: Mapping[int, Browsing], written: int, veiled: bool, now: float) -> None:
        """List for every page what it wants to see, when that is another thing or the record (`written` times) is."""
        if written != self._written:
            self._written, self._written_at = written, now
        if now - self._written_at >= CALM_S:
            self._calm = self._written
        self._listed = {page: listed for page, listed in self._listed.items() if page in pages}
        stale: dict[Wanted, list[int]] = {}
        for page, browsing in pages.items():
            before = browsing.before[-1] if browsing.before else None
            wanted = Wanted(SHOWN[browsing.shown], browsing.text, before, browsing.chosen, veiled)
            if self._listed.get(page) != (wanted, self._calm) and wanted not in self._tasks:
                stale.setdefault(wanted, []).append(page)
                self._listed[page] = (wanted, self._calm)
        for wanted, who in stale.items():
            self._start(wanted, lambda wanted=wanted, who=tuple(who): self._read_list(who, wanted))

    def ask(self, page: int, asked: Asked, veiled: bool) -> None:
        """Begin with what a page asks for, unless it waits for something already."""
        if page in self._tasks:
            self._post(Told((page,), asked.number, "One thing after the other: the one before is not done yet."))
        else:
            self._start(page, lambda: self._read(page, asked, veiled))

    def stop(self) -> tuple[asyncio.Task[None], ...]:
        """Give up what is under way; the tasks to wait for."""
        for task in self._tasks.values():
            task.cancel()
        return tuple(self._tasks.values())

    def _start(self, what: int | Wanted, read: Callable[[], Posted]) -> None:
        async def run() -> None:
            found = await asyncio.to_thread(read)
            del self._tasks[what]
            self._post(found)

        self._tasks[what] = asyncio.create_task(run())

    def _read_list(self, pages: tuple[int, ...], wanted: Wanted) -> Posted:
        try:
            if self._history is None:
                return Listed(pages, Listing(), NO_RECORD)
            return Listed(pages, self._history.listing(wanted))
        except (StoreError, NoSuchEntry) as error:
            return Listed(pages, Listing(), str(error))
        except Exception:
            log.exception("the record cannot be listed")
            return Listed(pages, Listing(), UNKNOWN)

    def _read(self, page: int, asked: Asked, veiled: bool) -> Posted:
        try:
            return self._answered(page, asked, veiled)
        except (StoreError, NoSuchEntry, NothingToExport, DrawingError) as error:
            return Told((page,), asked.number, f"Not possible: {error}.")
        except Exception:
            log.exception("what was asked of entry %s has failed", asked.number)
            return Told((page,), asked.number, UNKNOWN)

    def _answered(self, page: int, asked: Asked, veiled: bool) -> Posted:
        if self._record is None or self._history is None:
            return Told((page,), asked.number, NO_RECORD)
        if veiled and self._history.line(asked.number).kind not in NAMED:
            return Told((page,), asked.number, VEILED)
        match asked:
            case ReplayAsked(number):
                again = replay(evidence_of(self._record, self._record.entry(number)))
                return Told((page,), number, told_of(again), again.same)
            case ReportAsked(number, format_):
                content = export_entry(self._record, number, format_)
                return Exported((page,), number, file_name(number, format_), content)
            case OpeningAsked(number):
                evidence = evidence_of(self._record, self._record.entry(number))
                frame, name = evidence.frame, f"Entry {number} of the record"
                held = Held(frame, name, Capture(name, recorded=frame), entry=number)
                return Fetched(page, held, facts_of(frame), drawn_as(evidence.drawing))

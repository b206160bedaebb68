"""The record as a list to look through: newest first, each entry with what it was about, found by kind and words."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

from app.record.entries import EntryKind, Head, Written
from app.record.evidence import said_with
from app.record.store import Record

LINES = 5
"""On a page of the list: what a panel has room for beside its controls."""
SEARCHED = 1000
"""Entries that one page of the list is looked for in: beyond, whoever waits for it is told to go on."""
KNOWN_LINES = 1000
"""Kept for the next time; each is some kilobytes."""
NAMED: tuple[EntryKind, ...] = ("confirmed", "overridden")
"""Of what the operator has named the class of, where that is asked for."""


@dataclass(frozen=True)
class Line:
    """One entry, and the measurement it is about, if there is one."""

    number: int
    kind: EntryKind
    who: str
    when: str
    """ISO 8601, UTC."""
    said: str = ""
    """Why, in the words of a person or of the program."""
    tool: str | None = None
    answer: dict[str, Any] | None = None
    """What was measured, as `rotrecon.answer` gives it."""
    picture: str | None = None
    """Small, as a data URL."""

    @property
    def text(self) -> str:
        """What words are looked for in."""
        measured = self.answer or {}
        numbers = "" if measured.get("diameter_mm") is None else f"{measured['diameter_mm']:.1f}"
        parts = (self.number, self.kind, self.who, self.when, self.said, self.tool, measured.get("kind"), numbers)
        return " ".join(str(part) for part in parts if part is not None).casefold()


@dataclass(frozen=True)
class Wanted:
    """What is to be listed."""

    kinds: tuple[EntryKind, ...] = ()
    """None: all."""
    text: str = ""
    before: int | None = None
    """Older than that number."""
    chosen: int | None = None
    veiled: bool = False
    """Whether the operator has to name a class before anything measured may be seen."""


@dataclass(frozen=True)
class Listing:
    """A page of the list."""

    lines: tuple[Line, ...] = ()
    older: int | None = None
    """Where the next page begins; None on the last one."""
    chosen: Line | None = None
    head: Head = field(default_factory=Head)
    """Of the record when this was read."""


class History:
    """Reads the record; of any number of threads. Entries are never changed, so each is read once."""

    def __init__(self, record: Record) -> None:
        self._record = record
        self._line = lru_cache(maxsize=KNOWN_LINES)(self._read)

    def listing(self, wanted: Wanted) -> Listing:
        """A page of the list; raises StoreError."""
        numbers = self._record.numbers(wanted.kinds, wanted.before, SEARCHED + 1)
        older = numbers[SEARCHED] + 1 if len(numbers) > SEARCHED else None
        words, found = wanted.text.casefold().split(), list[Line]()
        for number in numbers[:SEARCHED]:
            line = self.line(number, wanted.veiled)
            if not all(word in line.text for word in words):
                continue
            if len(found) == LINES:
                older = number + 1
                break
            found.append(line)
        head = self._record.head
        is_there = wanted.chosen is not None and 0 < wanted.chosen <= head.id
        return Listing(tuple(found), older, self.line(wanted.chosen or 0, wanted.veiled) if is_there else None, head)

    def line(self, number: int, veiled: bool = False) -> Line:
        """One entry, without what was measured where that may not be seen; raises NoSuchEntry and StoreError."""
        line = self._line(number)
        if not veiled or line.kind in NAMED:
            return line
        return replace(line, said="", tool=None, answer=None, picture=None)

    def _read(self, number: int) -> Line:
        written = self._record.entry(number)
        content = written.content
        about = _measurement(self._record.entries(digest=content["digest"]), number) if content["digest"] else {}
        said = said_with(written)
        answer = about.get("answer")
        return Line(
            number,
            content["kind"],
            content["who"],
            content["when"],
            why(said),
            said.get("tool") or (answer or {}).get("tool"),
            answer,
            about.get("picture"),
        )


def why(said: Mapping[str, Any]) -> str:
    """Why something was done or declined, of what an entry says."""
    words = (said.get(name) for name in ("override", "reason", "in_the_way", "action"))
    return "; ".join(str(word) for word in words if word)


def _measurement(entries: Collection[Written], number: int) -> dict[str, Any]:
    """What the last of them that holds a measurement, up to a number, says of it; nothing where there is none."""
    payloads = [entry.content["payload"] for entry in entries if entry.id <= number]
    holding = [payload for payload in payloads if "evidence" in payload]
    if not holding:
        return {}
    return {name: holding[-1].get(name) for name in ("answer", "picture")}

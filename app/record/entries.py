"""Entries of the record, and the chain that each of them is a link of."""

import json
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any, Literal

from app.record.tree import canonical, sha256

EntryKind = Literal[
    "proposal", "refusal", "armed", "disarmed", "confirmed", "rejected", "overridden", "voided", "declined"
]
"""A result with a tool, one without; what was done with it; `declined` is an action that was not accepted."""
BEFORE_THE_FIRST = "0" * 64
"""What stands in the first entry for the hash of the one before."""


@dataclass(frozen=True)
class Entry:
    """Something to be recorded."""

    kind: EntryKind
    who: str
    digest: str | None = None
    """Of the evidence that it is about; see `app.digest`."""
    payload: dict[str, Any] = field(default_factory=dict)
    """What JSON holds: the evidence of a proposal, the reason of a rejection."""
    when: datetime | None = None
    """None: now. Of a time zone."""

    def __post_init__(self) -> None:
        if self.when is not None and self.when.tzinfo is None:
            raise ValueError("the time of an entry has a time zone; give one")


@dataclass(frozen=True)
class Written:
    """An entry on disk."""

    id: int
    """From 1, without a gap."""
    hash: str
    """SHA-256 of its body, which holds the hash of the one before."""
    body: bytes
    """Canonical JSON of all that the entry says."""

    @property
    def content(self) -> dict[str, Any]:
        """The body's members: id, previous, kind, who, when, digest, versions and payload."""
        return json.loads(self.body)

    @property
    def head(self) -> "Head":
        """The entry as a head that is kept elsewhere."""
        return Head(self.id, self.hash)


@dataclass(frozen=True)
class Head:
    """How long the chain is and what it ends with: whoever kept one notices a tail that was cut off since."""

    id: int = 0
    hash: str = BEFORE_THE_FIRST

    def __str__(self) -> str:
        return f"{self.id}:{self.hash}"

    @staticmethod
    def parse(text: str) -> "Head":
        """A head as it is shown, "12:9f..."; raises ValueError."""
        number, _, digits = text.strip().partition(":")
        if not number.isdecimal() or len(digits) != 64 or set(digits) - set("0123456789abcdef"):
            raise ValueError(f'"{text}" is no head; copy it whole, as `rotrecon log list` or a report shows it')
        return Head(int(number), digits)


def link(entry: Entry, head: Head, versions: dict[str, str]) -> Written:
    """An entry as the next one of a chain; raises ValueError for a payload that JSON cannot hold exactly."""
    when = (entry.when or datetime.now(UTC)).astimezone(UTC)
    content = {
        "id": head.id + 1,
        "previous": head.hash,
        "kind": entry.kind,
        "who": entry.who,
        "when": when.isoformat(timespec="microseconds"),
        "digest": entry.digest,
        "versions": versions,
        "payload": entry.payload,
    }
    try:
        body = canonical(content)
    except TypeError as error:
        raise ValueError(f"the payload of a {entry.kind} cannot be recorded: {error}") from error
    return Written(head.id + 1, sha256(body), body)

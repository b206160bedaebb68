"""Whether the record is whole: every link of the chain, every frame it names, and that it still ends where it did."""

import json
from dataclasses import dataclass
from typing import Any

from app.digest import digest_of_parts
from app.record.entries import BEFORE_THE_FIRST, Head
from app.record.store import Record
from app.record.tree import canonical, sha256


@dataclass(frozen=True)
class Fault:
    """The first entry that is not as it was written."""

    id: int
    problem: str


def verify(record: Record, kept: Head | None = None) -> Fault | None:
    """The first entry that is bad, or None for a record that is whole.

    `kept` is a head that was noted elsewhere: without one, a record whose tail was cut off is whole, and shorter.
    """
    previous, number, seen = BEFORE_THE_FIRST, 0, set[str]()
    for row in record.rows():
        number += 1
        try:
            problem = _problem(row, number, previous) or _problem_of_evidence(record, json.loads(row[3]), seen)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            problem = f"is no entry of a record ({error!r})"
        if problem is not None:
            return Fault(number, problem)
        previous = row[4].decode("ascii")
        if kept is not None and kept.id == number and kept.hash != previous:
            return Fault(number, "is not the one that the kept head was noted of: it was replaced since")
    if kept is not None and kept.id > number:
        return Fault(number + 1, f"is missing, and all up to {kept.id}, the kept head's: the tail was cut off")
    return None


def _problem(row: Any, number: int, previous: str) -> str | None:
    """What is wrong with one row of the chain."""
    found, kind, digest, body, digits = row
    if found != number:
        return f"is missing; {found} is in its place"
    if sha256(body).encode() != digits:
        return "has a body that its hash is not of: one of them was changed"
    content = json.loads(body)
    if content["previous"] != previous:
        return "does not follow from the one before: one of them was replaced"
    columns = [content["id"], content["kind"], content["digest"]]
    if columns != [number, kind.decode(), None if digest is None else digest.decode()] or canonical(content) != body:
        return "says something else in the table than in its body"
    return None


def _problem_of_evidence(record: Record, content: dict[str, Any], seen: set[str]) -> str | None:
    """What is wrong with the evidence that an entry holds; nothing where it holds none."""
    evidence = content["payload"].get("evidence")
    if evidence is None:
        return None
    if content["digest"] != digest_of_parts(**evidence):
        return "holds evidence that its digest is not of"
    if evidence["frame"] in seen:
        return None
    seen.add(evidence["frame"])
    problem = record.scene_problem(evidence["frame"])
    return None if problem is None else f"names a scene that is lost: {problem}"

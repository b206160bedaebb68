"""What a proposal rests on: written with it, read again, and computed again."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from app.digest import digest_of_parts, frame_id, result_tree, tree_of
from app.record.entries import Entry, Head, Written
from app.record.errors import NoSuchEntry, StoreError
from app.record.store import Record
from app.record.tree import Tree, canonical, from_tree
from app.record.versions import versions
from app.report.pictures import thumbnail
from rotrecon.answer import answer
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.tools import ToolProposal


def proposal(who: str, frame: Frame, drawing: Drawing, settings: Settings, result: Reconstruction) -> Entry:
    """The entry of a result: a proposal when it names a tool, else a refusal. Append it together with the frame.

    The drawing is the operator's, with an axis or without; the digest is that of `app.digest.evidence_digest`. The
    payload is `evidence`, what `rotrecon.answer` says, and a small picture as a data URL.
    """
    trees = {"drawing": tree_of(drawing), "settings": tree_of(settings), "result": result_tree(result)}
    name = frame_id(frame)
    return Entry(
        kind="proposal" if isinstance(result.tool, ToolProposal) else "refusal",
        who=who,
        digest=digest_of_parts(name, **trees),
        payload={"evidence": {"frame": name, **trees}, "answer": answer(result), "picture": thumbnail(result)},
    )


def said_with(written: Written) -> dict[str, Tree]:
    """What an entry holds beside the measurement, such as the reason of a rejection."""
    measured = ("evidence", "answer", "picture")
    return {name: value for name, value in written.content["payload"].items() if name not in measured}


@dataclass(frozen=True, eq=False)
class Evidence:
    """What an entry is about, as it was recorded."""

    entry: Written
    """The proposal or refusal that holds it."""
    frame: Frame
    drawing: Drawing
    settings: Settings
    result: Tree
    answer: dict[str, Any]


def evidence_of(record: Record, written: Written) -> Evidence:
    """The evidence of an entry: its own, or that of the last proposal before it with the same digest.

    Raises NoSuchEntry for an entry that is about none, StoreError for one that this version cannot read.
    """
    digest = written.content["digest"]
    found = [] if digest is None else [entry for entry in record.entries(digest=digest) if entry.id <= written.id]
    holding = [entry for entry in found if "evidence" in entry.content["payload"]]
    if not holding:
        raise NoSuchEntry(f"entry {written.id} is about no measurement, so that there is nothing to compute or draw")
    payload = holding[-1].content["payload"]
    recorded = payload["evidence"]
    try:
        drawing, settings = (from_tree(recorded[part], _no_arrays) for part in ("drawing", "settings"))
        frame = record.scene(recorded["frame"])
    except ValueError as error:
        raise StoreError(f"entry {written.id} cannot be read: {error}; use the version that wrote it") from error
    return Evidence(holding[-1], frame, drawing, settings, recorded["result"], payload["answer"])


def _no_arrays(digest: str) -> bytes:
    raise ValueError(f"the array {digest} is no part of a drawing or of settings")


@dataclass(frozen=True)
class Difference:
    """A number that came out another way."""

    name: str
    recorded: Tree
    now: Tree


@dataclass(frozen=True, eq=False)
class Replay:
    """A measurement computed again."""

    result: Reconstruction
    numbers: int
    """How many were compared; intermediates count one an array."""
    differences: tuple[Difference, ...]
    versions: tuple[Difference, ...]
    """Of the program and the libraries, where they are not those of then."""

    @property
    def same(self) -> bool:
        """Every number is the same, to the last bit."""
        return not self.differences


def replay(evidence: Evidence) -> Replay:
    """Compute a measurement again from what was recorded of it; raises DrawingError where it is refused today."""
    result = reconstruct(evidence.frame, evidence.drawing, evidence.settings)
    then, now = dict(_leaves(evidence.result)), dict(_leaves(result_tree(result)))
    return Replay(result, len(then), _between(then, now), _between(evidence.entry.content["versions"], versions()))


def _between(then: dict[str, Tree], now: dict[str, Tree]) -> tuple[Difference, ...]:
    """Members that differ or that only one of two has; `canonical` tells -0.0 from 0.0 and 1 from 1.0."""
    names = [*then, *(name for name in now if name not in then)]
    pairs = [Difference(name, then.get(name), now.get(name)) for name in names]
    return tuple(pair for pair in pairs if canonical(pair.recorded) != canonical(pair.now))


def _leaves(tree: Tree, name: str = "") -> Iterator[tuple[str, Tree]]:
    """Every number and word of a tree under its path, as `fit.Fit.along_m.numbers[3]`; an array by its hash is one."""
    if isinstance(tree, dict) and "array" not in tree:
        for key, member in tree.items():
            yield from _leaves(member, f"{name}.{key}" if name else key)
    elif isinstance(tree, list) and tree:
        for number, member in enumerate(tree):
            yield from _leaves(member, f"{name}[{number}]")
    else:
        yield name, tree


@dataclass(frozen=True, eq=False)
class Decision:
    """All that a report says: an entry, what else was written of the same evidence, and the evidence itself."""

    entry: Written
    trail: tuple[Written, ...]
    """All entries of the same digest, in their order."""
    evidence: Evidence
    replay: Replay
    head: Head
    """Of the record when this was read."""


def decision_of(record: Record, number: int) -> Decision:
    """What there is to report of an entry; raises NoSuchEntry and StoreError."""
    written = record.entry(number)
    evidence = evidence_of(record, written)
    trail = record.entries(digest=written.content["digest"])
    return Decision(written, trail, evidence, replay(evidence), record.head)

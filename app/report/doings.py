"""What was done with a proposal, in words, and which tool that was about."""

from typing import Any

from app.record.entries import Written
from app.record.evidence import said_with

WORDS = {
    "tool": "{}",
    "override": "against the program's answer: \u201c{}\u201d",
    "in_the_way": "{}",
    "reason": "\u201c{}\u201d",
    "action": "to {}",
    "named": "named a {} before the measurement was shown",
}
"""How what an entry says is told, in this order; what is not here is told otherwise."""
FRAMES = {
    "recorded": "on a recorded scene, of which nothing stood in front of the arm",
    "live": "on a live frame",
}
TIMES = {"armed": "for {:g} s", "confirmed": "good for {:g} s", "overridden": "good for {:g} s"}


def doing(entry: Written) -> str:
    """What was said with an entry, by a person or by the program."""
    said, kind = said_with(entry), entry.content["kind"]
    parts = [words.format(said[name]) for name, words in WORDS.items() if said.get(name)]
    if kind in TIMES and isinstance(said.get("seconds"), float):
        parts.append(TIMES[kind].format(said["seconds"]))
    if said.get("frame") in FRAMES:
        parts.append(FRAMES[said["frame"]])
    return "; ".join(part.rstrip(".") for part in parts)


def decided_tool(entry: Written, answer: dict[str, Any]) -> str | None:
    """The tool that an entry is about: the operator's choice where there was one, else what the program answered."""
    return said_with(entry).get("tool") or answer["tool"]

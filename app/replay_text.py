"""What came of computing an entry again, in words."""

import json

from app.record.evidence import Difference, Replay

SHOWN_DIFFERENCES = 20
"""Where one number differs most others do."""
SAID_DIFFERENCES = 3
"""The same where there is room for a few lines."""


def replay_lines(number: int, again: Replay) -> str:
    """For a terminal: every difference in a line of its own, as far as they can be read."""
    lines = [f"entry {number}: {_counted(again)}"]
    lines += [f"  {difference_text(one)}" for one in again.differences[:SHOWN_DIFFERENCES]]
    if len(again.differences) > SHOWN_DIFFERENCES:
        lines.append(f"  ... and {len(again.differences) - SHOWN_DIFFERENCES} more")
    return "\n".join(lines + [f"  {difference_text(one)} (version)" for one in again.versions])


def told_of(again: Replay) -> str:
    """For a page: a sentence, with the first differences if there are any."""
    parts = [difference_text(one) for one in again.differences[:SAID_DIFFERENCES]]
    parts += [f"{difference_text(one)} (version)" for one in again.versions]
    return f"Computed again: {_counted(again)}." + ("" if not parts else f" {'; '.join(parts)}.")


def difference_text(one: Difference) -> str:
    """One number that came out another way."""
    return f"{one.name}: recorded {json.dumps(one.recorded)}, now {json.dumps(one.now)}"


def _counted(again: Replay) -> str:
    if again.same:
        return f"all {again.numbers} numbers are the same"
    return f"{len(again.differences)} of {again.numbers} numbers are not the same"

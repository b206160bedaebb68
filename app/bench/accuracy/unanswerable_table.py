"""The table of areas for which there is no certain answer: what was said of them all the same."""

from functools import partial
from pathlib import Path

from app.bench.accuracy.goals import Goal
from app.bench.accuracy.trials import in_processes
from app.bench.accuracy.unanswerable import AREAS, SIMULATED, Area
from app.bench.table import table
from rotrecon.answer import answer
from rotrecon.drawing import DrawingError
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Method, Settings

FEWEST = 200


def unanswerable_table(
    recordings: Path | None, method: Method, areas: tuple[Area, ...] = AREAS, processes: int | None = None
) -> tuple[str, list[Goal]]:
    """What is said of every area, by what there is instead of something round; recorded ones where there are any."""
    asked = [area for area in areas if recordings is not None or area.source == SIMULATED]
    said = in_processes(partial(_said_of, recordings or Path(), method), asked, processes)
    rows: list[tuple[str, ...]] = []
    for group in dict.fromkeys(area.group for area in asked):
        part = [words for area, words in zip(asked, said, strict=True) if area.group == group]
        counts = (part.count(words) for words in ("refused", "not certain", "certain"))
        rows.append((group, f"{len(part)}", *(f"{count}" for count in counts)))
    wrong = [str(area) for area, words in zip(asked, said, strict=True) if words == "certain"]
    found = f"{len(wrong)} of {len(asked)}" + "".join(f", {name}" for name in wrong)
    goal = Goal(
        "certain answers where nothing is round", found, f"0 of {FEWEST} or more", not wrong and len(asked) >= FEWEST
    )
    return table(("what is there", "areas", "refused", "answered, not certain", "certain"), rows), [goal]


def _said_of(recordings: Path, method: Method, area: Area) -> str:
    try:
        said = answer(reconstruct(*area.load(recordings), Settings(method=method)))
    except DrawingError:
        return "refused"
    if said["kind"] is None:
        return "refused"
    return "certain" if said["certain"] else "not certain"

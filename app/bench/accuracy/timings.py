"""How long the measurement takes, beside what is asked of it."""

from dataclasses import replace

import cv2

from app.bench.accuracy.goals import Goal, mark
from app.bench.accuracy.recorded import RECORDINGS
from app.bench.frames import OBJECT_SHARE, task
from app.bench.stages import median_ms
from app.bench.table import table
from rotrecon.frame import Frame
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Method, Settings

ONE_KIND_MS = {10_000: 20.0, 100_000: 100.0}
"""By pixels of the object."""
WHOLE_MS = 100.0
RUNS = 15


def timing_table(tin: Frame | None, method: Method, runs: int = RUNS) -> tuple[str, list[Goal]]:
    """One kind on two sizes of an object, and all kinds on the recorded tin; medians on one thread."""
    settings, threads = Settings(method=method), cv2.getNumThreads()
    goals: list[Goal] = []
    cv2.setNumThreads(1)
    for pixels, limit_ms in ONE_KIND_MS.items():
        example = task(round(pixels / OBJECT_SHARE))
        drawing = replace(example.drawing, kind="cylinder")
        spent_ms = median_ms(lambda f=example.frame, d=drawing: reconstruct(f, d, settings), runs)
        goals.append(_goal(f"speed: one kind, {pixels} px of the object", spent_ms, limit_ms))
    if tin is not None:
        spent_ms = median_ms(lambda: reconstruct(tin, RECORDINGS[0].drawing, settings), runs)
        goals.append(_goal("speed: all kinds, recorded tin", spent_ms, WHOLE_MS))
    cv2.setNumThreads(threads)
    rows = [(goal.what.removeprefix("speed: "), goal.found, goal.asked, mark(goal.met)) for goal in goals]
    return table(("drawing to Reconstruction", "median", "asked", "reached"), rows), goals


def _goal(what: str, spent_ms: float, limit_ms: float) -> Goal:
    return Goal(what, f"{spent_ms:.0f} ms", f"<= {limit_ms:.0f} ms", spent_ms <= limit_ms)

"""How long the measurement takes, beside what is asked of it."""

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np

from app.bench.accuracy.goals import Goal, mark
from app.bench.accuracy.recorded import RECORDINGS
from app.bench.frames import OBJECT_SHARE, Task, task
from app.bench.stages import ROBUST, finished, median_ms
from app.bench.table import NONE, table
from rotrecon.frame import Frame
from rotrecon.rays.guard import Task as FitTask
from rotrecon.rays.guard import settle
from rotrecon.rays.hypotheses import Held, best_of, scene_of
from rotrecon.rays.patch import clear_depth, patch_of
from rotrecon.rays.starts import cylinder_starts
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Method, Settings

SURFACE_MS = {10_000: 20.0, 100_000: 100.0}
"""By pixels of the object."""
WHOLE_MS = 100.0
RUNS = 15


def timing_table(tin: Frame | None, method: Method, runs: int = RUNS) -> tuple[str, list[Goal]]:
    """One surface and one kind on two sizes of an object, all kinds on the recorded tin; medians on one thread."""
    settings, threads = Settings(method=method), cv2.getNumThreads()
    goals: list[Goal] = []
    told: list[tuple[str, ...]] = []
    cv2.setNumThreads(1)
    for pixels, limit_ms in SURFACE_MS.items():
        example = task(round(pixels / OBJECT_SHARE))
        drawing = replace(example.drawing, kind="cylinder")
        spent_ms = median_ms(_surface_fit(example), runs)
        goals.append(_goal(f"speed: one cylinder fitted to {pixels} px", spent_ms, limit_ms))
        spent_ms = median_ms(lambda f=example.frame, d=drawing: reconstruct(f, d, settings), runs)
        told.append((f"drawing to Reconstruction, a cylinder of {pixels} px", f"{spent_ms:.0f} ms", NONE, NONE))
    if tin is not None:
        spent_ms = median_ms(lambda: reconstruct(tin, RECORDINGS[0].drawing, settings), runs)
        goals.append(_goal("speed: drawing to Reconstruction, all kinds, recorded tin", spent_ms, WHOLE_MS))
    cv2.setNumThreads(threads)
    rows = [(goal.what.removeprefix("speed: "), goal.found, goal.asked, mark(goal.met)) for goal in goals]
    return table(("work", "median", "asked", "reached"), rows + told), goals


def _surface_fit(example: Task) -> Callable[[], object]:
    """A cylinder from its starts by the drawing to its covariance, on what segmentation left."""
    segmented = finished(example, ROBUST)
    frame, segments, kept = segmented.frame, segmented.segments, segmented.segmentation.kept
    patch = patch_of(frame, segmented.drawing.area, segments, kept)
    depth_m = clear_depth(frame.depth_m, segments.pixel).astype(np.float64)
    scene, held = scene_of(frame.camera, patch, segments, kept & np.isfinite(depth_m), depth_m), Held()

    def fit() -> object:
        points_m = (patch.rays[:, scene.pixels] * patch.depth_m[scene.pixels]).T
        coarse = best_of(scene, held, cylinder_starts(scene.ridge, points_m, None, patch.focal_px))
        found = settle(coarse, FitTask(patch, coarse.units(scene.length_m), held.free(coarse), ()))
        assert found is not None
        return found.covariance

    return fit


def _goal(what: str, spent_ms: float, limit_ms: float) -> Goal:
    return Goal(what, f"{spent_ms:.0f} ms", f"<= {limit_ms:.0f} ms", spent_ms <= limit_ms)

"""Drawings by a careless hand: how far the answer moves when an object is drawn badly, beside its own interval."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import cv2
import numpy as np

from app.bench.accuracy.clouds import CORRELATED, FULL_MODEL, Cell, cloud_of, pose_of
from app.bench.accuracy.outcome import TRUE_KINDS, radius_at
from app.bench.accuracy.trials import SUPERSAMPLING, in_processes
from rotrecon.arrays import Floats
from rotrecon.drawing import AreaOfInterest, Drawing, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.outcome import FitFailure
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Method, Settings
from rotrecon.simulation.ideal_drawing import MARGIN_PX

POSES = 40
"""Of each object."""
CELLS = (CORRELATED[0], FULL_MODEL)
TURN_RAD = float(np.radians(10.0))
SHORTER = 0.3
BESIDE = 0.2
"""Of the object's width."""
LARGER = 2.0
"""Area over area."""


def _turned(stroke: Floats, width_px: float) -> Floats:
    middle = stroke.mean(axis=0)
    cosine, sine = np.cos(TURN_RAD), np.sin(TURN_RAD)
    return middle + (stroke - middle) @ np.array([[cosine, sine], [-sine, cosine]])


def _shortened(stroke: Floats, width_px: float) -> Floats:
    return np.array([stroke[0], stroke[1] - SHORTER * (stroke[1] - stroke[0])])


def _beside(stroke: Floats, width_px: float) -> Floats:
    along = (stroke[1] - stroke[0]) / np.linalg.norm(stroke[1] - stroke[0])
    return stroke + BESIDE * width_px * np.array([-along[1], along[0]])


STROKES: dict[str, Callable[[Floats, float], Floats]] = {
    "axis 10 degrees off": _turned,
    "axis 30 % short": _shortened,
    "axis 20 % of the width beside": _beside,
}
AREA_TWICE = "area twice too large"
MISTAKES = (*STROKES, AREA_TWICE)


@dataclass(frozen=True)
class Movement:
    """What one mistake does to one object."""

    object_name: str
    cell: Cell
    mistake: str
    moved: float
    """Change of the diameter over the half width of its interval as drawn well; NaN where either was refused."""
    moved_percent: float
    """The same, of the diameter."""


def misdrawn(drawing: Drawing, width_px: float, size_px: tuple[int, int]) -> dict[str, Drawing]:
    """A good drawing of an object of a width, with one mistake each, on a frame of `size_px` (width, height)."""
    stroke = np.array([drawing.stroke.start_px, drawing.stroke.end_px])
    found: dict[str, Drawing] = {}
    for name, mistake in STROKES.items():
        (start, end), largest = mistake(stroke, width_px), np.array(size_px) - 1.0
        axis = ObjectAxis(tuple(np.clip(start, 0, largest)), tuple(np.clip(end, 0, largest)))
        found[name] = replace(drawing, axis=axis)
    found[AREA_TWICE] = replace(drawing, area=_larger(drawing.area, size_px))
    return found


def movements(method: Method, poses: int = POSES, processes: int | None = None) -> list[Movement]:
    """All mistakes on every object's first poses."""
    found = in_processes(partial(_of_pose, method), list(product(TRUE_KINDS, range(poses))), processes)
    return [movement for part in found for movement in part]


def moved_by_mistakes(
    frame: Frame, drawing: Drawing, width_px: float, settings: Settings
) -> dict[str, tuple[float, float]]:
    """Change of the diameter by each mistake, over the half width of its interval and over the diameter.

    The diameters are those at one place of the object, the middle of what was drawn well.
    """
    size_px = (frame.camera.width, frame.camera.height)
    good = reconstruct(frame, drawing, settings).fit
    found: dict[str, tuple[float, float]] = {}
    for name, bad in misdrawn(drawing, width_px, size_px).items():
        other = reconstruct(frame, bad, settings).fit
        if isinstance(good, FitFailure) or isinstance(other, FitFailure):
            found[name] = (np.nan, np.nan)
            continue
        place_m = good.solid.center_m
        diameter_m = 2 * radius_at(good.solid, place_m)
        moved_m = abs(2 * radius_at(other.solid, place_m) - diameter_m)
        low, high = (np.nan, np.nan) if good.intervals is None else good.intervals.diameter_m
        found[name] = (2 * moved_m / (high - low), moved_m / diameter_m)
    return found


def width_px(drawing: Drawing) -> float:
    """Mean width of an object whose area was drawn by an ideal hand, across its stroke."""
    corners = np.array(drawing.area.vertices_px, dtype=np.float32)
    start, end = np.array(drawing.stroke.start_px), np.array(drawing.stroke.end_px)
    along = corners @ (end - start) / np.linalg.norm(end - start)
    return float(cv2.contourArea(corners) / np.ptp(along)) - 2 * MARGIN_PX


def shares_within(part: Sequence[Movement]) -> float:
    """Share of movements that are less than the half width of the interval; what was refused is not."""
    return float(np.mean([movement.moved < 1 for movement in part]))


def _of_pose(method: Method, task: tuple[str, int]) -> list[Movement]:
    name, seed = task
    settings, found = Settings(method=method), list[Movement]()
    for cell in CELLS:
        pose = pose_of(name, seed, SUPERSAMPLING if cell == FULL_MODEL else 0)
        drawing = pose.simulated.drawing
        moved = moved_by_mistakes(cloud_of(pose, cell).frame, drawing, width_px(drawing), settings)
        found += [Movement(name, cell, mistake, *by) for mistake, by in moved.items()]
    return found


def _larger(area: AreaOfInterest, size_px: tuple[int, int]) -> AreaOfInterest:
    """A convex area grown about its middle, as far as the frame goes."""
    corners = np.array(area.vertices_px)
    middle, (width, height) = corners.mean(axis=0), size_px
    grown = middle + np.sqrt(LARGER) * (corners - middle)
    frame = np.array([[0, 0], [width - 1, 0], [width - 1, height - 1], [0, height - 1]])
    _, common = cv2.intersectConvexConvex(grown.astype(np.float32), frame.astype(np.float32))
    return AreaOfInterest(tuple((float(u), float(v)) for u, v in np.asarray(common).reshape(-1, 2)))

"""How long a measurement takes: from a drawing to the Reconstruction, and the paper's method stage by stage."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.bench.frames import Task
from rotrecon.axis import cut_in_space, fit_axis
from rotrecon.circles import base_points, circumcircles
from rotrecon.drawing import cut_sections
from rotrecon.outcome import Fit
from rotrecon.reconstruct import reconstruct, usable_depth
from rotrecon.reconstruction import Reconstruction
from rotrecon.sections.radii import SHAPES, fit_radii
from rotrecon.sections.section_fit import fit_solid
from rotrecon.segmentation import segment
from rotrecon.settings import Settings

PAPER, ROBUST = Settings(method="paper"), Settings(method="robust")
WARM_UPS = 3


@dataclass(frozen=True)
class Timing:
    """One thing that was timed."""

    name: str
    median_ms: float


def median_ms(work: Callable[[], object], runs: int) -> float:
    """Median duration of a piece of work, after warm-up."""
    for _ in range(WARM_UPS):
        work()
    durations: list[float] = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        durations.append(time.perf_counter() - start)
    return 1000 * float(np.median(durations))


def finished(task: Task, settings: Settings) -> Reconstruction:
    """The Reconstruction of a task that is known to succeed."""
    result = reconstruct(task.frame, task.drawing, settings)
    assert isinstance(result.fit, Fit), result.fit
    return result


def stage_timings(task: Task, runs: int) -> list[Timing]:
    """Each stage of the paper's method alone, on what the stages before it made of a task."""
    return [Timing(name, median_ms(work, runs)) for name, work in _stages(finished(task, PAPER)).items()]


def _stages(result: Reconstruction) -> dict[str, Callable[[], object]]:
    frame, drawing, segments = result.frame, result.drawing, result.segments
    kept, sections, first, second = result.segmentation.kept, result.sections, result.first_cut, result.second_cut
    assert sections is not None
    assert second is not None
    assert second.axis is not None
    depth_m, usable = usable_depth(frame, segments)
    circles, axis, pixel = second.circles, second.axis, segments.pixel[kept]
    along = axis.along(circles.center_m)
    ends_m = (float(np.nanmin(along)), float(np.nanmax(along)))
    curves = {shape: fit_radii(shape, along, circles.radius_m, circles.used, PAPER) for shape in SHAPES}
    cylinder = curves["cylinder"]
    assert cylinder is not None
    size_px = (frame.camera.width, frame.camera.height)
    return {
        "cross segments (3.1)": lambda: cut_sections(drawing.area, drawing.stroke, size_px),
        "segmentation (3.2)": lambda: segment(depth_m, usable, segments.inside, PAPER),
        "circles of the first cut (3.3)": lambda: circumcircles(
            *base_points(frame.points_m, segments.pixel, kept), PAPER
        ),
        "axis (3.4)": lambda: fit_axis(first.circles, PAPER),
        "one cut across the axis in space": lambda: cut_in_space(
            frame.points_m, pixel, axis, ends_m, len(circles.state)
        ),
        "its circles (3.3)": lambda: circumcircles(*sections.base_points(), PAPER),
        "curves through the radii (3.4, 3.5)": lambda: [
            fit_radii(shape, along, circles.radius_m, circles.used, PAPER) for shape in SHAPES
        ],
        "solid, its deviation and its arc": lambda: fit_solid(cylinder, None, axis, circles, sections, PAPER),
        "all, from drawing to Reconstruction": lambda: reconstruct(frame, drawing, PAPER),
    }

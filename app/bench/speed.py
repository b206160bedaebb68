"""The speed and size of the program beside what is asked of it."""

from collections.abc import Sequence

import numpy as np

from app.bench.frames import CAMERA, DIRECTIONS, WHOLE_FRAME, task
from app.bench.memory import frame_bytes, peak_bytes
from app.bench.stages import PAPER, ROBUST, finished, median_ms, stage_timings
from app.bench.table import table, verdict
from rotrecon.overlay import depth_colors, depth_range_m
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings

TARGET_PIXELS, PAPER_MS, ROBUST_MS = 10_000, 10.0, 100.0
TARGET_FRAMES = 3.0
SIZES = (1_000, 10_000, 100_000, 1_000_000, WHOLE_FRAME)
RUNS = 60
LARGEST_ROBUST = 100_000
"""Larger areas take seconds by the robust method."""
LONG_MS, LONG_RUNS = 50.0, 15
"""What takes long varies little from run to run."""
MEGABYTE = 1e6


def speed_report(sizes: Sequence[int] = SIZES, runs: int = RUNS, whole_frame: int = WHOLE_FRAME) -> str:
    """The figures of the library as text; a minute of work."""
    parts = [
        f"Frame of {CAMERA.width} x {CAMERA.height} px, medians after warm-up.",
        "By the robust method, from a drawing to the finished Reconstruction, by pixels in the area",
        _growth([size for size in sizes if size <= LARGEST_ROBUST], runs, ROBUST, ROBUST_MS),
        "By the paper's method",
        _growth(sizes, runs, PAPER, PAPER_MS),
        f"The paper's method stage by stage, {TARGET_PIXELS} px in the area",
        stage_table(runs),
        "Once a frame",
        _once_a_frame(runs),
        "Peak allocation of a reconstruction, the whole frame as area",
        _peaks(whole_frame),
    ]
    return "\n\n".join(parts)


def _growth(sizes: Sequence[int], runs: int, settings: Settings, target_ms: float) -> str:
    rows: list[tuple[str, ...]] = []
    pixels: list[int] = []
    times: list[float] = []
    for size in sizes:
        example = task(size)
        pixels.append(int(finished(example, settings).segments.inside.sum()))
        once_ms = median_ms(lambda e=example: reconstruct(e.frame, e.drawing, settings), 1)
        repeats = min(runs, LONG_RUNS) if once_ms > LONG_MS else runs
        times.append(median_ms(lambda e=example: reconstruct(e.frame, e.drawing, settings), repeats))
        target = verdict(times[-1], target_ms, "ms") if size == TARGET_PIXELS else ""
        per_pixel = f"{1e6 * times[-1] / pixels[-1]:.0f} ns"
        rows.append((f"{pixels[-1]}", f"{times[-1]:.2f} ms", per_pixel, f"{repeats}", target))
    text = table(("pixels", "median", "per pixel", "runs", "target"), rows)
    return f"{text}\n\n{_exponents(np.array(pixels), np.array(times))}"


def _exponents(pixels: np.ndarray, times: np.ndarray) -> str:
    """How time grows from the target's size on, where the fixed cost of a call does not hide it."""
    if len(pixels) < 2:
        return "one size says nothing about growth"
    exponent = np.polyfit(np.log(pixels), np.log(times), 1)[0]
    grown = pixels >= TARGET_PIXELS / 2
    text = f"time ~ pixels^{exponent:.2f} over all sizes"
    if grown.sum() >= 2:
        above = np.polyfit(np.log(pixels[grown]), np.log(times[grown]), 1)[0]
        text += f", pixels^{above:.2f} from {pixels[grown][0]} px on (target: linear, 1 or less)"
    return text


def stage_table(runs: int = RUNS) -> str:
    """Milliseconds of every stage at the target's size."""
    timings = stage_timings(task(TARGET_PIXELS), runs)
    return table(("stage", "median"), [(timing.name, f"{timing.median_ms:.2f} ms") for timing in timings])


def _once_a_frame(runs: int) -> str:
    frame = task(TARGET_PIXELS).frame
    repeats = min(runs, LONG_RUNS)
    work = {
        "cloud from depth": lambda: CAMERA.cloud(frame.depth_m),
        "range of the depth map": lambda: depth_range_m(frame.depth_m),
        "colours of the depth map": lambda: depth_colors(frame.depth_m, (1.0, 1.6)),
    }
    return table(("work", "median"), [(name, f"{median_ms(job, repeats):.1f} ms") for name, job in work.items()])


def _peaks(pixels: int) -> str:
    rows: list[tuple[str, ...]] = []
    for direction in DIRECTIONS:
        example = task(pixels, direction)
        frame = frame_bytes(example) / MEGABYTE
        for settings in (ROBUST, PAPER):
            peak = peak_bytes(example, settings) / MEGABYTE
            target = verdict(peak, TARGET_FRAMES * frame, "MB") if settings is PAPER else ""
            rows.append((direction, settings.method, f"{peak:.1f} MB", f"{peak / frame:.2f}", target))
    return table(("axis", "method", "peak", "times picture and cloud", "target"), rows)

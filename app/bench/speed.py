"""The speed and size of the program beside what is asked of it."""

from collections.abc import Sequence

import numpy as np

from app.bench.frames import CAMERA, DIRECTIONS, WHOLE_FRAME, task
from app.bench.memory import frame_bytes, peak_bytes
from app.bench.stages import finished, median_ms, stage_timings
from app.bench.table import table, verdict
from rotrecon.overlay import depth_colors, depth_range_m
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings

TARGET_PIXELS, TARGET_MS = 10_000, 10.0
TARGET_FRAMES = 3.0
SIZES = (1_000, 10_000, 100_000, 1_000_000, WHOLE_FRAME)
RUNS = 60
LARGE, LARGE_RUNS = 200_000, 15
"""Large areas vary little from run to run."""
MEGABYTE = 1e6


def speed_report(sizes: Sequence[int] = SIZES, runs: int = RUNS, whole_frame: int = WHOLE_FRAME) -> str:
    """The figures of the library as text; some seconds of work."""
    parts = [
        f"Frame of {CAMERA.width} x {CAMERA.height} px, medians after warm-up.",
        "From a drawing to the finished Reconstruction, by pixels in the area",
        _growth(sizes, runs),
        f"Stage by stage, {TARGET_PIXELS} px in the area",
        stage_table(runs),
        "Once a frame",
        _once_a_frame(runs),
        "Peak allocation of a reconstruction, the whole frame as area",
        _peaks(whole_frame),
    ]
    return "\n\n".join(parts)


def _growth(sizes: Sequence[int], runs: int) -> str:
    rows: list[tuple[str, ...]] = []
    pixels: list[int] = []
    times: list[float] = []
    for size in sizes:
        example = task(size)
        pixels.append(int(finished(example).segments.inside.sum()))
        settings = Settings()
        repeats = min(runs, LARGE_RUNS) if size > LARGE else runs
        times.append(median_ms(lambda e=example, s=settings: reconstruct(e.frame, e.drawing, s), repeats))
        target = verdict(times[-1], TARGET_MS, "ms") if size == TARGET_PIXELS else ""
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
    repeats = min(runs, LARGE_RUNS)
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
        limit = TARGET_FRAMES * frame_bytes(example) / MEGABYTE
        peak = peak_bytes(example) / MEGABYTE
        rows.append((direction, f"{peak:.1f} MB", f"{TARGET_FRAMES * peak / limit:.2f}", verdict(peak, limit, "MB")))
    return table(("axis", "peak", "times picture and cloud", "target"), rows)

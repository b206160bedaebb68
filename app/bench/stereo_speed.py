"""What matching two views takes beside the bare call of OpenCV's matcher with the same settings."""

import ctypes
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import cv2
import numpy as np

from app.bench.table import table, verdict
from rotrecon.drawing import AreaOfInterest
from rotrecon.simulation.stereo import simulate_views
from rotrecon.stereo.canvas import canvas_over, whole
from rotrecon.stereo.frames import area_frame, range_in, whole_frame, window_for
from rotrecon.stereo.matching import matcher_of
from rotrecon.stereo.preparing import Prepared, prepare
from rotrecon.workspace import Workspace

OBJECT, SEED = "leg", 0
TIMES, PEAK_TIMES, AREA_MS = 1.3, 1.5, 50.0
"""Targets: time and peak memory over the bare call's, and what an area may take beyond its share of that."""
MEGABYTE = 1e6
STATUS, RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")
"""Where Linux says how much memory the process has held at most, and where that is set back."""

MMAP_THRESHOLD, SMALL = -3, 1 << 16
"""glibc's M_MMAP_THRESHOLD, and bytes from which memory is then given back at once and not kept for the next call."""

Job = Callable[[], object]


def stereo_report(runs: int = 9) -> str:
    """Time and memory of matching a pair as text, on one thread; half a minute of work."""
    prepared, area = _scene()
    with ProcessPoolExecutor(1, get_context("spawn"), give_back_at_once) as process:
        peaks = process.submit(_peaks).result()
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        rows = _rows(prepared, area, runs, peaks)
    finally:
        cv2.setNumThreads(threads)
    camera = prepared.views[0].camera
    title = f"Matching two views of {camera.width} x {camera.height} px, on one thread, medians of the processor's time"
    return f"{title}\n\n{table(('work', 'median', 'target', 'peak memory', 'target'), rows)}"


def _scene() -> tuple[Prepared, AreaOfInterest]:
    scene = simulate_views(OBJECT, SEED)
    prepared = prepare(scene.views, Workspace())
    assert isinstance(prepared, Prepared)
    return prepared, scene.drawing.area


def _work(prepared: Prepared, area: AreaOfInterest) -> dict[str, Job]:
    camera = prepared.views[0].camera
    everywhere = AreaOfInterest.rectangle((0, 0), (camera.width, camera.height))
    return {
        "bare matcher call": bare_call(prepared),
        "the whole frame at full resolution": lambda: area_frame(prepared, everywhere),
        f"an area again, {100 * _share(prepared, area):.0f} % of the frame": lambda: area_frame(prepared, area),
        "the whole frame at half resolution": lambda: whole_frame(prepared),
        "once a scene: features, poses, where surfaces are": lambda: prepare(prepared.views, Workspace()),
    }


def _share(prepared: Prepared, area: AreaOfInterest) -> float:
    camera = prepared.views[0].camera
    return float(np.ptp(np.array(area.vertices_px), axis=0).prod()) / (camera.width * camera.height)


def _rows(prepared: Prepared, area: AreaOfInterest, runs: int, peaks: list[float]) -> list[tuple[str, ...]]:
    work, share = _work(prepared, area), _share(prepared, area)
    times = [cpu_ms(job, runs) for job in work.values()]
    again = verdict(times[2], round(share * times[0] + AREA_MS), "ms")
    targets = ["", verdict(times[1], round(TIMES * times[0]), "ms"), again, "", ""]
    peak_targets = ["", verdict(peaks[1], round(PEAK_TIMES * peaks[0]), "MB"), "", "", ""]
    return [
        (name, f"{took_ms:.0f} ms", target, f"{peak:.0f} MB", peak_target)
        for name, took_ms, target, peak, peak_target in zip(work, times, targets, peaks, peak_targets, strict=True)
    ]


def bare_call(prepared: Prepared) -> Job:
    """OpenCV's matcher on the pictures as they were taken, over the disparities of the whole frame."""
    camera, pair = prepared.views[0].camera, prepared.pairs[0]
    window_px = window_for(AreaOfInterest.rectangle((0, 0), (camera.width, camera.height)))
    canvas = canvas_over(pair.rectification, whole(camera), 1.0, range_in(pair, whole(camera)))
    first, second = (cv2.cvtColor(prepared.views[number].image, cv2.COLOR_RGB2GRAY) for number in (0, pair.number))
    return lambda: matcher_of(canvas, window_px).compute(first, second)


def cpu_ms(work: Job, runs: int) -> float:
    """Median time of the processor, which other processes do not lengthen, for work on one thread; after warm-up."""
    work()
    durations: list[float] = []
    for _ in range(runs):
        start = time.process_time()
        work()
        durations.append(time.process_time() - start)
    return 1000 * float(np.median(durations))


def give_back_at_once() -> None:
    """Let this process hold what is in use and no more.

    It has to be told before it does anything: memory that came from glibc's heap goes back there, and later work then
    counts, or does not count, what earlier work has left lying there.
    """
    ctypes.CDLL(None).mallopt(MMAP_THRESHOLD, SMALL)


def _peaks() -> list[float]:
    """Peak memory of all work, MB, in a process that gives memory back at once."""
    cv2.setNumThreads(1)
    return [peak_bytes(job) / MEGABYTE for job in _work(*_scene()).values()]


def peak_bytes(work: Job) -> int:
    """Most memory of the process while something is done, above what it held before."""
    work()
    ctypes.CDLL(None).malloc_trim(0)
    RESET.write_text("5")
    before = _status("VmRSS")
    work()
    return _status("VmHWM") - before


def _status(field: str) -> int:
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith(field))
    return 1024 * int(line.split()[1])

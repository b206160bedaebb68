"""How much memory a reconstruction takes."""

import tracemalloc

from app.bench.frames import Task
from app.bench.stages import finished
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings


def peak_bytes(task: Task, settings: Settings) -> int:
    """Most memory that `reconstruct` holds at once on a loaded frame, after a first run."""
    finished(task, settings)
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        reconstruct(task.frame, task.drawing, settings)
        return tracemalloc.get_traced_memory()[1] - before
    finally:
        tracemalloc.stop()


def frame_bytes(task: Task) -> int:
    """The picture and the float32 cloud."""
    return task.frame.image.nbytes + task.frame.points_m.nbytes

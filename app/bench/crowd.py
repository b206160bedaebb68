"""How soon twenty pages have all of a drawing, and how memory grows while it is drawn anew and anew."""

import gc
import json
import resource
import subprocess
import sys
import time
from base64 import b64encode
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np

from app.bench.served import Served
from app.bench.table import table, verdict
from app.bench.wire import drag_message
from app.console_items import FromPage
from app.drawing_steps import HISTORY_LENGTH
from app.events import PointerDragged
from app.object_drawing import Pixel
from rotrecon.arrays import Floats

PAGES = 20
RELEASES, CHANGES = 60, 2000
WARM_UP = 3
MOVES = 5
"""Of the pointer between press and release."""
HAND_PX = 4.0
"""How far one stroke is from another: each has to be measured anew."""
SETTLED = HISTORY_LENGTH + 100
"""Changes before memory is looked at: what can be undone is kept."""
LATENCY_TARGET_MS, GROWTH_TARGET = 200.0, 5.0
OPEN_S = 60.0


@dataclass(frozen=True, eq=False)
class Released:
    """What came of N releases."""

    seconds: Floats
    """(N,) from the release to the last message that any page has got."""
    bytes: Floats
    """(N,) that all pages have got."""
    cpu_s: float
    """Of the server, for all of it."""


class Pages:
    """The process with the pages."""

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        self._process, self.drawer = process, 0
        """Number of the page that draws."""

    def told(self) -> object:
        """What it says next."""
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("the pages have ended before their time")
        return json.loads(line)

    def drag(self, house: Served, start: Pixel, end: Pixel, *, shift: bool) -> dict[str, float]:
        """Drag on the first page, and wait until all have everything: what has come of it since the release."""
        frame, places = house.simulated.frame, np.linspace(start, end, MOVES)
        steps = [("start", start), *(("update", tuple(place)) for place in places), ("end", end)]
        messages = [drag_message(frame, str(self.drawer), phase, start, here, shift=shift) for phase, here in steps]
        lines = [b64encode(msgspec.msgpack.encode(message)).decode() for message in messages]
        self._say(lines)
        self.told()
        house.console.wait_until_idle()
        self._say([])
        answer = self.told()
        assert isinstance(answer, dict)
        return answer

    def _say(self, messages: list[str]) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(messages) + "\n")
        self._process.stdin.flush()


@contextmanager
def crowd(house: Served, count: int) -> Iterator[Pages]:
    """So many pages, the first of them in control, with an area drawn."""
    _wait_for(house, 0)
    command = [sys.executable, "-m", "app.bench.crowd_pages", house.door.address, house.cookie, str(count)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        try:
            pages = Pages(process)
            assert pages.told() == "open"
            _wait_for(house, count)
            pages.drawer = min(house.console.pages)
            house.give_control(pages.drawer)
            corners = np.array(house.simulated.drawing.area.vertices_px)
            pages.drag(house, tuple(corners.min(axis=0)), tuple(corners.max(axis=0)), shift=False)
            yield pages
        finally:
            process.kill()


def releases(house: Served, count: int, pages_open: int = PAGES) -> Released:
    """Strokes on the area, each a little off the others."""
    rng, found, started = np.random.default_rng(0), list[dict[str, float]](), 0.0
    with crowd(house, pages_open) as pages:
        for number in range(WARM_UP + count):
            started = time.process_time() if number <= WARM_UP else started
            found.append(pages.drag(house, *_stroke(house, rng), shift=True))
            if not house.console.session.up_to_date or house.console.session.reconstruction is None:
                raise RuntimeError("the console did not measure what was drawn")
        cpu_s = time.process_time() - started
    found = found[WARM_UP:]
    return Released(np.array([one["seconds"] for one in found]), np.array([one["bytes"] for one in found]), cpu_s)


def growth(house: Served, changes: int) -> tuple[float, float]:
    """Resident memory, MB, after the first changes and after so many more, of a console with a page that reads."""
    rng = np.random.default_rng(1)
    with crowd(house, 1) as pages:
        held: list[float] = []
        for count in (SETTLED, changes):
            for _ in range(count):
                event = FromPage(pages.drawer, PointerDragged(*_stroke(house, rng), shift=True))
                house.console.server.get_event_loop().call_soon_threadsafe(house.console.post, event)
                house.console.wait_until_idle()
            if not house.console.session.measured_once:
                raise RuntimeError("the console did not measure what was drawn")
            gc.collect()
            held.append(_resident_mb())
    return held[0], held[1]


def _stroke(house: Served, rng: np.random.Generator) -> tuple[Pixel, Pixel]:
    drawn = house.simulated.drawing.stroke
    start, end = np.array([drawn.start_px, drawn.end_px]) + rng.uniform(-HAND_PX, HAND_PX, (2, 2))
    return (float(start[0]), float(start[1])), (float(end[0]), float(end[1]))


def _wait_for(house: Served, count: int) -> None:
    end = time.monotonic() + OPEN_S
    while len(house.console.pages) != count:
        if time.monotonic() > end:
            raise RuntimeError(f"{len(house.console.pages)} pages are open, and not {count}")
        time.sleep(0.05)
    house.console.wait_until_idle()


def _resident_mb() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 2**20


def crowd_report(house: Served, count: int = RELEASES, changes: int = CHANGES) -> str:
    """The figures as text; some minutes of work."""
    found = releases(house, count)
    before_mb, after_mb = growth(house, changes)
    worst, grown = 1000 * float(np.percentile(found.seconds, 95)), 100 * (after_mb / before_mb - 1)
    rows = [
        ("release to the last message on any page, median", f"{1000 * float(np.median(found.seconds)):.0f} ms", ""),
        ("the same, 95th percentile", f"{worst:.0f} ms", verdict(worst, LATENCY_TARGET_MS, "ms")),
        ("sent to one page for a release", f"{np.mean(found.bytes) / PAGES / 1000:.0f} kB", ""),
        ("the server's CPU for a drag with its release", f"{1000 * found.cpu_s / count:.0f} ms", ""),
        (f"memory after {SETTLED} changes of drawing", f"{before_mb:.0f} MB", ""),
        (f"after {changes} more", f"{after_mb:.0f} MB, {grown:+.1f} %", verdict(grown, GROWTH_TARGET, "%")),
    ]
    return f"{PAGES} pages through the door, method `paper`\n\n{table(('figure', 'measured', 'target'), rows)}"

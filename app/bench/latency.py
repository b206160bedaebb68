"""How soon the console answers: from the release of the pointer to the last message about it."""

import time
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from app.bench.poses import CAMERA, STEREO
from app.bench.wire import WirePage
from app.clock import seconds
from app.console import Console
from app.console_items import FromPage
from app.deciding.events import ControlTaken
from app.object_drawing import Pixel
from app.record.store import Record
from rotrecon.arrays import Floats
from rotrecon.settings import Method, Settings
from rotrecon.simulation.simulate import Simulated, simulate

OBJECT = "leg"
UPDATES = 5
"""Moves of the pointer between press and release."""
MOVE_S = 1 / 60
HAND_PX = 4.0
"""How far one stroke is from another: each has to be measured anew."""
QUIET_S = 0.15
"""Nothing sent for so long after the console is idle: there is nothing more to come."""
OPENED_S = 1.0


@dataclass(frozen=True, eq=False)
class Latency:
    """Seconds (N,) from releases to the last message about each."""

    durations_s: Floats

    def percentile_ms(self, percent: float) -> float:
        """A percentile in milliseconds."""
        return 1000 * float(np.percentile(self.durations_s, percent))


def release_latency(releases: int, method: Method) -> Latency:
    """Draw an area and then strokes on it, over a web socket; every release measures the object anew by a method."""
    simulated = simulate(OBJECT, 0, CAMERA, STEREO, supersampling=1)
    with TemporaryDirectory() as folder, closing(Record.open(Path(folder))) as record:
        console = Console(simulated.frame, OBJECT, Settings(method=method), port=0, record=record)
        console.start()
        try:
            page = WirePage(console.address, 0, simulated.frame)
            try:
                return Latency(_strokes(console, page, simulated, releases))
            finally:
                page.close()
        finally:
            console.stop()


def _strokes(console: Console, page: WirePage, simulated: Simulated, releases: int) -> Floats:
    page.last_departure_s(OPENED_S)
    take_control = ControlTaken(seconds(), page.client_id)
    console.server.get_event_loop().call_soon_threadsafe(console.post, FromPage(page.client_id, take_control))
    console.wait_until_idle()
    corners = np.array(simulated.drawing.area.vertices_px)
    _drag(console, page, tuple(corners.min(axis=0)), tuple(corners.max(axis=0)), shift=False)
    rng = np.random.default_rng(0)
    stroke = np.array([simulated.drawing.stroke.start_px, simulated.drawing.stroke.end_px])
    durations: list[float] = []
    for _ in range(releases):
        start, end = stroke + rng.uniform(-HAND_PX, HAND_PX, (2, 2))
        durations.append(_drag(console, page, tuple(start), tuple(end), shift=True))
        if not console.session.up_to_date or console.session.reconstruction is None:
            raise RuntimeError("the console did not measure what was drawn")
    return np.array(durations)


def _drag(console: Console, page: WirePage, start: Pixel, end: Pixel, *, shift: bool) -> float:
    """Seconds from the release, when it is sent, to the last message that left the server."""
    page.drag("start", start, start, shift=shift)
    for share in np.linspace(0.0, 1.0, UPDATES):
        here = tuple(np.array(start) + share * np.subtract(end, start))
        page.drag("update", start, here, shift=shift)
        time.sleep(MOVE_S)
    page.last_departure_s(QUIET_S)
    released = time.perf_counter()
    page.drag("end", start, end, shift=shift)
    departure = page.last_departure_s(QUIET_S)
    console.wait_until_idle()
    return (page.last_departure_s(QUIET_S) or departure or released) - released

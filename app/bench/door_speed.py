"""What the guarded door adds to a message: the same round trips beside it and through it."""

import secrets
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np
import viser
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from app.door.door import Door
from app.door.hidden_viser import TICKET, HiddenViser
from app.door.listening import listen
from app.door.people import Visitor
from rotrecon.arrays import Floats

SMALL, LARGE = 100, 100_000
"""Bytes that come back: a number of the result, and a frame's picture."""
QUIET_S = 0.3
"""Nothing sent for so long: the page's beginning is over."""
PATIENCE_S = 10.0
WARM_UP = 20


@dataclass(frozen=True, eq=False)
class DoorLatency:
    """Seconds (N,) of round trips, a message there and one back."""

    beside_s: Floats
    through_s: Floats

    def added_ms(self, percent: float) -> float:
        """Milliseconds that the door adds to one message, between the two at a percentile."""
        return 500 * float(np.percentile(self.through_s, percent) - np.percentile(self.beside_s, percent))


def door_latency(count: int, size: int) -> DoorLatency:
    """Round trips to viser, by turns beside the door and through it, of which `size` bytes come back."""
    hidden = HiddenViser()
    server = hidden.open()
    with tempfile.TemporaryDirectory() as place:
        people = Path(place) / "users.json"
        door = Door(hidden, people, listen("127.0.0.1", 0, people, None))
        door.start()
        try:
            visit = hidden.expect(Visitor("bench", "operator"))
            cookie = f"{door.gate.cookie}={door.gate.passes.issue('bench', by_link=True)}"
            beside = _open(hidden.uri, {TICKET: visit.ticket})
            through = _open(door.address.replace("http", "ws", 1), {"Cookie": cookie, "Origin": door.address})
            with beside, through:
                return _measure(server, beside, through, count, size)
        finally:
            door.stop()
            server.stop()


def _measure(
    server: viser.ViserServer, beside: ClientConnection, through: ClientConnection, count: int, size: int
) -> DoorLatency:
    """Both pages get every answer, so each is waited for on both, and timed on the one that asked."""
    command, answer = server.gui.add_command("ask"), server.gui.add_html("")

    @command.on_trigger
    async def answered(_: object) -> None:
        answer.content = secrets.token_hex(size // 2)
        server.flush()

    ask = msgspec.msgpack.encode({"type": "CommandTriggerMessage", "uuid": command._impl.uuid})
    _drain(beside)
    _drain(through)
    durations: dict[ClientConnection, list[float]] = {beside: [], through: []}
    for _ in range(count + WARM_UP):
        for asking, other in ((beside, through), (through, beside)):
            started = time.perf_counter()
            asking.send(ask)
            asking.recv(PATIENCE_S)
            durations[asking].append(time.perf_counter() - started)
            other.recv(PATIENCE_S)
    return DoorLatency(*(np.array(durations[page][WARM_UP:]) for page in (beside, through)))


def _open(uri: str, headers: dict[str, str]) -> ClientConnection:
    page = connect(
        uri,
        additional_headers=headers,
        subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
        compression=None,
        max_size=None,
        proxy=None,
    )
    camera = {"wxyz": (1, 0, 0, 0), "position": (0, 0, 0), "look_at": (0, 0, 1), "up_direction": (0, -1, 0)}
    size = {"fov": 1.0, "near": 0.01, "far": 100.0, "image_height": 720, "image_width": 1280}
    page.send(msgspec.msgpack.encode({"type": "ViewerCameraMessage", **camera, **size}))
    return page


def _drain(page: ClientConnection) -> None:
    try:
        while True:
            page.recv(QUIET_S)
    except TimeoutError:
        return

"""Pages whose connection stays open: one that answers keeps control, and one that does not loses it."""

from collections.abc import Iterator
from contextlib import closing
from math import inf
from pathlib import Path

import msgspec
import numpy as np
import pytest
import zstandard

from app.bench.wire import HEADER_BYTES, WirePage
from app.clock import seconds
from app.console import Console
from app.console_items import FromPage
from app.deciding.events import ControlTaken
from app.deciding.settings import DecisionSettings
from app.heartbeat import QUESTIONS, Heartbeat
from app.record.store import Record
from rotrecon.settings import Settings
from tests.exact import cylinder, exact_frame
from tests.waiting import WAIT_S, until

SILENT_S = 1.2
FRAME = exact_frame(cylinder(np.array([0.0, 0.0, 0.8]), np.array([0.0, 1.0, 0.0]), 0.06))


@pytest.fixture
def console(tmp_path: Path) -> Iterator[Console]:
    with closing(Record.open(tmp_path)) as record:
        limits = DecisionSettings(silent_s=SILENT_S)
        console = Console(FRAME, "A rod", Settings(), port=0, cloud_points=10, record=record, deciding=limits)
        console.start()
        yield console
        console.stop()


def in_control(console: Console) -> WirePage:
    page = WirePage(console.address, 0, FRAME)
    until(lambda: bool(console.pages))
    take = FromPage(page.client_id, ControlTaken(seconds(), page.client_id))
    console.server.get_event_loop().call_soon_threadsafe(console.post, take)
    until(lambda: console.told.decision.control.holder == page.client_id)
    return page


def asked(batch: bytes) -> bool:
    """Whether a batch of viser's asks the page for its camera."""
    compressed = int.from_bytes(batch[8:HEADER_BYTES], "little")
    inner = zstandard.ZstdDecompressor().decompress(batch[HEADER_BYTES : HEADER_BYTES + compressed])
    return any(message["type"] == "SetCameraFovMessage" for message in msgspec.msgpack.decode(inner)["messages"])


def test_a_page_that_answers_keeps_control_until_it_does_not(console: Console) -> None:
    page, answers, since = in_control(console), 0, seconds()
    while answers < QUESTIONS or seconds() < since + 2 * SILENT_S:
        batch = page._socket.recv(WAIT_S)
        assert isinstance(batch, bytes)
        if asked(batch):
            page._send_camera()
            answers += 1
    assert console.told.decision.control.holder == page.client_id
    until(lambda: console.told.decision.control.holder is None)
    assert page.client_id in console.server.get_clients(), "its connection is open"
    assert "did not answer" in console.told.decision.said[-1].text
    page.close()


class Asked(dict[int, object]):
    """Clients that count how often they are asked."""

    def __init__(self, *numbers: int) -> None:
        super().__init__()
        self.messages: list[object] = []
        self.camera, self.fov, self._websock_connection = self, 1.0, self
        self.update(dict.fromkeys(numbers, self))

    def queue_message(self, message: object) -> None:
        self.messages.append(message)


def test_only_the_one_in_control_is_asked_and_not_too_often() -> None:
    heartbeat, clients = Heartbeat(20.0), Asked(1, 2)
    for now in np.arange(100.0, 120.0, 0.5):
        heartbeat.ask(1, float(now), clients)  # type: ignore[arg-type]
    assert len(clients.messages) == QUESTIONS
    heartbeat.ask(None, 200.0, clients)  # type: ignore[arg-type]
    heartbeat.ask(3, 200.0, clients)  # type: ignore[arg-type]
    assert len(clients.messages) == QUESTIONS
    Heartbeat(inf).ask(1, 1e9, clients)  # type: ignore[arg-type]
    assert len(clients.messages) == QUESTIONS

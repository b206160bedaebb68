"""A console behind a door with the robot's side, for tests of it."""

from io import BytesIO
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import httpx
import numpy as np
from websockets.sync.client import ClientConnection, connect

from app.clock import seconds
from app.console import Console
from app.console_items import FromPage
from app.deciding.events import ControlTaken, PageCame
from app.door.door import Door
from app.door.hidden_viser import HiddenViser
from app.door.listening import listen
from app.events import Event, PointerDragged
from app.record.store import Record
from app.robot.api import robot_routes
from app.robot.cell import ConsoleCell
from rotrecon.settings import Settings
from tests.door.conftest import SECRET
from tests.exact import cylinder, exact_frame

SOLID = cylinder(np.array([0.0, 0.0, 0.8]), np.array([0.0, 1.0, 0.0]), 0.06)
NOBODYS = -1
"""Number of a page that no browser has opened."""
DRAWN = (PointerDragged((130.0, 40.0), (190.0, 200.0)), PointerDragged((160.0, 60.0), (160.0, 180.0), shift=True))


def post(console: Console, *events: Event) -> None:
    """Have events come from a page that is in control."""
    for event in (PageCame(seconds(), NOBODYS, "Ann"), ControlTaken(seconds(), NOBODYS), *events):
        console.server.get_event_loop().call_soon_threadsafe(console.post, FromPage(NOBODYS, event))


class Cell:
    """A console behind a door, with the robot's side."""

    def __init__(self, people: Path) -> None:
        hidden = HiddenViser()
        frame = exact_frame(SOLID)
        self.record = Record.open(people.parent / "record")
        self.console = Console(frame, "A rod", Settings(), cloud_points=10, open_viser=hidden.open, record=self.record)
        self.console.start()
        self.door = Door(hidden, people, listen("127.0.0.1", 0, people, None))
        cell = ConsoleCell(self.console)
        self.door.start(robot_routes(cell, self.door.gate, self.door.guard))
        self.address = f"{self.door.address}/api/v1"

    def client(self, name: str, secret: str = SECRET) -> httpx.Client:
        return httpx.Client(base_url=self.address, auth=(name, secret), trust_env=False)

    def stream(self, **headers: str) -> ClientConnection:
        uri = f"{self.address.replace('http', 'ws', 1)}/decision/stream"
        return connect(uri, additional_headers=headers, proxy=None)

    def post(self, *events: Event) -> None:
        post(self.console, *events)

    def do(self, *events: Event) -> None:
        self.post(*events)
        self.console.wait_until_idle()

    def stop(self) -> None:
        self.door.stop()
        self.console.stop()
        self.record.close()


def zipped(folder: Path) -> bytes:
    packed = BytesIO()
    with ZipFile(packed, "w", ZIP_DEFLATED) as archive:
        for path in sorted(folder.rglob("*")):
            archive.write(path, path.relative_to(folder))
    return packed.getvalue()

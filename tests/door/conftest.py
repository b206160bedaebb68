"""A door before a small viser, and people who log in."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import msgspec
import numpy as np
import pytest
import viser
from argon2 import PasswordHasher
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from app.door import people as people_module
from app.door.door import Door
from app.door.hidden_viser import HiddenViser
from app.door.listening import listen
from app.door.people import Role, with_person, write_people
from tests.waiting import until

SECRET = "ten letters or more"
PEOPLE: dict[str, Role] = {"Anna": "operator", "Walt": "watcher", "arm": "robot"}
CAMERA: dict[str, Any] = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [0.0, 0.0, 0.0],
    "fov": 1.0,
    "near": 0.01,
    "far": 100.0,
    "image_height": 600,
    "image_width": 800,
    "look_at": [0.0, 0.0, 1.0],
    "up_direction": [0.0, -1.0, 0.0],
}


@pytest.fixture(scope="session", autouse=True)
def cheap_hashes() -> Iterator[None]:
    """Argon2 takes its time on purpose; tests of the door do not ask how much."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(people_module, "HASHER", PasswordHasher(time_cost=1, memory_cost=8, parallelism=1))
        yield


@pytest.fixture(scope="session")
def people(tmp_path_factory: pytest.TempPathFactory, cheap_hashes: None) -> Path:
    path, everybody = tmp_path_factory.mktemp("people") / "users.json", {}
    for name, role in PEOPLE.items():
        everybody = with_person(everybody, name, role, SECRET)
    write_people(path, everybody)
    return path


@dataclass(eq=False)
class House:
    """A small viser with one of each control, behind a door."""

    door: Door
    server: viser.ViserServer
    controls: dict[str, Any]
    heard: list[str]
    """What has reached a callback."""

    def log_in(self, name: str, secret: str = SECRET) -> httpx.Response:
        with httpx.Client(trust_env=False) as client:
            form = {"name": name, "secret": secret}
            return client.post(f"{self.door.address}/login", data=form, headers={"Origin": self.door.address})

    def cookie(self, name: str) -> str:
        """What a browser sends back after logging in."""
        return self.log_in(name).headers["set-cookie"].split(";")[0]

    def socket(self, cookie: str = "", origin: str | None = None) -> ClientConnection:
        headers = {"Cookie": cookie} if cookie else {}
        return connect(
            self.door.address.replace("http", "ws", 1),
            additional_headers={**headers, "Origin": origin or self.door.address},
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            max_size=None,
            proxy=None,
        )

    def page(self, name: str) -> "WirePage":
        return WirePage(self, self.socket(self.cookie(name)))


class WirePage:
    """A page that says whatever a test wants it to say."""

    def __init__(self, house: House, socket: ClientConnection) -> None:
        known = set(house.server.get_clients())
        self.house, self._socket, self._beat = house, socket, 0
        self.say(**CAMERA)
        until(lambda: bool(set(house.server.get_clients()) - known))
        (self.client_id,) = set(house.server.get_clients()) - known

    def say(self, **message: Any) -> None:
        self.send(msgspec.msgpack.encode(message))

    def send(self, raw: bytes | str) -> None:
        self._socket.send(raw)

    def heard_out(self) -> None:
        """Return when everything said so far has been looked at: messages keep their order."""
        self._beat += 1
        self.say(**CAMERA | {"position": [float(self._beat), 0.0, 0.0]})
        client = self.house.server.get_clients()[self.client_id]
        until(lambda: client.camera.position[0] == self._beat)

    def close(self) -> None:
        self._socket.close()


@pytest.fixture(scope="session")
def house(people: Path) -> Iterator[House]:
    hidden = HiddenViser()
    server = hidden.open()
    heard: list[str] = []
    controls = _controls(server, heard)
    commands = [controls["look"]]
    door = Door(hidden, people, listen("127.0.0.1", 0, people, None), camera_commands=commands)
    door.start()
    yield House(door, server, controls, heard)
    door.stop()
    server.stop()


def _controls(server: viser.ViserServer, heard: list[str]) -> dict[str, Any]:
    gui = server.gui
    controls: dict[str, Any] = {
        "slider": gui.add_slider("slider", 0, 100, 5, 20),
        "number": gui.add_number("number", 1.5, min=0.0, max=10.0),
        "text": gui.add_text("text", "before"),
        "dropdown": gui.add_dropdown("dropdown", ("a", "b")),
        "group": gui.add_button_group("group", ("In", "Out")),
        "checkbox": gui.add_checkbox("checkbox", False),
        "vector2": gui.add_vector2("vector2", (1.0, 2.0), min=(0.0, 0.0), max=(9.0, 9.0)),
        "vector3": gui.add_vector3("vector3", (1.0, 2.0, 3.0)),
        "rgb": gui.add_rgb("rgb", (1, 2, 3)),
        "multi": gui.add_multi_slider("multi", 0, 10, 1, (2, 5)),
        "button": gui.add_button("button"),
        "disabled": gui.add_button("disabled", disabled=True),
        "disabled slider": gui.add_slider("disabled slider", 0, 9, 1, 3, disabled=True),
        "hidden": gui.add_button("hidden", visible=False),
        "upload": gui.add_upload_button("upload"),
        "progress": gui.add_progress_bar(10.0),
    }
    for name, handle in controls.items():
        if name not in ("progress", "upload"):
            clickable = name in ("group", "button", "disabled", "hidden")
            listen_to = handle.on_click if clickable else handle.on_update
            listen_to(lambda _, name=name: heard.append(name))
    for name in ("button", "disabled"):
        controls[name].on_hold(lambda _, name=name: heard.append(f"{name} held"), callback_hz=10)
    controls["look"], controls["act"] = gui.add_command("look"), gui.add_command("act")
    controls["off"] = gui.add_command("off", disabled=True)
    for name in ("look", "act", "off"):
        controls[name].on_trigger(lambda _, name=name: heard.append(name))
    image = server.scene.add_image("/picture", np.zeros((2, 2, 3), np.uint8), 1.0, 1.0)
    image.on_click(lambda _: heard.append("clicked"))
    image.on_drag("left")(lambda _: heard.append("dragged"))
    return controls

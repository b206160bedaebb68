"""A thousand forged messages to a console that is being worked on: is each refused and counted, and nothing changed?"""

import time
from copy import copy
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from app.bench.forgeries import (
    Control,
    acts,
    attributes,
    disabled,
    malformed,
    not_numbers,
    other_types,
    packed,
    some,
    wrong_values,
)
from app.bench.served import Served
from app.bench.table import table
from app.bench.wire import camera_message, drag_message
from app.door.messages import Allowed

PATIENCE_S = 30.0
FORBIDDEN = 403


@dataclass(frozen=True)
class Tried:
    """What came of one sort of forgery."""

    what: str
    sent: int
    refused: int
    """Counted by the door as such."""
    changed: bool
    """Whether anything is different after them."""

    @property
    def good(self) -> bool:
        """Whether each was refused and nothing has changed."""
        return self.refused == self.sent and not self.changed


class Page:
    """An open page that sends whatever it is told to."""

    def __init__(self, house: Served, cookie: str) -> None:
        before = set(house.console.server.get_clients())
        self._house, self._beat = house, 0
        self._socket = _connected(house, cookie, house.door.address)
        self._socket.send(packed(camera_message()))
        _until(lambda: len(set(house.console.server.get_clients()) - before) == 1)
        (self.client_id,) = set(house.console.server.get_clients()) - before
        _until(lambda: self.client_id in house.console.pages)

    def send(self, messages: list[bytes]) -> None:
        """Send all of them, and return when they have been looked at: messages keep their order."""
        for message in messages:
            self._socket.send(message)
        self._beat += 1
        self._socket.send(packed(camera_message() | {"near": float(self._beat)}))
        camera = self._house.console.server.get_clients()[self.client_id].camera
        _until(lambda: camera.near == self._beat)
        self._house.console.wait_until_idle()

    def close(self) -> None:
        """Leave."""
        self._socket.close()


def forge(house: Served) -> list[Tried]:
    """All of it, while an object is drawn and its tool is proposed to the page in control."""
    operator, watcher = Page(house, house.cookie), Page(house, house.watchers_cookie)
    house.give_control(operator.client_id)
    _draw(house, operator)
    controls, frame, rng = _controls(house, operator), house.simulated.frame, np.random.default_rng(0)
    allowed = {kind.__name__ for kind in get_args(Allowed)}
    owned = str(watcher.client_id)
    found = [
        _tried(house, what, some(messages, count, rng), operator)
        for what, messages, count in (
            ("types that no page sends", other_types(allowed), 200),
            ("attributes of controls", attributes(controls), 150),
            ("values out of a control's range", wrong_values(controls), 150),
            ("to controls that are disabled or hidden", disabled(controls), 100),
            ("not a number, infinite or far away", not_numbers(frame), 100),
            ("noise, cut off or changed", malformed(rng, frame), 100),
        )
    ]
    found.append(_tried(house, "from a watcher", some(acts(controls, frame, owned), 100, rng), watcher))
    address = house.door.address
    for what, cookie, origin in (
        ("from a page of another site", house.cookie, "http://example.org"),
        ("without a pass", "", address),
        ("with a forged pass", house.cookie[:-3], address),
    ):
        found.append(_turned_away(house, what, cookie, origin, 34 if cookie == "" else 33))
    for page in (operator, watcher):
        page.close()
    return found


def _tried(house: Served, what: str, messages: list[bytes], page: Page) -> Tried:
    before, refused = _state(house), house.door.guard.refused.total()
    page.send(messages)
    return Tried(what, len(messages), house.door.guard.refused.total() - refused, _state(house) != before)


def _turned_away(house: Served, what: str, cookie: str, origin: str, count: int) -> Tried:
    before, refused = _state(house), house.door.guard.refused.total()
    for _ in range(count):
        try:
            _connected(house, cookie, origin).close()
        except InvalidStatus as error:
            if error.response.status_code != FORBIDDEN:
                raise
    return Tried(what, count, house.door.guard.refused.total() - refused, _state(house) != before)


def _state(house: Served) -> dict[str, Any]:
    """All that a message could change: the session but for its clock, the record, and every control of every page."""
    session, server = house.console.session, house.console.server
    guis = {"all": server.gui} | {number: client.gui for number, client in server.get_clients().items()}
    controls = {
        (name, uuid): {**vars(copy(handle._impl)), "props": dict(vars(handle._impl.props))}
        for name, gui in guis.items()
        for uuid, handle in gui._gui_input_handle_from_uuid.items()
    }
    nodes = {name: dict(client.scene._handle_from_node_name) for name, client in server.get_clients().items()}
    decision = replace(session.decision, now=0.0, control=replace(session.decision.control, heard=0.0))
    pages = {number: page.state for number, page in house.console.pages.items()}
    return {"session": replace(session, decision=decision), "controls": controls, "nodes": nodes, "pages": pages}


def _draw(house: Served, page: Page) -> None:
    corners = np.array(house.simulated.drawing.area.vertices_px)
    start, end = ((float(u), float(v)) for u, v in (corners.min(axis=0), corners.max(axis=0)))
    steps = (("start", start, start), ("update", start, end), ("end", start, end))
    owner = str(page.client_id)
    page.send([packed(drag_message(house.simulated.frame, owner, phase, a, b)) for phase, a, b in steps])
    if house.console.session.decision.case is None:
        raise RuntimeError("nothing was proposed of what was drawn")


def _controls(house: Served, page: Page) -> list[Control]:
    server = house.console.server
    own = server.get_clients()[page.client_id].gui
    return [*server.gui._gui_input_handle_from_uuid.items(), *own._gui_input_handle_from_uuid.items()]


def _connected(house: Served, cookie: str, origin: str) -> ClientConnection:
    return connect(
        house.door.address.replace("http", "ws", 1),
        additional_headers={"Cookie": cookie, "Origin": origin},
        subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
        compression=None,
        max_size=None,
        proxy=None,
    )


def _until(condition: Any) -> None:
    end = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > end:
            raise RuntimeError("the console does not answer any more")
        time.sleep(0.01)


def forged_report(found: list[Tried]) -> str:
    """The figures as text."""
    rows = [(one.what, str(one.sent), str(one.refused), "YES" if one.changed else "no") for one in found]
    sent, refused = sum(one.sent for one in found), sum(one.refused for one in found)
    rows.append(("all", str(sent), str(refused), "no" if all(one.good for one in found) else "MISSED"))
    return table(("forged", "sent", "refused and counted", "anything changed"), rows)

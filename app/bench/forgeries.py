"""Messages that no page of this program sends, by what is wrong with them."""

from collections.abc import Mapping
from math import inf, nan
from typing import Any

import msgspec
import numpy as np
from viser import _messages as viser_messages

from app.bench.wire import camera_message, drag_message
from rotrecon.frame import Frame

ATTRIBUTES = (
    "update_cb",
    "sync_cb",
    "uuid",
    "props",
    "is_button",
    "removed",
    "gui_api",
    "parent_container_id",
    "label",
)
"""Of a control: viser sets whatever a page names."""
WRONG: tuple[object, ...] = (nan, inf, -inf, 1e300, -1e300, 10**15, b"a", {"a": 1}, [[1.0], 2.0], "x" * 5000, None)
"""Values that no control of any kind can have."""
FORGED_UUID = "00000000-0000-0000-0000-000000000000"
FAR_M = 1e9
"""Beyond any scene."""
Control = tuple[str, Any]
"""The name on the wire, and viser's handle."""


def packed(message: object) -> bytes:
    """As a page packs it."""
    return msgspec.msgpack.encode(message)


def other_types(allowed: set[str]) -> list[bytes]:
    """Every type that viser knows and no page may send, empty and with what a control's message has."""
    names = sorted({kind.__name__ for kind in viser_messages.Message.get_subclasses()} - allowed)
    return [packed({"type": name, **more}) for more in ({}, {"uuid": FORGED_UUID, "name": "/"}) for name in names]


def attributes(controls: list[Control]) -> list[bytes]:
    """Anything but the value of a control."""
    return [packed(_update(uuid, {name: []})) for name in ATTRIBUTES for uuid, _ in controls]


def wrong_values(controls: list[Control]) -> list[bytes]:
    """Values that the control does not have."""
    return [packed(_update(uuid, {"value": value})) for value in WRONG for uuid, _ in controls]


def disabled(controls: list[Control]) -> list[bytes]:
    """What would be right if the control could be used."""
    found: list[bytes] = []
    for uuid, handle in controls:
        if getattr(handle, "disabled", True) or not handle.visible:
            value = True if not hasattr(handle, "value") else handle.value
            found += [packed(_update(uuid, {"value": value})), packed(_hold(uuid)), packed(_command(uuid))]
    return found


def not_numbers(frame: Frame) -> list[bytes]:
    """Numbers that are none, or too large, wherever a page says where something is."""
    camera, drag = camera_message(), drag_message(frame, "", "update", (10.0, 10.0), (20.0, 20.0))
    found: list[bytes] = []
    for bad in (nan, inf, -inf, FAR_M, -FAR_M):
        for message in (camera, drag):
            for name, value in message.items():
                if isinstance(value, float):
                    found.append(packed(message | {name: bad}))
                elif isinstance(value, tuple):
                    found += [packed(message | {name: (*value[:n], bad, *value[n + 1 :])}) for n in range(len(value))]
    return found


def malformed(rng: np.random.Generator, frame: Frame) -> list[bytes]:
    """Bytes that are no message: noise, and messages cut off, wrapped, or with bytes changed."""
    found: list[bytes] = []
    for message in (packed(camera_message()), packed(drag_message(frame, "", "end", (1.0, 1.0), (2.0, 2.0)))):
        for end in rng.integers(1, len(message), 30):
            found += [rng.bytes(int(end)), message[:end], message.replace(b"Message", rng.bytes(7), 1)]
        found.append(packed([msgspec.msgpack.decode(message)]))
    return found


def acts(controls: list[Control], frame: Frame, owner: str) -> list[bytes]:
    """What an operator may do, and a watcher may not."""
    drags = [packed(drag_message(frame, owner, phase, (50.0, 50.0), (90.0, 90.0))) for phase in ("start", "end")]
    updates = [_update(uuid, {"value": getattr(handle, "value", True)}) for uuid, handle in controls]
    return drags + [packed(message) for message in (*updates, *(_hold(uuid) for uuid, _ in controls))]


def some(messages: list[bytes], count: int, rng: np.random.Generator) -> list[bytes]:
    """So many of them, each as often as any other."""
    order = rng.permutation(len(messages))
    return [messages[order[number % len(messages)]] for number in range(count)]


def _update(uuid: str, updates: Mapping[str, object]) -> dict[str, object]:
    return {"type": "GuiUpdateMessage", "uuid": uuid, "updates": dict(updates)}


def _hold(uuid: str) -> dict[str, object]:
    return {"type": "GuiButtonHoldMessage", "uuid": uuid, "frequency": 10.0}


def _command(uuid: str) -> dict[str, object]:
    return {"type": "CommandTriggerMessage", "uuid": uuid}

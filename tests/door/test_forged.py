"""Forged messages over real sockets: nothing changes, nothing breaks, each is refused and counted."""

from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from viser import _messages as viser_messages
from websockets.exceptions import InvalidStatus

from app.bench import forgeries
from app.door.controls import fits
from tests.door.conftest import CAMERA, House
from tests.door.test_messages import CLICK, COMMAND, DRAG, GOOD, HOLD, UPDATE, packed
from tests.exact import cylinder, exact_frame
from tests.waiting import until

COMMANDS = ("look", "act", "off")
SOLID = cylinder(np.array([0.0, 0.0, 0.8]), np.array([0.0, 1.0, 0.0]), 0.06)


def state(house: House) -> dict[str, Any]:
    """All that a page could have changed."""
    found = {}
    for name, handle in house.controls.items():
        inner = dict(vars(handle._impl))
        props = vars(inner.pop("props"))
        found[name] = (
            {key: list(value) if isinstance(value, list) else value for key, value in inner.items()},
            dict(props),
        )
    nodes = dict(house.server.scene._handle_from_node_name)
    return {"controls": found, "nodes": nodes, "heard": list(house.heard)}


def uuid_of(house: House, name: str) -> str:
    return house.controls[name]._impl.uuid


def forged(house: House) -> list[Any]:
    """What no page of an operator says, and what might be accepted if somebody had forgotten to look."""
    uuids = {name: uuid_of(house, name) for name in house.controls}
    attributes = ("update_cb", "sync_cb", "uuid", "props", "is_button", "removed", "gui_api", "parent_container_id")
    sent: list[Any] = [{"type": kind.__name__} for kind in viser_messages.Message.get_subclasses()]
    sent = [message for message in sent if message["type"] not in {good["type"] for good in GOOD}]
    sent += [UPDATE | {"uuid": uuids["slider"], "updates": {name: []}} for name in attributes]
    sent += [UPDATE | {"uuid": uuids["slider"], "updates": {"value": 30, "update_cb": []}}]
    wrong: dict[str, tuple[Any, ...]] = {
        "slider": (nan, inf, -1, 101, 20.5, "20", None, [20], True, {"a": 1}, 10**15),
        "number": (-0.1, 10.1, nan, "1", None, []),
        "text": ("a" * 5000, 3, None, ["a"], b"a"),
        "dropdown": ("c", 1, None, ["a"], ""),
        "group": ("Sideways", 0, None),
        "checkbox": (1, "yes", None, [True]),
        "vector2": ([1.0], [1.0, 2.0, 3.0], [1.0, nan], [-1.0, 2.0], "ab", None, [10.0, 1.0], [[1.0], 2.0]),
        "vector3": ([1.0, 2.0], [1e9, 0.0, 0.0], None, {}),
        "rgb": ([1, 2], [1, 2, 256], [1.5, 2, 3], "red"),
        "multi": ([2], [2, 11], [2, "5"], 3),
        "button": (False, 1, None, "true"),
        "disabled": (True,),
        "disabled slider": (4,),
        "hidden": (True,),
        "upload": (True, {"name": "a", "content": b"b"}, None),
        "progress": (50.0,),
    }
    sent += [
        UPDATE | {"uuid": uuids[n], "updates": {"value": value}} for n, values in wrong.items() for value in values
    ]
    sent += [HOLD | {"uuid": uuids[name]} for name in ("disabled", "hidden", "slider", "look")]
    sent += [COMMAND | {"uuid": uuids[name]} for name in ("off", "button")]
    sent += [good | {"uuid": "nobody"} for good in (UPDATE, HOLD, COMMAND)]
    sent += [good | {"owner": "4711"} for good in (CLICK, DRAG)]
    sent += [good | {"type": "viser"} for good in GOOD] + [{}, [], 3, "text", None, {"type": 3}, [CAMERA]]
    sent += [CAMERA | {"position": [nan, 0.0, 0.0]}, CAMERA | {"fov": inf}, CAMERA | {"extra": 1}]
    return sent


def test_an_operators_page_can_do_only_what_its_controls_can(house: House) -> None:
    page = house.page("Anna")
    before, refused = state(house), house.door.guard.refused.total()
    sent = forged(house)
    for message in sent:
        page.send(packed(message))
    page.send("text instead of bytes")
    page.heard_out()
    page.close()
    assert state(house) == before
    assert house.door.guard.refused.total() - refused == len(sent) + 1


def test_what_the_benchmark_forges_is_refused(house: House) -> None:
    page, rng, frame = house.page("Anna"), np.random.default_rng(0), exact_frame(SOLID)
    before, refused = state(house), house.door.guard.refused.total()
    controls = [(handle._impl.uuid, handle) for name, handle in house.controls.items() if name not in COMMANDS]
    sorts = [
        forgeries.other_types({good["type"] for good in GOOD}),
        forgeries.attributes(controls),
        forgeries.wrong_values(controls),
        forgeries.disabled(controls),
        forgeries.not_numbers(frame),
        forgeries.malformed(rng, frame),
    ]
    sent = [message for sort in sorts for message in forgeries.some(sort, 20, rng)]
    for message in sent:
        page.send(message)
    page.heard_out()
    assert state(house) == before
    assert house.door.guard.refused.total() - refused == len(sent)
    page.close()
    page = house.page("Walt")
    before, refused = state(house), house.door.guard.refused.total()
    for message in (acts := forgeries.acts(controls, frame, str(page.client_id))):
        page.send(message)
    page.heard_out()
    assert state(house) == before
    assert house.door.guard.refused.total() - refused == len(acts)
    page.close()


def test_a_watchers_page_moves_its_camera_and_nothing_else(house: House) -> None:
    page = house.page("Walt")
    before, refused = state(house), house.door.guard.refused.total()
    sent = forged(house)
    sent += [COMMAND | {"uuid": uuid_of(house, "act")}, HOLD | {"uuid": uuid_of(house, "button")}, CLICK, DRAG]
    sent += [UPDATE | {"uuid": uuid_of(house, name), "updates": {"value": value}} for name, value in ALLOWED.items()]
    for message in sent:
        page.send(packed(message))
    page.heard_out()
    assert state(house) == before
    assert house.door.guard.refused.total() - refused == len(sent)
    assert house.door.guard.refused["only watching"] > 10
    page.say(**COMMAND | {"uuid": uuid_of(house, "look")})
    until(lambda: house.heard[len(before["heard"]) :] == ["look"])
    page.close()


ALLOWED: dict[str, Any] = {
    "slider": 25,
    "number": 3,
    "text": "after",
    "dropdown": "b",
    "group": "Out",
    "checkbox": True,
    "vector2": [3, 4.5],
    "vector3": [-3.0, 0, 7],
    "rgb": [255, 0, 7],
    "multi": [3, 4],
    "button": True,
}


@pytest.mark.parametrize("name", ALLOWED)
def test_what_a_control_can_be_set_to_passes(house: House, name: str) -> None:
    page = house.page("Anna")
    handle, heard = house.controls[name], house.heard.count(name)
    before = handle.value
    page.say(**UPDATE | {"uuid": uuid_of(house, name), "updates": {"value": ALLOWED[name]}})
    until(lambda: house.heard.count(name) == heard + 1)
    value = handle.value
    assert (list(value) if isinstance(value, tuple) else value) == ALLOWED[name] or name == "button"
    handle.value = before
    page.close()


def test_holds_clicks_drags_and_commands_pass(house: House) -> None:
    page = house.page("Anna")
    heard = len(house.heard)
    page.say(**HOLD | {"uuid": uuid_of(house, "button")})
    page.say(**COMMAND | {"uuid": uuid_of(house, "act")})
    page.say(**CLICK)
    page.say(**DRAG | {"modifier": None})
    until(lambda: sorted(house.heard[heard:]) == ["act", "button held", "clicked", "dragged"])
    page.close()


VALUES = st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.lists(st.integers() | st.floats())


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    value=st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.lists(st.integers() | st.floats())
)
def test_whatever_fits_can_be_cast_by_viser_and_stays_in_range(house: House, value: Any) -> None:
    for name, handle in house.controls.items():
        if name in COMMANDS or not fits(handle, value):
            continue
        low, high = getattr(handle, "min", None), getattr(handle, "max", None)
        if isinstance(value, int | float) and not isinstance(value, bool) and low is not None and high is not None:
            assert low <= type(handle.value)(value) <= high


def test_nobody_connects_without_the_own_page_and_a_pass(house: House) -> None:
    before, refused = state(house), house.door.guard.refused.copy()
    cookie, address = house.cookie("Anna"), house.door.address
    robot = house.door.gate.cookie + "=" + house.door.gate.passes.issue("arm")
    other_port = address.rsplit(":", 1)[0] + ":1"
    origins = ("http://example.org", "null", address.replace("http", "https"), f"{address}.example.org", other_port)
    tries = [(cookie, origin) for origin in origins]
    tries += [("", address), ("rotrecon=forged", address), (cookie[:-2], address), (robot, address)]
    for carried, origin in tries:
        with pytest.raises(InvalidStatus) as refusal:
            house.socket(carried, origin)
        assert refusal.value.response.status_code == 403
    refused.update({"foreign origin": len(origins), "not logged in": 4})
    assert house.door.guard.refused == refused
    assert state(house) == before

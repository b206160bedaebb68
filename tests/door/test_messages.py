"""Shapes of messages: anything that is not exactly what a page sends is refused, and never more than refused."""

from copy import deepcopy
from math import inf, nan
from typing import Any

import msgspec
import pytest
import viser._messages as viser_messages
from hypothesis import given, settings
from hypothesis import strategies as st
from viser.infra import Message

from app.door.messages import LARGEST_BYTES, Unacceptable, finite, read_message, written
from tests.door.conftest import CAMERA

CLICK: dict[str, Any] = {
    "type": "SceneNodeClickMessage",
    "name": "/picture",
    "instance_index": None,
    "ray_origin": [0.0, 0.0, 0.0],
    "ray_direction": [0.0, 0.0, 1.0],
    "screen_pos": [0.5, 0.5],
    "modifier": None,
    "owner": "",
}
DRAG: dict[str, Any] = {
    "type": "SceneNodeDragMessage",
    "phase": "start",
    "name": "/picture",
    "instance_index": None,
    "start_position": [0.0, 0.0, 1.0],
    "start_screen_pos": [0.5, 0.5],
    "end_position": [0.0, 0.0, 1.0],
    "end_screen_pos": [0.5, 0.5],
    "button": "left",
    "modifier": "shift",
    "owner": "",
}
UPDATE: dict[str, Any] = {"type": "GuiUpdateMessage", "uuid": "some", "updates": {"value": 3}}
HOLD: dict[str, Any] = {"type": "GuiButtonHoldMessage", "uuid": "some", "frequency": 10}
COMMAND: dict[str, Any] = {"type": "CommandTriggerMessage", "uuid": "some"}
GOOD = (CAMERA, CLICK, DRAG, UPDATE, HOLD, COMMAND)
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text(max_size=8) | st.binary(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=8,
)


def packed(message: object) -> bytes:
    return msgspec.msgpack.encode(message)


@pytest.mark.parametrize("message", GOOD, ids=lambda message: message["type"])
def test_what_a_page_sends_is_let_through_as_it_is(message: dict[str, Any]) -> None:
    passed = written(read_message(packed(message)))
    assert msgspec.msgpack.decode(passed) == message | {"type": message["type"]}
    assert type(viser_messages.Message.deserialize(passed)).__name__ == message["type"]


def test_every_other_type_that_viser_knows_is_refused() -> None:
    allowed = {message["type"] for message in GOOD}
    others = {kind.__name__ for kind in viser_messages.Message.get_subclasses()} - allowed
    assert {"FileTransferStartUpload", "FileTransferPart", "ShareUrlRequest", "RunJavascriptMessage"} <= others
    for name in sorted(others):
        for message in ({"type": name}, {"type": name, "uuid": "some"}, UPDATE | {"type": name}):
            with pytest.raises(Unacceptable, match="type not allowed"):
                read_message(packed(message))


def test_the_types_are_those_of_this_viser_field_by_field() -> None:
    kinds: dict[str, type[Message]] = {kind.__name__: kind for kind in viser_messages.Message.get_subclasses()}
    for message in GOOD:
        assert set(message) - {"type"} == set(kinds[message["type"]].__dataclass_fields__) - {"excluded_self_client"}


@settings(max_examples=300)
@given(raw=st.binary(max_size=200) | ANYTHING.map(packed) | st.text(max_size=20))
def test_noise_is_refused_and_nothing_else(raw: bytes | str) -> None:
    with pytest.raises(Unacceptable):
        read_message(raw)


@st.composite
def spoiled(draw: st.DrawFn) -> dict[str, Any]:
    """A good message of which one field is something else, is missing, or is one too many."""
    message = deepcopy(draw(st.sampled_from(GOOD)))
    field = draw(st.sampled_from([*message, "more"]))
    if field in message and draw(st.booleans()):
        del message[field]
    else:
        message[field] = draw(ANYTHING)
    return message


@settings(max_examples=400)
@given(message=spoiled())
def test_a_spoiled_message_is_refused_or_still_one_that_viser_reads(message: dict[str, Any]) -> None:
    try:
        passed = written(read_message(packed(message)))
    except Unacceptable:
        return
    assert finite(msgspec.msgpack.decode(passed))
    viser_messages.Message.deserialize(passed)


@pytest.mark.parametrize("wrong", [nan, inf, -inf, 1e7, -1e300])
@pytest.mark.parametrize(
    ("message", "field"),
    [(message, field) for message in GOOD for field in message if isinstance(message[field], list)],
)
def test_every_number_of_every_vector_is_finite_and_in_range(message: dict[str, Any], field: str, wrong: float) -> None:
    for index in range(len(message[field])):
        spoilt = deepcopy(message)
        spoilt[field][index] = wrong
        with pytest.raises(Unacceptable):
            read_message(packed(spoilt))


@pytest.mark.parametrize(
    ("field", "wrong"),
    [
        ("fov", 0.0),
        ("fov", -1.0),
        ("fov", nan),
        ("fov", 4.0),
        ("near", 0.0),
        ("far", inf),
        ("image_width", 0),
        ("image_height", -3),
        ("image_width", 1 << 40),
        ("wxyz", [1.0, 0.0, 0.0]),
        ("position", "here"),
        ("position", {"x": 1.0}),
    ],
)
def test_a_camera_that_cannot_be_is_refused(field: str, wrong: object) -> None:
    with pytest.raises(Unacceptable):
        read_message(packed(CAMERA | {field: wrong}))


def test_numbers_hidden_in_a_value_are_looked_at_too() -> None:
    for value in (nan, [1.0, inf], {"a": [nan]}, [[[-inf]]]):
        with pytest.raises(Unacceptable, match="not finite"):
            read_message(packed(UPDATE | {"updates": {"value": value}}))


def test_what_is_too_large_or_too_deep_is_refused() -> None:
    with pytest.raises(Unacceptable, match="too large"):
        read_message(packed(UPDATE | {"updates": {"value": "a" * LARGEST_BYTES}}))
    with pytest.raises(Unacceptable):
        read_message(packed(UPDATE)[:-1] + b"\x91" * 50_000 + b"\x00")


def test_a_field_given_twice_reaches_viser_once() -> None:
    twice = packed({"type": "CommandTriggerMessage", "uuid": "some"})
    twice = b"\x83" + twice[1:] + packed("uuid") + packed("other")
    assert msgspec.msgpack.decode(written(read_message(twice))) == {"type": "CommandTriggerMessage", "uuid": "other"}

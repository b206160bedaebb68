"""What a page may say to viser: every type and shape that is let through, and nothing else."""

from math import isfinite
from typing import Annotated, Any, Literal

from msgspec import Meta, MsgspecError, Struct, ValidationError
from msgspec.msgpack import Decoder, Encoder

LARGEST_BYTES = 1 << 16
"""Of one message: a drag takes 400; a text of a person's own some thousand."""
FARTHEST = 1e6
"""Metres from the base, or canvas widths from the pointer: more than any scene and any screen has."""
LARGEST_CANVAS_PX = 1 << 15

Number = Annotated[float, Meta(ge=-FARTHEST, le=FARTHEST)]
Vector = tuple[Number, Number, Number]
OnScreen = tuple[Number, Number]
Pixels = Annotated[float, Meta(ge=1.0, le=LARGEST_CANVAS_PX)]
Distance = Annotated[float, Meta(gt=0.0, le=FARTHEST)]
Identifier = Annotated[str, Meta(min_length=1, max_length=64)]
NodeName = Annotated[str, Meta(min_length=1, max_length=256)]
Owner = Annotated[str, Meta(max_length=20)]
Modifier = (
    Literal["cmd/ctrl", "alt", "shift", "cmd/ctrl+alt", "cmd/ctrl+shift", "alt+shift", "cmd/ctrl+alt+shift"] | None
)
Instance = Annotated[int, Meta(ge=0, le=1 << 31)] | None


class Message(Struct, tag_field="type", forbid_unknown_fields=True, frozen=True):
    """One message; its name is viser's."""


class ViewerCameraMessage(Message, tag="ViewerCameraMessage", frozen=True):
    """The page's camera has moved, or its canvas has another size."""

    wxyz: tuple[Number, Number, Number, Number]
    position: Vector
    fov: Annotated[float, Meta(gt=0.0, lt=3.15)]
    near: Distance
    far: Distance
    image_height: Pixels
    image_width: Pixels
    look_at: Vector
    up_direction: Vector


class GuiUpdateMessage(Message, tag="GuiUpdateMessage", frozen=True):
    """A control was set or a button clicked."""

    uuid: Identifier
    updates: Annotated[dict[str, Any], Meta(min_length=1, max_length=1)]


class GuiButtonHoldMessage(Message, tag="GuiButtonHoldMessage", frozen=True):
    """A button is being held."""

    uuid: Identifier
    frequency: Annotated[float, Meta(gt=0.0, le=1000.0)]


class CommandTriggerMessage(Message, tag="CommandTriggerMessage", frozen=True):
    """A key was pressed that stands for a command."""

    uuid: Identifier


class SceneNodeClickMessage(Message, tag="SceneNodeClickMessage", frozen=True):
    """Something in the scene was clicked."""

    name: NodeName
    instance_index: Instance
    ray_origin: Vector
    ray_direction: Vector
    screen_pos: OnScreen
    modifier: Modifier
    owner: Owner = ""


class SceneNodeDragMessage(Message, tag="SceneNodeDragMessage", frozen=True):
    """Something in the scene is being dragged."""

    phase: Literal["start", "update", "end"]
    name: NodeName
    instance_index: Instance
    start_position: Vector
    start_screen_pos: OnScreen
    end_position: Vector
    end_screen_pos: OnScreen
    button: Literal["left", "middle", "right"]
    modifier: Modifier
    owner: Owner = ""


Allowed = (
    ViewerCameraMessage
    | GuiUpdateMessage
    | GuiButtonHoldMessage
    | CommandTriggerMessage
    | SceneNodeClickMessage
    | SceneNodeDragMessage
)
_decoder = Decoder(Allowed)
_encoder = Encoder()


class Unacceptable(Exception):
    """A message that is not let through; the message is the reason that it is counted under."""


def read_message(raw: bytes | str) -> Allowed:
    """The message. Raises Unacceptable for any other type, shape or number."""
    if not isinstance(raw, bytes):
        raise Unacceptable("text instead of bytes")
    if len(raw) > LARGEST_BYTES:
        raise Unacceptable("too large")
    try:
        message = _decoder.decode(raw)
    except ValidationError as error:
        raise Unacceptable("type not allowed" if "$.type" in str(error) else "malformed") from error
    except (MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise Unacceptable("malformed") from error
    if not finite(message):
        raise Unacceptable("not finite")
    return message


def written(message: Allowed) -> bytes:
    """The message anew, so that viser reads exactly what was looked at here."""
    return _encoder.encode(message)


def finite(value: object) -> bool:
    """Whether no number in it is infinite or not a number, which compare as if they were in range."""
    if isinstance(value, float):
        return isfinite(value)
    if isinstance(value, Struct):
        return all(finite(getattr(value, name)) for name in value.__struct_fields__)
    if isinstance(value, dict):
        return all(map(finite, value.values()))
    return all(map(finite, value)) if isinstance(value, list | tuple) else True

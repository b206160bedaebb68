"""Whether a page may do what it asks of a control: set its value, within its range, while it is enabled."""

from collections.abc import Collection, Sequence
from typing import Any, TypeGuard

from viser import (
    CommandHandle,
    GuiButtonGroupHandle,
    GuiButtonHandle,
    GuiCheckboxHandle,
    GuiDropdownHandle,
    GuiMultiSliderHandle,
    GuiNumberHandle,
    GuiRgbaHandle,
    GuiRgbHandle,
    GuiSliderHandle,
    GuiTextHandle,
    GuiVector2Handle,
    GuiVector3Handle,
    ViserServer,
)

from app.door.messages import FARTHEST, Unacceptable

LONGEST_TEXT = 4000
"""Characters of a reason that a person types."""
BRIGHTEST = 255


class Controls:
    """What viser knows of the controls that a page can see: everybody's and its own."""

    def __init__(self, server: ViserServer, camera_commands: Collection[CommandHandle] = ()) -> None:
        """`camera_commands` move the camera of the page they come from and do nothing else."""
        self._server = server
        self._camera_commands = {command._impl.uuid for command in camera_commands}

    def moves_camera(self, uuid: str) -> bool:
        """Whether it is a command that anybody may give who may look."""
        return uuid in self._camera_commands

    def check_update(self, client_id: int, uuid: str, updates: dict[str, Any]) -> None:
        """Raise Unacceptable unless one enabled control's value is set to one that it can have."""
        handle = self._find("_gui_input_handle_from_uuid", client_id, uuid)
        if handle is None:
            raise Unacceptable("no such control")
        if set(updates) != {"value"}:
            raise Unacceptable("not a value")
        if _disabled(handle):
            raise Unacceptable("disabled")
        if not fits(handle, updates["value"]):
            raise Unacceptable("value out of range")

    def check_hold(self, client_id: int, uuid: str) -> None:
        """Raise Unacceptable unless it is an enabled button."""
        handle = self._find("_gui_input_handle_from_uuid", client_id, uuid)
        if not isinstance(handle, GuiButtonHandle):
            raise Unacceptable("no such control")
        if _disabled(handle):
            raise Unacceptable("disabled")

    def check_command(self, client_id: int, uuid: str) -> None:
        """Raise Unacceptable unless it is an enabled command."""
        command = self._find("_command_handle_from_uuid", client_id, uuid)
        if command is None:
            raise Unacceptable("no such control")
        if command.disabled:
            raise Unacceptable("disabled")

    def _find(self, registry: str, client_id: int, uuid: str) -> Any:
        """Viser has no public way from a name on the wire to a control."""
        shared = getattr(self._server.gui, registry).get(uuid)
        if shared is not None:
            return shared
        client = self._server.get_clients().get(client_id)
        return None if client is None else getattr(client.gui, registry).get(uuid)


def fits(handle: Any, value: object) -> bool:
    """Whether a page's own control could have given this value; what no page should set is never fitting."""
    match handle:
        case GuiButtonHandle():
            return value is True
        case GuiCheckboxHandle():
            return isinstance(value, bool)
        case GuiTextHandle():
            return isinstance(value, str) and len(value) <= LONGEST_TEXT
        case GuiDropdownHandle() | GuiButtonGroupHandle():
            return isinstance(value, str) and value in handle.options
        case GuiSliderHandle() | GuiNumberHandle():
            return _number(value, handle.min, handle.max, whole=isinstance(handle.value, int))
        case GuiVector2Handle() | GuiVector3Handle():
            count = len(handle.value)
            low, high = handle.min or (None,) * count, handle.max or (None,) * count
            return _sequence(value, count) and all(map(_number, value, low, high))
        case GuiMultiSliderHandle():
            return _sequence(value, len(handle.value)) and all(_number(x, handle.min, handle.max) for x in value)
        case GuiRgbHandle() | GuiRgbaHandle():
            return _sequence(value, len(handle.value)) and all(_number(x, 0, BRIGHTEST, whole=True) for x in value)
        case _:
            return False


def _sequence(value: object, count: int) -> TypeGuard[Sequence[object]]:
    return isinstance(value, Sequence) and not isinstance(value, str | bytes) and len(value) == count


def _number(value: object, low: float | None, high: float | None, whole: bool = False) -> bool:
    if isinstance(value, bool) or not isinstance(value, int if whole else int | float):
        return False
    return (-FARTHEST if low is None else low) <= value <= (FARTHEST if high is None else high)


def _disabled(handle: Any) -> bool:
    """Also what is hidden, and what is shown only, such as a bar of progress."""
    return bool(getattr(handle, "disabled", True)) or not handle.visible

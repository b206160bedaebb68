"""What each page may do: a watcher moves its own camera and nothing else, an operator what the controls can."""

import logging
from collections import Counter
from collections.abc import Callable
from typing import assert_never

from app.door.controls import Controls
from app.door.hidden_viser import Visit
from app.door.messages import (
    Allowed,
    CommandTriggerMessage,
    GuiButtonHoldMessage,
    GuiUpdateMessage,
    SceneNodeClickMessage,
    SceneNodeDragMessage,
    Unacceptable,
    ViewerCameraMessage,
    read_message,
    written,
)

WATCHING = "only watching"
log = logging.getLogger(__name__)


class Guard:
    """Lets messages of pages through to viser, or drops and counts them."""

    def __init__(self, controls: Controls, tell_watcher: Callable[[int], None] = lambda client_id: None) -> None:
        """`tell_watcher` says on a page why what was done there changes nothing."""
        self._controls, self._tell_watcher = controls, tell_watcher
        self.refused: Counter[str] = Counter()
        """How many messages and connections were refused, by reason."""

    def passed(self, visit: Visit, raw: bytes | str) -> bytes | None:
        """The message for viser, or None when it is refused."""
        try:
            message = read_message(raw)
            self._check(visit, message)
        except Unacceptable as error:
            self.refuse(str(error), visit.visitor.name)
            if str(error) == WATCHING and visit.client_id is not None:
                self._tell_watcher(visit.client_id)
            return None
        return written(message)

    def refuse(self, reason: str, name: str = "somebody") -> None:
        """Count what was refused; the log has the first of each kind, so that nobody can flood it."""
        self.refused[reason] += 1
        if self.refused[reason] == 1:
            log.warning("refused from %s: %s", name, reason)

    def _moves_camera(self, message: Allowed) -> bool:
        return isinstance(message, CommandTriggerMessage) and self._controls.moves_camera(message.uuid)

    def _check(self, visit: Visit, message: Allowed) -> None:
        if isinstance(message, ViewerCameraMessage):
            return
        if visit.visitor.role != "operator" and not self._moves_camera(message):
            raise Unacceptable(WATCHING)
        if visit.client_id is None:
            raise Unacceptable("too early")
        match message:
            case GuiUpdateMessage(uuid, updates):
                self._controls.check_update(visit.client_id, uuid, updates)
            case GuiButtonHoldMessage(uuid):
                self._controls.check_hold(visit.client_id, uuid)
            case CommandTriggerMessage(uuid):
                self._controls.check_command(visit.client_id, uuid)
            case SceneNodeClickMessage() | SceneNodeDragMessage():
                if message.owner not in ("", str(visit.client_id)):
                    raise Unacceptable("another page's")
            case _:
                assert_never(message)

"""Asks the page in control whether it is there: one that hangs, or that the network has lost, does not answer."""

from collections.abc import Mapping

from viser import ClientHandle
from viser import _messages as messages

QUESTIONS = 4
"""Asked within the time after which silence ends control: one answer may be late, or lost."""


class Heartbeat:
    """Runs in the console's event loop."""

    def __init__(self, silent_s: float) -> None:
        self._every_s = silent_s / QUESTIONS
        self._asked = 0.0

    def ask(self, holder: int | None, now: float, clients: Mapping[int, ClientHandle]) -> None:
        """Ask the holder, when it is time to.

        A page that is told the field of view that it has changes nothing and answers with its camera: from the thread
        that draws it and takes its clicks, unlike a ping of the web socket, and also from a tab that is not in sight.
        """
        client = None if holder is None else clients.get(holder)
        if client is None or now - self._asked < self._every_s:
            return
        self._asked = now
        # viser's own setter sends nothing where nothing changes
        client._websock_connection.queue_message(messages.SetCameraFovMessage(client.camera.fov))

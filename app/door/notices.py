"""Tells a watcher, on the page, why what was clicked there changes nothing."""

from time import monotonic

from viser import ViserServer

SHOWN_S = 6.0
"""A notice stays for so long, and nothing more is said meanwhile: a drag is refused sixty times a second."""


class Notices:
    """Notices of one server's pages."""

    def __init__(self, server: ViserServer) -> None:
        self._server = server
        self._told: dict[int, float] = {}

    def tell_watcher(self, client_id: int) -> None:
        """Show it, unless it is being shown."""
        clients = self._server.get_clients()
        self._told = {number: when for number, when in self._told.items() if monotonic() - when < SHOWN_S}
        if client_id in self._told or client_id not in clients:
            return
        self._told[client_id] = monotonic()
        clients[client_id].add_notification(
            "You are watching",
            "What you draw or choose changes nothing. C, V, R and F and the mouse move your own view; "
            "to do more, log in as an operator.",
            color="orange",
            auto_close_seconds=SHOWN_S,
        )

"""The front server: listens, says where, and closes."""

import socket
from collections.abc import Collection, Sequence
from pathlib import Path
from threading import Event as ThreadEvent
from threading import Thread

import uvicorn
from starlette.routing import BaseRoute
from starlette.types import ASGIApp
from viser import CommandHandle

from app.door.controls import Controls
from app.door.entrance import Entrance
from app.door.front import Front
from app.door.gate import Gate
from app.door.guard import Guard
from app.door.hidden_viser import HiddenViser
from app.door.listening import Certificate
from app.door.notices import Notices
from app.door.passes import OneTimeKey, Passes
from app.host import is_loopback

LARGEST_SENT = 1 << 20
"""Bytes of a web socket message from outside; what is larger closes the connection before it is all here."""
GRACE_S = 1
"""For what is under way when the door closes."""


class Door:
    """Everything that is reached from outside, on one address."""

    def __init__(
        self,
        hidden: HiddenViser,
        people: Path,
        bound: socket.socket,
        host: str = "127.0.0.1",
        certificate: Certificate | None = None,
        passes: Passes | None = None,
        camera_commands: Collection[CommandHandle] = (),
    ) -> None:
        """`bound` is what `listen` has given for the host and the certificate."""
        self._hidden, self._socket, self._host, self._certificate = hidden, bound, host, certificate
        self.port: int = bound.getsockname()[1]
        self._one_time = OneTimeKey() if is_loopback(host) else None
        self.guard = Guard(Controls(hidden.server, camera_commands), Notices(hidden.server).tell_watcher)
        self.gate = Gate(people, f"rotrecon-{self.port}", passes or Passes(), self._one_time)

    @property
    def address(self) -> str:
        """Where people and robots find it."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"http{'s' if self._certificate else ''}://{host}:{self.port}"

    @property
    def link(self) -> str | None:
        """Opens once and lets the person who started the program in; on this machine alone."""
        return None if self._one_time is None else f"{self.address}/enter?key={self._one_time.key}"

    def name_of(self, client_id: int) -> str | None:
        """The authenticated name behind one of viser's clients."""
        return self._hidden.name_of(client_id)

    def start(self, more: Sequence[BaseRoute] = ()) -> None:
        """Open; returns when the page can be reached."""
        front = Front(self.gate, self.guard, self._hidden)
        app = front.app(Entrance(self.gate, self.guard, secure=self._certificate is not None), more)
        self._server = _Server(self._config(app))
        self._thread = Thread(target=self._server.run, args=([self._socket],), daemon=True)
        self._thread.start()
        self._server.ready.wait()

    def stop(self) -> None:
        """Close, and every page with it."""
        self._server.should_exit = True
        self._thread.join()

    def _config(self, app: ASGIApp) -> uvicorn.Config:
        files = self._certificate
        return uvicorn.Config(
            app,
            log_config=None,
            access_log=False,
            server_header=False,
            lifespan="off",
            ws="websockets-sansio",
            ws_max_size=LARGEST_SENT,
            ws_per_message_deflate=False,
            timeout_graceful_shutdown=GRACE_S,
            proxy_headers=False,
            ssl_certfile=None if files is None else files.certificate,
            ssl_keyfile=None if files is None else files.key,
        )


class _Server(uvicorn.Server):
    """Tells another thread when it can be reached."""

    def __init__(self, config: uvicorn.Config) -> None:
        super().__init__(config)
        self.ready = ThreadEvent()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self.ready.set()

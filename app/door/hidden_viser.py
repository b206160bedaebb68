"""Viser where only the door reaches it: a random port of this machine that opens to tickets, each good for once."""

import http
import io
import secrets
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from contextvars import ContextVar
from dataclasses import dataclass
from threading import Lock
from typing import Any

import websockets.asyncio.server
from viser import ViserServer
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.door.people import Visitor

TICKET = "X-Rotrecon-Ticket"
LOOPBACK = "127.0.0.1"
REMEMBERED = 10_000
"""Clients whose names are known: the ones that left are asked for when what they did is told."""
_opening = Lock()
_arriving: ContextVar["Visit"] = ContextVar("arriving")


@dataclass(eq=False)
class Visit:
    """One web socket from a page to viser; viser gives it a number when it is through."""

    visitor: Visitor
    ticket: str
    client_id: int | None = None


class HiddenViser:
    """A viser server whose every client is somebody that the door has announced."""

    server: ViserServer

    def __init__(self) -> None:
        self._expected: dict[str, Visit] = {}
        self._visits: OrderedDict[int, Visit] = OrderedDict()

    def open(self) -> ViserServer:
        """Start it on a free port; every connection without a ticket is refused before viser sees it."""
        with _opening, redirect_stdout(io.StringIO()), self._guarding():
            self.server = ViserServer(LOOPBACK, 0, verbose=False)
        self.server._websock_server.on_client_connect(self._numbered)
        return self.server

    @property
    def uri(self) -> str:
        """Where the door, and nobody else, connects to."""
        return f"ws://{LOOPBACK}:{self.server.get_port()}"

    def expect(self, visitor: Visitor) -> Visit:
        """A ticket for somebody who will connect now; give it back with `forget` when that comes to nothing."""
        visit = Visit(visitor, secrets.token_urlsafe(32))
        self._expected[visit.ticket] = visit
        return visit

    def forget(self, visit: Visit) -> None:
        """Take back a ticket that was not used."""
        self._expected.pop(visit.ticket, None)

    def visitor_of(self, client_id: int) -> Visitor | None:
        """Who is behind one of viser's clients, also for a while after it has left."""
        visit = self._visits.get(client_id)
        return None if visit is None else visit.visitor

    def name_of(self, client_id: int) -> str | None:
        """The authenticated name behind one of viser's clients."""
        visitor = self.visitor_of(client_id)
        return None if visitor is None else visitor.name

    def _numbered(self, connection: Any) -> None:
        """Viser runs this in the connection's own task, whose context says whose it is."""
        visit = _arriving.get()
        visit.client_id = connection.client_id
        self._visits[connection.client_id] = visit
        if len(self._visits) > REMEMBERED:
            self._visits.popitem(last=False)

    def _refuse(self, _: ServerConnection, request: Request) -> Response | None:
        if request.headers.get(TICKET, "") in self._expected:
            return None
        return Response(http.HTTPStatus.FORBIDDEN, "Forbidden", Headers(), b"")

    @contextmanager
    def _guarding(self) -> Iterator[None]:
        """Viser leaves no room for a check of its own: put it into the server that it is about to start."""
        serve = websockets.asyncio.server.serve

        def guarded(handler: Callable[[ServerConnection], Awaitable[None]], *where: Any, **options: Any) -> Any:
            async def announced(connection: ServerConnection) -> None:
                assert connection.request is not None
                visit = self._expected.pop(connection.request.headers[TICKET], None)
                if visit is not None:
                    _arriving.set(visit)
                    await handler(connection)

            return serve(announced, *where, **{**options, "process_request": self._refuse})

        websockets.asyncio.server.serve = guarded  # pyright: ignore[reportAttributeAccessIssue]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = serve

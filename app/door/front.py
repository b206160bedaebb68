"""The front server's routes: the page for those who are in, its web socket, and headers that every answer carries."""

from collections.abc import Sequence

from starlette.applications import Starlette
from starlette.datastructures import MutableHeaders
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from app.door.entrance import SEE_OTHER, Entrance
from app.door.gate import Gate
from app.door.guard import Guard
from app.door.hidden_viser import HiddenViser
from app.door.origin import is_own_page
from app.door.page_file import page_file, policy
from app.door.proxy import POLICY_VIOLATION, carry

NOT_MODIFIED = 304
STRICT = policy()
PEOPLE = ("operator", "watcher")
"""Roles that see the page; a robot has an interface of its own."""


class Front:
    """What is reached through the door."""

    def __init__(self, gate: Gate, guard: Guard, hidden: HiddenViser) -> None:
        self._gate, self._guard, self._hidden = gate, guard, hidden

    def app(self, entrance: Entrance, more: Sequence[BaseRoute] = ()) -> ASGIApp:
        """All of it, as one application."""
        page = [Route("/", self._page, methods=["GET"]), WebSocketRoute("/", self._socket)]
        return with_headers(Starlette(routes=[*page, *entrance.routes, *more]))

    async def _page(self, request: Request) -> Response:
        visitor = self._gate.visitor(request)
        if visitor is None or visitor.role not in PEOPLE:
            return RedirectResponse("/login", SEE_OTHER)
        page = page_file()
        headers = {"ETag": page.tag, "Cache-Control": "private, no-cache", "Content-Security-Policy": page.policy}
        if request.headers.get("if-none-match") == page.tag:
            return Response(status_code=NOT_MODIFIED, headers=headers)
        if "gzip" in request.headers.get("accept-encoding", ""):
            return Response(page.gzipped, headers={**headers, "Content-Encoding": "gzip"}, media_type="text/html")
        return Response(page.plain, headers=headers, media_type="text/html")

    async def _socket(self, socket: WebSocket) -> None:
        if not is_own_page(socket):
            await self._turned_away(socket, "foreign origin")
            return
        visitor = self._gate.visitor(socket)
        if visitor is None or visitor.role not in PEOPLE:
            await self._turned_away(socket, "not logged in")
            return
        visit = self._hidden.expect(visitor)
        await carry(socket, visit, self._hidden, self._guard, lambda: self._gate.visitor(socket) == visitor)

    async def _turned_away(self, socket: WebSocket, reason: str) -> None:
        self._guard.refuse(reason)
        await socket.close(POLICY_VIOLATION)


def with_headers(app: ASGIApp) -> ASGIApp:
    """Every answer says that it is not to be framed, guessed at, stored or told to others."""

    async def wrapped(scope: Scope, receive: Receive, send: Send) -> None:
        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.setdefault("Content-Security-Policy", STRICT)
                headers.setdefault("Cache-Control", "no-store")
                headers["X-Content-Type-Options"] = "nosniff"
                headers["Referrer-Policy"] = "same-origin"  # with no-referrer a form's Origin would be null
                headers["Cross-Origin-Opener-Policy"] = "same-origin"
            await send(message)

        await app(scope, receive, sending)

    return wrapped

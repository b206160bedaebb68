"""The log-in page, the link that opens once, and the way out."""

from html import escape
from urllib.parse import parse_qs

from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.routing import Route

from app.door.gate import Gate, TooMany
from app.door.guard import Guard
from app.door.origin import is_own_page
from app.static_files import static_text

LARGEST_FORM = 8192
"""Bytes of a name and a secret at their longest, escaped."""
SEE_OTHER, UNAUTHORIZED, FORBIDDEN, TOO_LARGE, TOO_MANY = 303, 401, 403, 413, 429
WRONG = "Name or secret is wrong."
USED = "This link does not open any more: it works once. Log in, or start the console again for a new one."
ROBOT = "This is a robot's name: robots use /api/v1, people log in with a name of their own."
BUSY = "Too many people are logging in. Wait a moment and try again."


class Entrance:
    """Routes of the way in and out."""

    def __init__(self, gate: Gate, guard: Guard, secure: bool) -> None:
        self._gate, self._guard, self._secure = gate, guard, secure
        self.routes = [
            Route("/login", self._page, methods=["GET"]),
            Route("/login", self._log_in, methods=["POST"]),
            Route("/enter", self._enter, methods=["GET"]),
            Route("/account", self._account, methods=["GET"]),
            Route("/logout", self._log_out, methods=["POST"]),
            Route("/door.css", _style, methods=["GET"]),
        ]

    async def _page(self, _: Request) -> Response:
        return _login_page()

    async def _log_in(self, request: Request) -> Response:
        if not is_own_page(request):
            return self._refused("foreign origin")
        body = b""
        async for chunk in request.stream():
            body += chunk
            if len(body) > LARGEST_FORM:
                return Response("Too large", TOO_LARGE)
        form = parse_qs(body.decode("utf-8", "replace"))
        name, secret = (form.get(field, [""])[0] for field in ("name", "secret"))
        try:
            visitor = await self._gate.visitor_with(name, secret)
        except TooMany:
            return _login_page(BUSY, TOO_MANY)
        if visitor is None:
            self._guard.refuse("wrong name or secret")
            return _login_page(WRONG, UNAUTHORIZED)
        if visitor.role == "robot":
            return _login_page(ROBOT, FORBIDDEN)
        return self._let_in(self._gate.passes.issue(visitor.name))

    async def _enter(self, request: Request) -> Response:
        if request.method != "GET":  # a look at where the link leads does not use it up
            return Response()
        token = self._gate.pass_by_link(request.query_params.get("key", ""))
        return _login_page(USED, FORBIDDEN) if token is None else self._let_in(token)

    async def _account(self, request: Request) -> Response:
        visitor = self._gate.visitor(request)
        if visitor is None:
            return RedirectResponse("/login", SEE_OTHER)
        page = static_text("account.html").replace("<!-- name -->", escape(visitor.name))
        return HTMLResponse(page.replace("<!-- role -->", visitor.role))

    async def _log_out(self, request: Request) -> Response:
        if not is_own_page(request):
            return self._refused("foreign origin")
        self._gate.passes.end(request.cookies.get(self._gate.cookie, ""))
        response = RedirectResponse("/login", SEE_OTHER)
        response.delete_cookie(self._gate.cookie)
        return response

    def _let_in(self, token: str) -> Response:
        response = RedirectResponse("/", SEE_OTHER)
        response.set_cookie(
            self._gate.cookie,
            token,
            max_age=self._gate.passes.lasts_s,
            httponly=True,
            samesite="strict",
            secure=self._secure,
        )
        return response

    def _refused(self, reason: str) -> Response:
        self._guard.refuse(reason)
        return Response("Refused: this did not come from the console's own page.", FORBIDDEN)


async def _style(_: Request) -> Response:
    return Response(static_text("door.css"), media_type="text/css")


def _login_page(message: str = "", status: int = 200) -> Response:
    shown = f'<p class="message amber" role="alert">{escape(message)}</p>' if message else ""
    return HTMLResponse(static_text("login.html").replace("<!-- message -->", shown), status)

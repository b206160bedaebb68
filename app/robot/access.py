"""Who may use the robot's side: a name and a secret with every request, or for reading the pass of one who is in."""

import binascii
from base64 import b64decode

from fastapi import Depends, HTTPException
from fastapi.openapi.models import HTTPBase
from fastapi.security.base import SecurityBase
from starlette.requests import HTTPConnection

from app.door.gate import Gate, TooMany
from app.door.guard import Guard
from app.door.origin import is_own_page
from app.door.people import Visitor

ASK = {"WWW-Authenticate": 'Basic realm="rotrecon", charset="UTF-8"'}
WHO = "Send the name and secret of a user as basic authentication; `rotrecon user add NAME --role robot` makes one."
NOT_A_ROBOT = "Only a robot pushes frames in; use a user whose role is robot."
FOREIGN = "A page of another site sent this."
BUSY = "Too many secrets are being tried; ask again in a moment."


class Basic(SecurityBase):
    """Name and secret as RFC 7617 has them, in UTF-8."""

    model = HTTPBase(scheme="basic", description="Name and secret of a user.")
    scheme_name = "basic"

    async def __call__(self, connection: HTTPConnection) -> tuple[str, str] | None:
        """Name and secret, or None when there are none that can be read."""
        scheme, _, packed = connection.headers.get("authorization", "").partition(" ")
        if scheme.lower() != "basic":
            return None
        try:
            name, colon, secret = b64decode(packed, validate=True).decode("utf-8").partition(":")
        except (binascii.Error, ValueError):
            return None
        return (name, secret) if colon else None


basic = Basic()


class Access:
    """Dependencies of the interface's routes."""

    def __init__(self, gate: Gate, guard: Guard) -> None:
        self._gate, self._guard = gate, guard

    async def reader(self, connection: HTTPConnection, said: tuple[str, str] | None = Depends(basic)) -> Visitor:
        """Anybody who may come in."""
        if "origin" in connection.headers and not is_own_page(connection):
            self._guard.refuse("foreign origin")
            raise HTTPException(403, FOREIGN)
        try:
            visitor = self._gate.visitor(connection) if said is None else await self._gate.visitor_with(*said)
        except TooMany:
            raise HTTPException(429, BUSY) from None
        if visitor is None:
            self._guard.refuse("not logged in" if said is None else "wrong name or secret")
            raise HTTPException(401, WHO, ASK)
        return visitor

    async def said(self, connection: HTTPConnection) -> tuple[str, str] | None:
        """Name and secret that a request carries, where FastAPI does not ask."""
        return await basic(connection)

    async def robot(self, connection: HTTPConnection, said: tuple[str, str] | None = Depends(basic)) -> Visitor:
        """A robot, by its secret."""
        visitor = await self.reader(connection, said)
        if visitor.role != "robot":
            self._guard.refuse("not a robot")
            raise HTTPException(403, NOT_A_ROBOT)
        return visitor

    def stays(self, visitor: Visitor, connection: HTTPConnection) -> bool:
        """Whether somebody who was let in may still be here."""
        person = self._gate.people().get(visitor.name)
        return (person is not None and person.role == visitor.role) or self._gate.visitor(connection) == visitor

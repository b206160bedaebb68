"""Who is it: by the pass that a request carries, by a name and a secret, or by the one-time link."""

import asyncio
import getpass
import hmac
import logging
import secrets
from collections import OrderedDict
from collections.abc import Mapping
from pathlib import Path

from starlette.requests import HTTPConnection

from app.door.passes import OneTimeKey, Passes
from app.door.people import PeopleError, Person, Visitor, read_people, visitor_with

MOST_WAITING = 8
"""Secrets waiting to be checked, one at a time; more than that is somebody guessing."""
REMEMBERED = 64
"""Secrets found right that are not hashed again: a controller asks several times a second."""
log = logging.getLogger(__name__)


class TooMany(Exception):
    """Too many secrets are being tried at once."""


class Gate:
    """Knows everybody who may come in; the file of people is read again when it has changed."""

    def __init__(self, people: Path, cookie: str, passes: Passes, one_time: OneTimeKey | None) -> None:
        self.cookie, self.passes = cookie, passes
        self._file, self._one_time = people, one_time
        self._people, self._stamp = read_people(people), _stamp(people)
        self._key = secrets.token_bytes(32)
        self._right: OrderedDict[bytes, str] = OrderedDict()
        self._checking, self._waiting = asyncio.Semaphore(1), 0

    def people(self) -> Mapping[str, Person]:
        """Everybody there is now; nobody while the file cannot be read."""
        stamp = _stamp(self._file)
        if stamp != self._stamp:
            self._stamp = stamp
            try:
                self._people = read_people(self._file)
            except PeopleError:
                log.exception("nobody with a name can come in")
                self._people = {}
        return self._people

    def visitor(self, connection: HTTPConnection) -> Visitor | None:
        """Whose pass a request carries, as long as that person may come in."""
        carried = self.passes.read(connection.cookies.get(self.cookie, ""))
        if carried is None:
            return None
        if carried.by_link:
            return Visitor(carried.name, "operator")
        person = self.people().get(carried.name)
        return None if person is None else Visitor(carried.name, person.role)

    async def visitor_with(self, name: str, secret: str) -> Visitor | None:
        """Who has this name and secret. Raises TooMany when too many wait to be checked."""
        mark = hmac.digest(self._key, f"{name}:{secret}".encode(), "sha256")
        person = self.people().get(name)
        if person is not None and self._right.get(mark) == person.secret_hash:
            return Visitor(name, person.role)
        if self._waiting >= MOST_WAITING:
            raise TooMany
        self._waiting += 1
        try:
            async with self._checking:
                found = await asyncio.to_thread(visitor_with, self.people(), name, secret)
        finally:
            self._waiting -= 1
        if found is not None and person is not None:
            self._right[mark] = person.secret_hash
            if len(self._right) > REMEMBERED:
                self._right.popitem(last=False)
        return found

    def pass_by_link(self, key: str) -> str | None:
        """A pass for the person who started the program and has its one-time link."""
        if self._one_time is None or not self._one_time.use(key):
            return None
        return self.passes.issue(_local_name(), by_link=True)


def _local_name() -> str:
    try:
        return f"{getpass.getuser()} (local)"
    except (KeyError, OSError):
        return "local"


def _stamp(path: Path) -> tuple[int, ...] | None:
    try:
        status = path.stat()
    except OSError:
        return None
    return (status.st_mtime_ns, status.st_size, status.st_ino)

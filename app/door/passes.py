"""What somebody who is in carries: a signed pass in a cookie, and the link that lets one person in without a secret."""

import secrets
from dataclasses import dataclass
from threading import Lock

from itsdangerous import BadData, URLSafeTimedSerializer

LASTS_S = 12 * 3600
"""A long shift; then a person logs in again."""


@dataclass(frozen=True)
class Pass:
    """What is written on a pass."""

    name: str
    by_link: bool
    """Let in by the one-time link, and not by a secret."""
    number: str


class Passes:
    """Passes of this run of the program: the key is made at the start and never written down."""

    def __init__(self, lasts_s: int = LASTS_S) -> None:
        self.lasts_s = lasts_s
        self._signer = URLSafeTimedSerializer(secrets.token_bytes(32), salt="pass")
        self._ended: set[str] = set()

    def issue(self, name: str, *, by_link: bool = False) -> str:
        """A pass for somebody who has proved who they are."""
        return str(self._signer.dumps([name, by_link, secrets.token_urlsafe(12)]))

    def read(self, token: str) -> Pass | None:
        """What it says; None when it was not issued here, is too old, or was given back."""
        try:
            read = Pass(*self._signer.loads(token, max_age=self.lasts_s))
        except (BadData, ValueError, TypeError):
            return None
        return None if read.number in self._ended else read

    def end(self, token: str) -> None:
        """Let a pass count no longer, whoever has a copy of it."""
        read = self.read(token)
        if read is not None:
            self._ended.add(read.number)


class OneTimeKey:
    """What the link printed at the start carries: it opens once."""

    def __init__(self) -> None:
        self.key = secrets.token_urlsafe(24)
        self._used = False
        self._lock = Lock()

    def use(self, key: str) -> bool:
        """Whether this is the key, and the first time."""
        with self._lock:
            right = not self._used and secrets.compare_digest(key.encode(), self.key.encode())
            self._used |= right
            return right

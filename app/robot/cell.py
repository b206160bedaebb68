"""What the robot's side knows of the console, and what it gives to it."""

import threading
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Protocol

from app.console import Console
from app.decided import decision_of
from app.decision import Decision, DecisionSource
from app.held import Newer
from app.newer_frames import newer_facts
from rotrecon.capture import Capture
from rotrecon.frame import Frame
from rotrecon.primitives import Primitive

NOTICE_S = 10.0


class Cell(DecisionSource, Protocol):
    """Everything that the interface reads and writes; called from any thread."""

    @property
    def name(self) -> str:
        """Of the scene that is held."""
        ...

    def frame(self) -> Frame:
        """The frame that is held, which the decision rests on."""
        ...

    def solid(self) -> Primitive | None:
        """The fitted solid in base coordinates, if there is one."""
        ...

    def pages(self) -> int:
        """How many pages are open."""
        ...

    def offer(self, capture: Capture, who: str) -> Newer:
        """Take a newer capture; whether and when it is looked at is the operator's choice."""
        ...

    def offered(self) -> Newer | None:
        """The newest capture that was pushed in, until it is held."""
        ...


class ConsoleCell:
    """The console as the robot's side sees it."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._known: tuple[object, Decision] = (None, Decision())
        self._count = 0
        self._lock = threading.Lock()
        self._offered: Newer | None = None

    @property
    def name(self) -> str:
        """Of the scene."""
        return self._console.held.name

    def decision(self) -> Decision:
        """The decision as it stands, all of it on disk; idle while a drawing is being measured."""
        told = self._console.told
        case = told.decision.case
        changed = told.decision.watched is not None and told.decision.watched.changed
        at = (
            None
            if case is None
            else (told.reconstruction, case.number, case.stage, case.override, told.decision.fault, changed)
        )
        with self._lock:
            if self._known[0] != at:
                self._known = (at, decision_of(told))
            return self._known[1]

    def subscribe(self, changed: Callable[[], object]) -> Callable[[], object]:
        """See `DecisionSource`."""
        return self._console.subscribe(changed)

    def frame(self) -> Frame:
        """See `Cell`."""
        return self._console.frame

    def solid(self) -> Primitive | None:
        """See `Cell`."""
        result = self._console.told.reconstruction
        return None if result is None else result.solid

    def pages(self) -> int:
        """See `Cell`."""
        return len(self._console.server.get_clients())

    def offered(self) -> Newer | None:
        """See `Cell`."""
        offered = self._offered
        if offered is not None and self._console.held.capture is offered.capture:
            self._offered = offered = None
        return offered

    def offer(self, capture: Capture, who: str) -> Newer:
        """Keep it in the place of the one before it, and say so on every page: the frame worked on is held."""
        now = datetime.now(UTC)
        self._count += 1
        self._offered = newer = Newer(self._count, capture, who, now, newer_facts(capture, now))
        self._console.newer(newer)
        for client in self._console.server.get_clients().values():
            client.add_notification(
                "A newer frame has arrived",
                f"{capture.name}, from {who}. What you see and measure is still the frame before it; "
                "the one in control can take it in the Decision panel.",
                auto_close_seconds=NOTICE_S,
            )
        return newer

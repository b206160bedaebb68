"""Serves the console through the guarded door until it is interrupted, and says how it is reached."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event as ThreadEvent

from app.console import Console
from app.deciding.settings import DecisionSettings
from app.door.door import Door
from app.door.hidden_viser import HiddenViser
from app.door.listening import Certificate, listen
from app.last_session import LastSessions
from app.record.store import Record
from app.robot.api import robot_routes
from app.robot.cell import ConsoleCell
from rotrecon.capture import Capture
from rotrecon.frame import Frame
from rotrecon.settings import Settings


def serve(
    frame: Frame,
    name: str,
    settings: Settings,
    host: str = "127.0.0.1",
    port: int = 8080,
    *,
    people: Path,
    record: Record | None = None,
    deciding: DecisionSettings | None = None,
    certificate: Certificate | None = None,
    capture: Capture | None = None,
    notes: tuple[str, ...] = (),
    tour: bool = False,
    announce: Callable[[str], None] = print,
) -> None:
    """Serve the console until interrupted or terminated; says where it is to be found, and how to get in.

    Without a `record` nothing can be decided; a `tour` leads whoever opens a page. Raises HostError, before anything is
    opened, for an address that cannot be listened on, is taken, or that others can reach while users or TLS are
    missing; PeopleError for a file of users that cannot be used.
    """
    socket = listen(host, port, people, certificate)
    hidden = HiddenViser()
    console = Console(
        frame,
        name,
        settings,
        notes=notes,
        open_viser=hidden.open,
        record=record,
        deciding=deciding,
        name_of=hidden.name_of,
        capture=capture,
        last=None if record is None else LastSessions(record.folder),
        tour=tour,
    )
    console.start()
    door = Door(hidden, people, socket, host, certificate, camera_commands=console.panels.camera_commands)
    try:
        door.start(robot_routes(ConsoleCell(console), door.gate, door.guard))
        with _ended_by_sigterm():
            for line in (*console.held.notes, *announcements(door)):
                announce(line)
            ThreadEvent().wait()
    except KeyboardInterrupt:
        announce("Closed.")
    finally:
        console.end()  # while the door is open, so that a robot that follows the decision is told that it is void
        door.stop()
        console.stop()


@contextmanager
def _ended_by_sigterm() -> Iterator[None]:
    """Let a supervisor's SIGTERM do what Ctrl+C does: without a handler nothing would be recorded."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def announcements(door: Door) -> tuple[str, ...]:
    """What has to be said when the door is open."""
    if door.link is None:
        return (f"The console is open at {door.address}; users log in  (Ctrl+C closes it)",)
    return (
        f"The console is open at {door.link}  (Ctrl+C closes it)",
        f"That link works once; with a user's name and secret log in at {door.address}",
    )

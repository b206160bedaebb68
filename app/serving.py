"""Serves the console until it is interrupted, and says where it is to be found and who can reach it."""

from collections.abc import Callable
from threading import Event as ThreadEvent

from app.console import Console
from app.host import check_host, is_loopback
from rotrecon.frame import Frame
from rotrecon.settings import Settings


def serve(
    frame: Frame,
    name: str,
    settings: Settings,
    host: str = "127.0.0.1",
    port: int = 8080,
    *,
    notes: tuple[str, ...] = (),
    announce: Callable[[str], None] = print,
) -> None:
    """Serve the console until interrupted; says where it is to be found, and whether others can reach it.

    Raises HostError for a host that is not this machine's.
    """
    check_host(host)
    console = Console(frame, name, settings, host, port, notes=notes)
    console.start()
    try:
        for line in (*notes, *announcements(host, port, console.server.get_port(), console.address)):
            announce(line)
        ThreadEvent().wait()
    except KeyboardInterrupt:
        announce("Closed.")
    finally:
        console.stop()


def announcements(host: str, asked_port: int, port: int, address: str) -> tuple[str, ...]:
    """What has to be said when the server is open."""
    lines: list[str] = []
    if port != asked_port:
        lines.append(f"Port {asked_port} is taken; using {port} instead.")
    if not is_loopback(host):
        lines.append(
            f"WARNING: listening on {host}: everybody who can reach this machine can see the picture and draw on it. "
            "Nobody is asked for a password. Leave --host out to keep it to this machine."
        )
    return (*lines, f"The console is open at {address}  (Ctrl+C closes it)")

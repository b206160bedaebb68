"""How long it takes from the command to a page that answers."""

import socket
import subprocess
import sys
import time
from urllib.error import URLError
from urllib.request import urlopen

COMMAND = (sys.executable, "-c", "from app.cli import main; main()", "serve")
PATIENCE_S = 60.0
POLL_S = 0.02


def startup_s() -> float:
    """Seconds from starting `rotrecon serve` to its page's HTTP 200."""
    port = _free_port()
    started = time.perf_counter()
    with subprocess.Popen([*COMMAND, "--port", str(port)], stdout=subprocess.DEVNULL) as server:
        try:
            _wait_for_page(f"http://127.0.0.1:{port}", server)
            return time.perf_counter() - started
        finally:
            server.terminate()


def _wait_for_page(address: str, server: "subprocess.Popen[bytes]") -> None:
    end = time.perf_counter() + PATIENCE_S
    while time.perf_counter() < end and server.poll() is None:
        try:
            with urlopen(address, timeout=PATIENCE_S) as answer:
                if answer.status == 200:
                    return
        except URLError:
            time.sleep(POLL_S)
    raise RuntimeError(f"the console did not answer at {address}; start it by hand to see why")


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])

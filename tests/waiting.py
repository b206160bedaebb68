"""Waiting for a condition, and never for a time."""

from collections.abc import Callable
from time import monotonic, sleep

WAIT_S = 20.0


def until(condition: Callable[[], bool]) -> None:
    """Return when the condition holds."""
    end = monotonic() + WAIT_S
    while not condition():
        assert monotonic() < end
        sleep(0.01)

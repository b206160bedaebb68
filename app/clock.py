"""The one clock of decisions: it is not set, and goes on while the machine sleeps, where the machine has such a one."""

import time


def seconds() -> float:
    """Seconds since some moment."""
    boot = getattr(time, "CLOCK_BOOTTIME", None)
    return time.monotonic() if boot is None else time.clock_gettime(boot)


def wall_s() -> float:
    """Unix time."""
    return time.time()

"""The console's speed beside what is asked of it."""

from app.bench.door_speed import LARGE, SMALL, door_latency
from app.bench.latency import release_latency
from app.bench.startup import startup_s
from app.bench.table import table, verdict

RELEASES = 60
LATENCY_TARGET_MS = 100.0
STARTUP_TARGET_S = 10.0
DOOR_TARGET_MS = 3.0
ROUND_TRIPS = 200


def console_report(releases: int = RELEASES) -> str:
    """The figures as text; half a minute of work."""
    latency, robust = release_latency(releases, "paper"), release_latency(max(releases // 4, 1), "robust")
    startup = startup_s()
    added = {name: door_latency(ROUND_TRIPS, size) for name, size in (("small", SMALL), ("large", LARGE))}
    worst = latency.percentile_ms(95)
    rows = [
        ("release to the last message about it, `paper`, median", f"{latency.percentile_ms(50):.0f} ms", ""),
        ("the same, 95th percentile", f"{worst:.0f} ms", verdict(worst, LATENCY_TARGET_MS, "ms")),
        ("the same by `robust`, median", f"{robust.percentile_ms(50):.0f} ms", ""),
        *(
            (f"the door adds to a {name} message, 95th percentile", f"{ms:.1f} ms", verdict(ms, DOOR_TARGET_MS, "ms"))
            for name, ms in ((name, door.added_ms(95)) for name, door in added.items())
        ),
        ("`rotrecon serve` to a page that answers", f"{startup:.1f} s", verdict(startup, STARTUP_TARGET_S, "s")),
    ]
    head = f"Console, frame of 1280 x 720 px, {releases} releases over a web socket"
    return f"{head}\n\n{table(('figure', 'measured', 'target'), rows)}"

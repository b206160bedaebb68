"""The console's speed beside what is asked of it."""

from app.bench.latency import release_latency
from app.bench.startup import startup_s
from app.bench.table import table, verdict

RELEASES = 60
LATENCY_TARGET_MS = 100.0
STARTUP_TARGET_S = 10.0


def console_report(releases: int = RELEASES) -> str:
    """The figures as text; half a minute of work."""
    latency, startup = release_latency(releases), startup_s()
    worst = latency.percentile_ms(95)
    rows = [
        ("pointer's release to the last message about it, median", f"{latency.percentile_ms(50):.0f} ms", ""),
        ("the same, 95th percentile", f"{worst:.0f} ms", verdict(worst, LATENCY_TARGET_MS, "ms")),
        ("`rotrecon serve` to a page that answers", f"{startup:.1f} s", verdict(startup, STARTUP_TARGET_S, "s")),
    ]
    head = f"Console, frame of 1280 x 720 px, {releases} releases over a web socket"
    return f"{head}\n\n{table(('figure', 'measured', 'target'), rows)}"

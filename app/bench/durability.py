"""Writers of the record killed at random moments: is what they acknowledged there, and is all of it whole?

`python -m app.bench.durability [KILLS]`
"""

import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from app.bench.table import table
from app.record.entries import Head
from app.record.errors import NoSuchEntry
from app.record.store import Record
from app.record.verify import verify

KILLS = 200
WRITERS = 2
"""At the same time, so that one may die while another waits for it."""
KILLS_A_RECORD = 20
"""All of a record is verified after each, which takes longer the more it holds."""
MOST_ACKNOWLEDGED = 30
"""Of entries before the kill."""
MOST_DELAY_S = 0.02
"""Between an acknowledgement and the kill: several times what an entry takes."""


def killed_writers(
    folder: Path, random: np.random.Generator, writers: int = 1, most_delay_s: float = 0.0
) -> list[Head]:
    """Start writers, kill them with SIGKILL at a random moment, and return what they had acknowledged."""
    seeds = random.integers(0, 2**31, writers)
    command = [sys.executable, "-m", "app.bench.record_writer", str(folder)]
    started = [subprocess.Popen([*command, str(seed)], stdout=subprocess.PIPE, text=True) for seed in seeds]
    acknowledged: list[Head] = []
    for _ in range(int(random.integers(1, MOST_ACKNOWLEDGED))):
        assert started[0].stdout is not None
        acknowledged.append(Head.parse(started[0].stdout.readline()))
    if most_delay_s > 0:
        time.sleep(random.uniform(0, most_delay_s))
    for writer in started:
        writer.kill()
    for writer in started:
        rest = writer.communicate()[0]
        # a line that was cut off by the kill acknowledged nothing
        acknowledged += [Head.parse(line) for line in rest.splitlines(keepends=True) if line.endswith("\n")]
    return acknowledged


def problems_of(folder: Path, acknowledged: list[Head]) -> list[str]:
    """What is wrong with a record after a kill: entries that are bad, and acknowledged ones that are lost."""
    with closing(Record.open(folder)) as record:
        fault = verify(record)
        problems = [] if fault is None else [f"entry {fault.id} {fault.problem}"]
        for head in acknowledged:
            try:
                found = record.entry(head.id).hash == head.hash
            except NoSuchEntry:
                found = False
            problems += [] if found else [f"entry {head} was acknowledged and is lost"]
        return problems


def durability_report(kills: int = KILLS) -> str:
    """The figures as text; some minutes of work."""
    random = np.random.default_rng(0)
    problems: list[str] = []
    written = acknowledged = 0
    for first in range(0, kills, KILLS_A_RECORD):
        with TemporaryDirectory() as name:
            heads: list[Head] = []
            for _ in range(min(KILLS_A_RECORD, kills - first)):
                heads += killed_writers(Path(name), random, WRITERS, MOST_DELAY_S)
                problems += problems_of(Path(name), heads)
            with closing(Record.read(Path(name))) as record:
                written += record.head.id
            acknowledged += len(heads)
    rows = [
        ("kills of " + f"{WRITERS} writers", str(kills), ""),
        ("entries written", str(written), ""),
        ("of them acknowledged", str(acknowledged), ""),
        ("lost or half there", str(len(problems)), "0"),
    ]
    return "\n".join([table(("figure", "measured", "target"), rows), *problems])


if __name__ == "__main__":
    sys.stdout.write(durability_report(int(sys.argv[1]) if len(sys.argv) > 1 else KILLS) + "\n")

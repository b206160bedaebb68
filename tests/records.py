"""Small records, whole and tampered with."""

import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.digest import digest_of_parts, frame_id
from app.record.entries import Entry, Head
from app.record.store import FILE, Record
from app.record.verify import verify
from rotrecon.frame import Frame
from tests.exact import CAMERA


def frame(seed: int = 0) -> Frame:
    random = np.random.default_rng(seed)
    camera = replace(CAMERA, width=16, height=12)
    image = random.integers(0, 256, (12, 16, 3), dtype=np.uint8)
    return Frame(image, camera.cloud(random.uniform(0.5, 2, (12, 16))), camera)


def proposal(of: Frame, number: int = 0) -> Entry:
    evidence = {"frame": frame_id(of), "drawing": number, "settings": None, "result": [1.5, -0.0]}
    return Entry("proposal", "ann", digest_of_parts(**evidence), {"evidence": evidence})


def filled(folder: Path, count: int = 3) -> list[Head]:
    """A record of some decisions, a proposal and its confirmation each; the heads it had, the empty one first."""
    with closing(Record.open(folder)) as record:
        heads = [record.head]
        for number in range(count):
            entry = proposal(frame(number), number)
            heads.append(record.append(entry, frame(number)).head)
            heads.append(record.append(Entry("confirmed", "ann", entry.digest)).head)
        return heads


def tampered(folder: Path, *statements: str, values: tuple[object, ...] = ()) -> None:
    with closing(sqlite3.connect(folder / FILE)) as database:
        for statement in statements:
            database.execute(statement, values)
        database.commit()


def fault_of(folder: Path, kept: Head | None = None) -> int | None:
    with closing(Record.read(folder)) as record:
        fault = verify(record, kept)
        return None if fault is None else fault.id

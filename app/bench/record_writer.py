"""Writes decisions as fast as they go, and says of each when it is on disk; run to be killed."""

import sys
from itertools import count
from pathlib import Path

import numpy as np

from app.digest import digest_of_parts, frame_id
from app.record.entries import Entry
from app.record.store import Record
from rotrecon.camera import PinholeCamera
from rotrecon.frame import Frame

WIDTH, HEIGHT = 64, 48
"""A small frame: what is tried is the moment, not the amount."""


def write_decisions(folder: Path, seed: int) -> None:
    """Proposal with a frame of its own, arming and confirmation, over and over; a line `id:hash` after each."""
    random = np.random.default_rng(seed)
    camera = PinholeCamera(WIDTH, HEIGHT, np.array([[60.0, 0, 31.5], [0, 60.0, 23.5], [0, 0, 1]]))
    record = Record.open(folder)
    for number in count():
        image = random.integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)
        frame = Frame(image, camera.cloud(random.uniform(0.5, 2.0, (HEIGHT, WIDTH))), camera)
        evidence = {"frame": frame_id(frame), "drawing": number, "settings": None, "result": None}
        digest = digest_of_parts(**evidence)
        _acknowledge(str(record.append(Entry("proposal", "bench", digest, {"evidence": evidence}), frame).head))
        _acknowledge(str(record.append(Entry("armed", "bench", digest)).head))
        _acknowledge(str(record.append(Entry("confirmed", "bench", digest)).head))


def _acknowledge(head: str) -> None:
    sys.stdout.write(f"{head}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    write_decisions(Path(sys.argv[1]), int(sys.argv[2]))

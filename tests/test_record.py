"""The record: what is in it stays in it, and whatever was changed since is found."""

import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from app.bench.durability import killed_writers, problems_of
from app.digest import frame_id
from app.record.entries import BEFORE_THE_FIRST, Entry, Head
from app.record.errors import NoSuchEntry, StoreError
from app.record.store import FILE, Record
from app.record.verify import verify
from tests.records import fault_of, filled, frame, proposal, tampered

KILLS = 10


@pytest.fixture
def record(tmp_path: Path) -> Iterator[Record]:
    with closing(Record.open(tmp_path)) as opened:
        yield opened


def test_entries_say_who_when_what_and_with_which_versions(record):
    when = datetime(2026, 1, 31, 12, tzinfo=UTC)
    written = record.append(Entry("rejected", "ann", "d" * 64, {"reason": "hand in the way"}, when))
    content = record.entry(1).content
    assert record.entry(1) == written
    assert content["versions"]["numpy"] == np.__version__
    del content["versions"]
    assert content == {
        "id": 1,
        "previous": BEFORE_THE_FIRST,
        "kind": "rejected",
        "who": "ann",
        "when": "2026-01-31T12:00:00.000000+00:00",
        "digest": "d" * 64,
        "payload": {"reason": "hand in the way"},
    }
    assert record.append(Entry("armed", "ann")).content["previous"] == written.hash


def test_entries_are_found_by_kind_and_digest_and_the_last_of_them(record):
    for kind, digest in [("proposal", "a"), ("armed", "a"), ("proposal", "b"), ("confirmed", "a")]:
        record.append(Entry(kind, "ann", digest))
    assert [entry.id for entry in record.entries()] == [1, 2, 3, 4]
    assert [entry.id for entry in record.entries(kind="proposal")] == [1, 3]
    assert [entry.id for entry in record.entries(digest="a", last=2)] == [2, 4]
    assert record.entries(kind="proposal", digest="c") == ()
    with pytest.raises(NoSuchEntry, match="no entry 5"):
        record.entry(5)
    with pytest.raises(NoSuchEntry, match="no scene"):
        record.scene("0" * 64)


def test_a_frame_is_stored_once_and_comes_back_to_the_last_bit(record, tmp_path):
    before = frame()
    for _ in range(3):
        record.append(proposal(before), before)
    after = record.scene(frame_id(before))
    assert after.points_m.tobytes() == before.points_m.tobytes()
    assert frame_id(after) == frame_id(before)
    assert not after.points_m.flags.writeable
    with closing(sqlite3.connect(tmp_path / FILE)) as database:
        assert database.execute("SELECT count(*) FROM scenes").fetchone() == (1,)
        assert database.execute("SELECT count(*) FROM arrays").fetchone() == (4,)


@pytest.mark.parametrize("payload", [{"a": float("nan")}, {"a": object()}, {"a": {1, 2}}])
def test_what_cannot_be_recorded_exactly_is_a_callers_mistake_and_leaves_nothing(record, payload):
    with pytest.raises(ValueError, match=r"JSON|recorded"):
        record.append(Entry("proposal", "ann", None, payload), frame())
    assert record.head == Head()
    with pytest.raises(NoSuchEntry):
        record.scene(frame_id(frame()))
    with pytest.raises(ValueError, match="time zone"):
        Entry("armed", "ann", when=datetime(2026, 1, 31))


def test_an_empty_record_is_whole_and_reading_makes_none(tmp_path):
    with closing(Record.read(tmp_path / "none")) as record:
        assert (record.head, record.entries(), verify(record)) == (Head(), (), None)
    assert not (tmp_path / "none").exists()


def test_a_record_whose_maker_was_killed_at_once_is_an_empty_one(tmp_path):
    (tmp_path / FILE).touch()
    assert fault_of(tmp_path) is None
    assert filled(tmp_path)[0] == Head()
    assert fault_of(tmp_path) is None


def test_a_full_disk_is_said_and_leaves_the_record_as_it_was(record, tmp_path):
    kept = record.append(Entry("armed", "ann")).head
    pages = record._connection.execute("PRAGMA page_count").fetchone()[0]
    record._connection.execute(f"PRAGMA max_page_count = {pages + 1}")
    large = frame(1)
    with pytest.raises(StoreError, match=r"cannot be used .*full.*disk"):
        record.append(Entry("proposal", "ann", None, {"text": "x" * 100_000}), large)
    assert record.head == kept
    assert fault_of(tmp_path, kept) is None
    with pytest.raises(NoSuchEntry):
        record.scene(frame_id(large))
    record._connection.execute("PRAGMA max_page_count = 1000000")
    assert record.append(proposal(large), large).id == 2


def test_a_store_that_is_none_is_said(tmp_path):
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(StoreError, match="name another folder by --data"):
        Record.open(tmp_path / "file")
    (tmp_path / FILE).write_bytes(b"no database" * 1000)
    for opened in (Record.open, Record.read):
        with pytest.raises(StoreError, match="not a database"):
            opened(tmp_path)


def test_a_record_of_another_format_is_left_alone(tmp_path):
    filled(tmp_path)
    tampered(tmp_path, "PRAGMA user_version = 7")
    for opened in (Record.open, Record.read):
        with pytest.raises(StoreError, match="format 7"):
            opened(tmp_path)


def test_it_is_kept_as_safe_as_the_disk_allows(record):
    assert record._connection.execute("PRAGMA journal_mode").fetchone() == ("wal",)
    assert record._connection.execute("PRAGMA synchronous").fetchone() == (2,)


WRITER = """
import sys
from pathlib import Path
from app.record.entries import Entry
from app.record.store import Record
sys.stdin.readline()
record = Record.open(Path(sys.argv[1]))
for _ in range(25):
    record.append(Entry("armed", sys.argv[2]))
"""


def test_two_processes_that_write_at_once_make_one_chain(tmp_path):
    command = [sys.executable, "-c", WRITER, str(tmp_path)]
    writers = [subprocess.Popen([*command, who], stdin=subprocess.PIPE, text=True) for who in ("ann", "bob")]
    for writer in writers:
        assert writer.stdin is not None
        writer.stdin.write("go\n")
        writer.stdin.flush()
    for writer in writers:
        writer.communicate()
    assert [writer.returncode for writer in writers] == [0, 0]
    with closing(Record.read(tmp_path)) as record:
        assert verify(record) is None
        assert sorted(entry.content["who"] for entry in record.entries()) == ["ann"] * 25 + ["bob"] * 25


def test_nothing_acknowledged_is_lost_when_a_writer_is_killed(tmp_path):
    random = np.random.default_rng(20)
    acknowledged: list[Head] = []
    for _ in range(KILLS):
        acknowledged += killed_writers(tmp_path, random)
        assert problems_of(tmp_path, acknowledged) == []
    assert len(acknowledged) >= KILLS

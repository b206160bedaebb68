"""The record: what is in it stays in it, and whatever was changed since is found."""

import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.bench.durability import killed_writers, problems_of
from app.digest import digest_of_parts, frame_id
from app.record.entries import BEFORE_THE_FIRST, Entry, Head, link
from app.record.errors import NoSuchEntry, StoreError
from app.record.store import FILE, Record
from app.record.verify import verify
from rotrecon.frame import Frame
from tests.exact import CAMERA

KILLS = 10


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


@pytest.fixture
def record(tmp_path: Path) -> Iterator[Record]:
    with closing(Record.open(tmp_path)) as opened:
        yield opened


def tampered(folder: Path, *statements: str, values: tuple[object, ...] = ()) -> None:
    with closing(sqlite3.connect(folder / FILE)) as database:
        for statement in statements:
            database.execute(statement, values)
        database.commit()


def fault_of(folder: Path, kept: Head | None = None) -> int | None:
    with closing(Record.read(folder)) as record:
        fault = verify(record, kept)
        return None if fault is None else fault.id


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


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Head]]:
    folder = tmp_path_factory.mktemp("whole")
    return folder, filled(folder)


def test_a_whole_record_is_whole_at_every_head_it_had(whole):
    folder, heads = whole
    assert fault_of(folder) is None
    assert [fault_of(folder, kept) for kept in heads] == [None] * 7
    assert Head.parse(str(heads[-1])) == heads[-1]


COLUMNS = ("body", "hash", "kind", "digest")


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_changed_byte_of_any_entry_is_found(whole, data):
    folder, heads = whole
    number, column = data.draw(st.integers(1, len(heads) - 1)), data.draw(st.sampled_from(COLUMNS))
    with closing(sqlite3.connect(folder / FILE)) as database:
        cell = f"SELECT CAST({column} AS BLOB) FROM entries WHERE id = ?"
        before = database.execute(cell, (number,)).fetchone()[0]
    at, byte = data.draw(st.integers(0, len(before) - 1)), data.draw(st.integers(1, 255))
    after = bytearray(before)
    after[at] ^= byte
    change = f"UPDATE entries SET {column} = CAST(? AS TEXT) WHERE id = ?"
    tampered(folder, change, values=(bytes(after), number))
    assert fault_of(folder) == number
    tampered(folder, change, values=(before, number))
    assert fault_of(folder) is None


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 5), st.booleans())
def test_a_tail_that_was_cut_off_is_found_against_a_head_that_was_kept(whole, left, rewritten):
    folder, heads = whole
    with closing(sqlite3.connect(folder / FILE)) as database:
        rows = database.execute("SELECT * FROM entries WHERE id > ?", (left,)).fetchall()
    tampered(folder, "DELETE FROM entries WHERE id > ?", values=(left,))
    if rewritten:
        with closing(Record.open(folder)) as record:
            for _ in rows:
                record.append(Entry("rejected", "eve"))
    assert fault_of(folder) is None, "a shorter chain is a chain"
    assert fault_of(folder, heads[left]) is None
    assert fault_of(folder, heads[-1]) == (len(heads) - 1 if rewritten else left + 1)
    tampered(folder, "DELETE FROM entries WHERE id > ?", values=(left,))
    with closing(sqlite3.connect(folder / FILE)) as database:
        database.executemany("INSERT INTO entries VALUES (?, ?, ?, ?, ?)", rows)
        database.commit()


@pytest.mark.parametrize(
    ("statement", "bad"),
    [
        ("DELETE FROM entries WHERE id = 2", 2),
        ("DELETE FROM entries WHERE id = 1", 1),
        ("UPDATE entries SET id = 99 WHERE id = 4", 4),
        ("INSERT INTO entries SELECT 0, kind, digest, body, hash FROM entries WHERE id = 1", 1),
        ("UPDATE entries SET (body, hash) = (SELECT body, hash FROM entries WHERE id = 2) WHERE id = 4", 4),
        ("UPDATE entries SET digest = NULL WHERE id = 4", 4),
        ("DELETE FROM scenes WHERE rowid = 2", 3),
        ("UPDATE scenes SET tree = replace(tree, '16', '17') WHERE rowid = 1", 1),
        ("DELETE FROM arrays WHERE rowid = 1", 1),
        ("UPDATE arrays SET content = substr(content, 1, length(content) - 1) WHERE rowid = 1", 1),
        ("UPDATE arrays SET content = (SELECT content FROM arrays WHERE rowid = 2) WHERE rowid = 1", 1),
    ],
)
def test_entries_and_scenes_that_were_taken_out_or_exchanged_are_found(tmp_path, statement, bad):
    filled(tmp_path)
    tampered(tmp_path, statement)
    assert fault_of(tmp_path) == bad


def test_an_entry_that_was_rewritten_with_a_hash_of_its_own_breaks_the_chain_after_it(tmp_path):
    heads = filled(tmp_path)
    forged = link(Entry("rejected", "eve"), heads[1], {})
    values = (forged.body.decode(), forged.hash)
    tampered(
        tmp_path, "UPDATE entries SET body = ?, hash = ?, kind = 'rejected', digest = NULL WHERE id = 2", values=values
    )
    assert fault_of(tmp_path) == 3
    assert fault_of(tmp_path, heads[2]) == 2


def test_evidence_that_its_digest_is_not_of_is_found(record, tmp_path):
    record.append(replace(proposal(frame()), digest="0" * 64), frame())
    assert fault_of(tmp_path) == 1


def test_a_damaged_entry_is_never_handed_out(record, tmp_path):
    record.append(Entry("rejected", "ann"))
    tampered(tmp_path, "UPDATE entries SET body = replace(body, 'ann', 'eve')")
    for read in (record.entries, lambda: record.entry(1)):
        with pytest.raises(StoreError, match=r"entry 1 .*damaged"):
            read()


def test_a_damaged_scene_is_never_handed_out(record, tmp_path):
    record.append(proposal(frame()), frame())
    tampered(tmp_path, "UPDATE arrays SET content = substr(content, 2)")
    with pytest.raises(StoreError, match="restore the record"):
        record.scene(frame_id(frame()))


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

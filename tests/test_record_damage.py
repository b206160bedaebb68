"""A record that was changed, cut off or damaged: that is found, and nothing of it is handed out."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.digest import frame_id
from app.record.entries import Entry, Head, link
from app.record.errors import StoreError
from app.record.store import FILE, Record
from tests.records import fault_of, filled, frame, proposal, tampered


@pytest.fixture
def record(tmp_path: Path) -> Iterator[Record]:
    with closing(Record.open(tmp_path)) as opened:
        yield opened


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

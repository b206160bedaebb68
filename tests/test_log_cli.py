"""The record at a terminal."""

import json
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import platformdirs
import pytest
from msgspec import structs

from app.record.entries import Entry
from app.record.evidence import proposal
from app.record.store import FILE, Record
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from tests.exact import cylinder, drawing_along, exact_frame
from tests.records import tampered

SOLID = cylinder([0.0, 0.0, 0.9], [0.1, 1.0, 0.2], 0.06)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    frame, drawing = exact_frame(SOLID), drawing_along(SOLID)
    with closing(Record.open(folder)) as record:
        entry = proposal("ann", frame, drawing, Settings(), reconstruct(frame, drawing, Settings()))
        record.append(entry, frame)
        said = {"tool": "mechanical cutter", "reason": "a hand is in the way"}
        record.append(Entry("rejected", "bob", entry.digest, said))
        record.append(Entry("declined", "eve"))
    return folder


def test_list_shows_every_entry_and_the_head(rotrecon, data):
    code, out, _ = rotrecon("log", "list", "--data", data)
    lines = out.splitlines()
    assert code == 0
    assert [line.split()[2] for line in lines[:3]] == ["proposal", "rejected", "declined"]
    assert "  mechanical cutter   ann: cylinder 60.0 mm" in lines[0]
    assert lines[1].endswith("  mechanical cutter   bob: a hand is in the way")
    assert lines[2].endswith("  -                   eve")
    assert lines[3].startswith("head 3:")
    _, out, _ = rotrecon("log", "list", "--data", data, "--kind", "rejected")
    assert [line.split()[0] for line in out.splitlines()] == ["2", "head"]
    _, out, _ = rotrecon("log", "list", "--data", data, "--last", "1")
    assert [line.split()[0] for line in out.splitlines()] == ["3", "head"]
    code, _, err = rotrecon("log", "list", "--data", data, "--kind", "guess")
    assert code == 2
    assert "proposal" in err


def test_a_line_names_the_tool_and_why_there_is_none_and_is_never_long(rotrecon, tmp_path):
    frame, drawing = exact_frame(SOLID), drawing_along(SOLID)
    tight = replace(Settings(), tools=tuple(structs.replace(tool, diameter_mm=(1.0, 2.0)) for tool in Settings().tools))
    with closing(Record.open(tmp_path)) as record:
        record.append(proposal("ann", frame, drawing, tight, reconstruct(frame, drawing, tight)), frame)
        record.append(Entry("overridden", "bob " * 20, None, {"tool": "t" * 40, "override": "first\nsecond " * 40}))
    _, out, _ = rotrecon("log", "list", "--data", tmp_path)
    refused, long, head = out.splitlines()
    assert "refusal" in refused
    assert "  -                   ann: mechanical cutter: takes 1 to 2 mm" in refused
    assert f"  {17 * 't'}…  bob" in long
    assert max(len(refused), len(long)) <= 120
    assert head.startswith("head 2:")


def test_show_says_what_is_in_an_entry(rotrecon, data):
    code, out, _ = rotrecon("log", "show", 1, "--data", data)
    assert code == 0
    assert "cylinder, 60.0" in out
    assert "numpy" in out
    _, out, _ = rotrecon("log", "show", 2, "--data", data)
    assert "reason: a hand is in the way" in out


def test_verify_says_whole_or_names_the_first_bad_entry(rotrecon, data, tmp_path):
    code, out, _ = rotrecon("log", "verify", "--data", data)
    assert code == 0
    head = out.split()[-1]
    assert rotrecon("log", "verify", "--data", data, "--head", head)[0] == 0
    copied = tmp_path / "copy"
    copied.mkdir()
    with closing(Record.read(data)) as record:
        record._connection.execute("VACUUM INTO ?", (str(copied / FILE),))
    tampered(copied, "DELETE FROM entries WHERE id = 3")
    assert rotrecon("log", "verify", "--data", copied)[0] == 0
    code, out, _ = rotrecon("log", "verify", "--data", copied, "--head", head)
    assert (code, out) == (1, "entry 3 is missing, and all up to 3, the kept head's: the tail was cut off\n")
    tampered(copied, "UPDATE entries SET body = replace(body, 'bob', 'ann') WHERE id = 2")
    code, out, _ = rotrecon("log", "verify", "--data", copied)
    assert code == 1
    assert out.startswith("entry 2 has a body that its hash is not of")
    code, _, err = rotrecon("log", "verify", "--data", copied, "--head", "3")
    assert code == 2
    assert "is no head" in err


def test_an_empty_record_is_whole_and_stays_unmade(rotrecon, tmp_path, monkeypatch):
    monkeypatch.setattr(platformdirs, "user_data_path", lambda *_, **__: tmp_path / "home")
    for arguments in (["--data", tmp_path / "none"], []):
        code, out, _ = rotrecon("log", "verify", *arguments)
        assert (code, out) == (0, f"the record is whole; entries: 0, head 0:{'0' * 64}\n")
        code, out, _ = rotrecon("log", "list", *arguments)
        assert (code, out) == (0, f"head 0:{'0' * 64}\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("format_", ["html", "json", "csv", "ply", "glb", "stl"])
def test_export_writes_every_format_where_it_is_called(rotrecon, data, tmp_path, format_, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, _ = rotrecon("log", "export", 2, "--format", format_, "--data", data)
    assert (code, out) == (0, f"wrote rotrecon-2.{format_}\n")
    assert (tmp_path / f"rotrecon-2.{format_}").stat().st_size > 1000


def test_export_writes_a_named_file_or_into_a_folder(rotrecon, data, tmp_path):
    assert rotrecon("log", "export", 2, tmp_path, "--data", data)[0] == 0
    assert rotrecon("log", "export", 2, tmp_path / "named", "--data", data)[0] == 0
    assert (tmp_path / "named").read_bytes() == (tmp_path / "rotrecon-2.html").read_bytes()
    code, _, err = rotrecon("log", "export", 2, tmp_path / "no" / "folder", "--data", data)
    assert (code, err.count("\n")) == (2, 1)


def test_replay_says_that_every_number_is_the_same(rotrecon, data):
    for number in (1, 2):
        code, out, _ = rotrecon("replay", number, "--data", data)
        assert code == 0
        assert " numbers are the same\n" in out


def test_replay_names_the_numbers_that_are_not(rotrecon, tmp_path):
    frame, drawing = exact_frame(SOLID), drawing_along(SOLID)
    result = reconstruct(frame, drawing, Settings())
    entry = proposal("ann", frame, drawing, Settings(), result)
    evidence = json.loads(json.dumps(entry.payload["evidence"]))
    evidence["result"]["solid"]["Frustum"]["radius_m"] += 1e-12
    with closing(Record.open(tmp_path)) as record:
        record.append(Entry(entry.kind, entry.who, entry.digest, {**entry.payload, "evidence": evidence}), frame)
    code, out, _ = rotrecon("replay", 1, "--data", tmp_path)
    assert code == 1
    assert "1 of " in out.splitlines()[0]
    assert out.splitlines()[1].startswith("  solid.Frustum.radius_m: recorded 0.03")


@pytest.mark.parametrize("command", [["replay", 3], ["log", "export", 3, "."], ["replay", 9], ["log", "show", 9]])
def test_what_there_is_nothing_of_is_one_sentence_and_exit_code_3(rotrecon, data, command):
    code, out, err = rotrecon(*command, "--data", data)
    assert (code, out, err.count("\n")) == (3, "", 1)


def test_a_record_that_cannot_be_read_is_one_sentence_and_exit_code_2(rotrecon, tmp_path):
    (tmp_path / FILE).write_bytes(b"no database" * 1000)
    for command in (["log", "list"], ["log", "verify"], ["replay", 1], ["log", "show", 1]):
        code, out, err = rotrecon(*command, "--data", tmp_path)
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert "not a database" in err

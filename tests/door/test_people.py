"""Users: hashed, in a private file that is whole at any moment, and managed at a terminal."""

import json
import stat
import sys
from io import StringIO
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.cli import main
from app.door.passes import OneTimeKey, Passes
from app.door.people import PeopleError, Visitor, read_people, visitor_with, with_person, write_people
from app.user_cli import _secret
from rotrecon import files

SECRET = "correct horse battery"


def test_secrets_are_hashed_and_checked(people: Path) -> None:
    everybody = with_person(read_people(people), "Zoë", "operator", SECRET)
    assert visitor_with(everybody, "Zoë", SECRET) == Visitor("Zoë", "operator")
    for name, secret in (("Zoë", SECRET + "!"), ("Zoë", ""), ("zoë", SECRET), ("nobody", SECRET), ("", "")):
        assert visitor_with(everybody, name, secret) is None
    assert everybody["Zoë"].secret_hash.startswith("$argon2id$")
    assert with_person({}, "Zoë", "operator", SECRET)["Zoë"].secret_hash != everybody["Zoë"].secret_hash, "salted"


def test_the_file_is_private_and_keeps_everything(tmp_path: Path) -> None:
    path = tmp_path / "new" / "users.json"
    everybody = with_person(with_person({}, "Anna", "operator", SECRET), "Jürgen", "watcher", SECRET)
    write_people(path, everybody)
    assert read_people(path) == everybody
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    assert SECRET not in path.read_text()


def test_a_write_that_fails_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "users.json"
    write_people(path, with_person({}, "Anna", "operator", SECRET))
    before = path.read_bytes()

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    with pytest.raises(PeopleError, match="No space left"):
        write_people(path, {})
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    "content",
    ["", "[]", "3", '{"a": 1}', '{"a": {}}', '{"a": {"role": "king", "secret_hash": "x"}}', '{"a": null}', "\xff"],
)
def test_a_file_that_is_none_is_refused_with_a_remedy(tmp_path: Path, content: str) -> None:
    path = tmp_path / "users.json"
    path.write_text(content, encoding="latin-1")
    with pytest.raises(PeopleError, match=r"users\.json"):
        read_people(path)


@pytest.mark.parametrize("name", ["", " ", "a:b", "a\nb", "a ", "x" * 65, "\x00", "a\u202eb"])
def test_names_that_would_mislead_are_refused(name: str) -> None:
    with pytest.raises(PeopleError, match="cannot be a name"):
        with_person({}, name, "operator", SECRET)


@pytest.mark.parametrize("secret", ["", "short", "x" * 1025])
def test_secrets_are_long_enough(secret: str) -> None:
    with pytest.raises(PeopleError, match="10 to 1024"):
        with_person({}, "Anna", "operator", secret)


@pytest.fixture
def user(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path):
    def run(*arguments: str, typed: str = "") -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["rotrecon", "user", *arguments, "--data", str(tmp_path)])
        monkeypatch.setattr(sys, "stdin", StringIO(typed))
        with pytest.raises(SystemExit) as stop:
            main()
        out, err = capfd.readouterr()
        return int(stop.value.code or 0), out, err

    return run


def test_users_are_added_listed_and_removed(user, tmp_path: Path) -> None:
    assert user("list")[2].startswith("nobody yet")
    assert user("add", "Anna", typed=f"{SECRET}\n")[:2] == (0, f"added Anna, operator, in {tmp_path}/users.json\n")
    assert user("add", "arm", "--role", "robot", typed=SECRET)[0] == 0
    assert user("list")[1].split() == ["operator", "Anna", "robot", "arm"]
    assert user("add", "Anna", "--role", "watcher", typed=f"{SECRET} new\n")[1].startswith("changed Anna, watcher")
    assert visitor_with(read_people(tmp_path / "users.json"), "Anna", f"{SECRET} new") == Visitor("Anna", "watcher")
    assert user("remove", "Anna")[0] == 0
    assert list(json.loads((tmp_path / "users.json").read_text())) == ["arm"]


def test_what_cannot_be_done_with_users_is_one_sentence(user) -> None:
    for arguments, typed in ((("remove", "nobody"), ""), (("add", "Anna"), "short\n"), (("add", "a:b"), SECRET)):
        code, out, err = user(*arguments, typed=typed)
        assert (code, out) == (2, "")
        assert err.count("\n") == 1
        assert "short\n" not in err


def test_a_secret_is_asked_for_twice_and_without_echo(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setattr(sys, "stdin", Terminal())
    answers = iter([SECRET, SECRET, SECRET, "another one", "short"])
    monkeypatch.setattr("getpass.getpass", lambda _: next(answers))
    assert _secret("Anna") == SECRET
    with pytest.raises(PeopleError, match="not the same"):
        _secret("Anna")
    with pytest.raises(PeopleError, match="10 to 1024"):
        _secret("Anna")  # before it is asked for again


def test_a_pass_is_signed_and_runs_out(monkeypatch: pytest.MonkeyPatch) -> None:
    passes = Passes(lasts_s=100)
    token = passes.issue("Anna")
    read = passes.read(token)
    assert read is not None
    assert (read.name, read.by_link) == ("Anna", False)
    assert Passes().read(token) is None, "another run of the program has another key"
    now = passes._signer.make_signer("pass").get_timestamp()
    for later, valid in ((99, True), (102, False)):
        monkeypatch.setattr("itsdangerous.timed.TimestampSigner.get_timestamp", lambda _, later=later: now + later)
        assert (passes.read(token) is not None) is valid


ALIKE = str.maketrans("+/", "-_")
"""The two ways of base64 to write the same."""


@settings(max_examples=100)
@given(data=st.data())
def test_a_pass_with_one_letter_changed_is_none(data: st.DataObject) -> None:
    passes = Passes()
    token = passes.issue("Walt")
    place = data.draw(st.integers(0, len(token) - 2))
    letter = data.draw(st.characters(codec="ascii").filter(lambda letter: letter.translate(ALIKE) != token[place]))
    assert passes.read(token[:place] + letter + token[place + 1 :]) is None


def test_a_pass_given_back_is_none_and_others_stay() -> None:
    passes = Passes()
    one, other = passes.issue("Anna"), passes.issue("Anna")
    passes.end(one)
    passes.end("nonsense")
    assert passes.read(one) is None
    assert passes.read(other) is not None


def test_the_one_time_key_opens_once() -> None:
    key = OneTimeKey()
    assert not key.use("")
    assert not key.use("ünknown")
    assert key.use(key.key)
    assert not key.use(key.key)

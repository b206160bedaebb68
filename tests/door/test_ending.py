"""The end of the console: what was proposed or decided counts no more, in the record and for a robot."""

import json
import signal
from base64 import b64encode
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

import app.serving
from app.console import Console
from app.record.store import Record
from rotrecon.settings import Settings
from tests.door.conftest import SECRET
from tests.door.robot_side import DRAWN, SOLID, Cell, post
from tests.exact import exact_frame
from tests.waiting import WAIT_S


def test_a_robot_that_follows_the_decision_is_told_that_it_is_void(people: Path) -> None:
    cell = Cell(people)
    cell.do(*DRAWN)
    with cell.stream(Authorization="Basic " + b64encode(f"arm:{SECRET}".encode()).decode()) as socket:
        assert json.loads(socket.recv(WAIT_S))["state"] == "proposed"
        cell.console.end()
        assert json.loads(socket.recv(WAIT_S))["state"] == "idle"
    cell.stop()


class NotHandled(Exception):
    """What SIGTERM does here instead of ending the tests."""


@pytest.fixture
def unhandled() -> Iterator[None]:
    def raise_it(*_: object) -> None:
        raise NotHandled

    before = signal.signal(signal.SIGTERM, raise_it)
    yield
    signal.signal(signal.SIGTERM, before)


def test_sigterm_ends_it_as_ctrl_c_does(
    unhandled: None, people: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built: list[Console] = []
    said: list[str] = []

    class Built(Console):
        def start(self) -> None:
            super().start()
            built.append(self)

    def announce(line: str) -> None:
        said.append(line)
        if "is open at" in line:
            post(built[0], *DRAWN)
            built[0].wait_until_idle()
            signal.raise_signal(signal.SIGTERM)

    monkeypatch.setattr(app.serving, "Console", Built)
    with closing(Record.open(tmp_path)) as record:
        app.serving.serve(
            exact_frame(SOLID), "A rod", Settings(), port=0, people=people, record=record, announce=announce
        )
        last = record.entry(record.head.id).content
    assert said[-1] == "Closed."
    assert (last["kind"], last["payload"]["reason"]) == ("voided", "the console was closed")
    with pytest.raises(NotHandled):
        signal.raise_signal(signal.SIGTERM)

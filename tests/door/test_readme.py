"""What the README says of the robot's side, done as it is said there."""

import re
import shlex
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import httpx
import pytest

from app.clock import seconds
from app.console_items import FromPage
from app.deciding.events import ArmPressed, DecisionEvent, HoldTicked, PicturesSent
from app.events import FrameTaken
from rotrecon.scene.writing import SceneRecord, write_scene
from tests.door.robot_side import DRAWN, NOBODYS, SOLID, Cell, zipped
from tests.exact import exact_frame

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
ADDRESS = "http://127.0.0.1:8080/api/v1"
CURLS = [shlex.split(line, comments=True) for line in re.findall(r"^ {4}(curl .*)$", README, re.MULTILINE)]


@pytest.fixture(scope="module")
def cell(people: Path) -> Iterator[Cell]:
    cell = Cell(people)
    yield cell
    cell.stop()


def curl(cell: Cell, said: list[str], bodies: dict[str, bytes]) -> httpx.Response:
    """A line of the README, with the test's port and secret."""
    assert said[:3] == ["curl", "-u", "arm"]
    assert said[-1].startswith(ADDRESS)
    path, options = said[-1].removeprefix(ADDRESS), dict(zip(said[3:-1:2], said[4:-1:2], strict=True))
    assert options.keys() <= {"-o", "--data-binary"}
    with cell.client("arm") as client:
        if "--data-binary" in options:
            return client.post(path, content=bodies[options["--data-binary"]])
        return client.get(path)


def confirm(cell: Cell) -> None:
    """Arm and hold, as the one in control."""
    case = cell.console.session.decision.case
    assert case is not None
    now = seconds()
    loop, number = cell.console.server.get_event_loop(), case.number
    loop.call_soon_threadsafe(cell.console.post, PicturesSent(now, NOBODYS, number))
    acts: list[DecisionEvent] = [ArmPressed(now, NOBODYS, number)]
    acts += [HoldTicked(now + tick / 10, NOBODYS, number) for tick in range(13)]
    for act in acts:
        loop.call_soon_threadsafe(cell.console.post, FromPage(NOBODYS, act))
    cell.console.wait_until_idle()


def test_its_curl_lines_fetch_a_confirmed_decision_and_push_a_frame(cell: Cell, tmp_path: Path) -> None:
    write_scene(tmp_path / "newer", SceneRecord("Newer", exact_frame(SOLID)))
    bodies = {"@/tmp/newer.zip": zipped(tmp_path / "newer")}
    cell.do(*DRAWN)
    confirm(cell)
    answers = {said[-1].removeprefix(ADDRESS): curl(cell, said, bodies) for said in CURLS}
    assert set(answers) == {"/decision", "/model.glb", "/scene.ply", "/health", "/openapi.json", "/frames"}
    assert {path: answer.status_code for path, answer in answers.items()} == {
        path: 202 if path == "/frames" else 200 for path in answers
    }
    decision = answers["/decision"].json()
    assert decision["state"] == "confirmed"
    assert decision["tool"]
    assert datetime.fromisoformat(decision["valid_until"]) > datetime.now(UTC)
    cell.do(FrameTaken())
    assert cell.console.held.name == "Newer"
    (first,) = [said for said in CURLS if said[-1].endswith("/decision")]
    assert curl(cell, first, bodies).json()["state"] == "proposed", "what was confirmed was another frame"

"""A frame or views pushed in by a robot and taken by the one in control: then they are what everybody works on."""

import gc
import weakref
from collections.abc import Iterator
from pathlib import Path
from threading import Event as Gate

import httpx
import imageio.v3 as imageio
import numpy as np
import pytest

from app.deciding.states import obstacles
from app.events import Cleared, FrameTaken, PointerDragged
from rotrecon.capture import Capture
from rotrecon.frame import Frame
from rotrecon.scene.writing import SceneRecord, write_scene
from rotrecon.simulation.truth import write_simulated
from tests.door.robot_side import DRAWN, SOLID, Cell, zipped
from tests.exact import exact_frame
from tests.views import Rig, simulated
from tests.waiting import WAIT_S, until


@pytest.fixture(scope="module")
def cell(people: Path) -> Iterator[Cell]:
    cell = Cell(people)
    yield cell
    cell.stop()


@pytest.fixture
def robot(cell: Cell) -> Iterator[httpx.Client]:
    with cell.client("arm") as client:
        yield client


def pushed(robot: httpx.Client, folder: Path, name: str, frame: Frame) -> None:
    write_scene(folder / name, SceneRecord(name, frame))
    assert robot.post("/frames", content=zipped(folder / name)).status_code == 202


def brighter(frame: Frame) -> Frame:
    return Frame(frame.image + 60, frame.points_m, frame.camera)


def test_a_frame_that_is_taken_is_measured_and_proposed_anew(cell: Cell, robot: httpx.Client, tmp_path: Path) -> None:
    cell.do(Cleared(), *DRAWN)
    before, held = robot.get("/decision").json(), cell.console.held
    pushed(robot, tmp_path, "first", exact_frame(SOLID))
    pushed(robot, tmp_path, "second", brighter(exact_frame(SOLID)))
    cell.console.wait_until_idle()
    assert cell.console.held is held
    assert any("shows a change in the area" in why for why in obstacles(cell.console.session.decision))
    cell.do(FrameTaken())
    after, health = robot.get("/decision").json(), robot.get("/health").json()
    assert (health["frame"]["name"], health["offered"]) == ("second", None), "it has replaced the one before it"
    assert after["state"] == "proposed"
    assert after["digest"] != before["digest"]
    assert "recorded scene" in str(before["reasons"])
    assert "recorded scene" not in str(after["reasons"]), "the arm's camera has just taken it"
    assert not obstacles(cell.console.session.decision)[1:], "only its pictures have no page to go to"
    entry = cell.record.entry(cell.record.head.id)
    assert entry.content["kind"] == "proposal"
    assert entry.content["digest"] == after["digest"], "written with the frame that it was measured in"


def test_an_area_drawn_later_is_compared_too(cell: Cell, robot: httpx.Client, tmp_path: Path) -> None:
    cell.do(Cleared(), PointerDragged((10.0, 10.0), (60.0, 60.0)))
    frame = cell.console.frame
    image = frame.image.copy()
    image[100:160, 140:180] = 255 - image[100:160, 140:180]
    pushed(robot, tmp_path, "a hand", Frame(image, frame.points_m, frame.camera))
    cell.console.wait_until_idle()
    watched = cell.console.session.decision.watched
    assert watched is not None
    assert not watched.changed
    cell.do(PointerDragged((130.0, 90.0), (190.0, 170.0)))
    watched = cell.console.session.decision.watched
    assert watched is not None
    assert watched.changed


def test_views_are_matched_beside_the_queue_and_measured_finely(
    cell: Cell, robot: httpx.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, may_match, frame_of = simulated(Rig.SIDEWAYS), Gate(), Capture.frame
    write_simulated(tmp_path / "views", scene)

    def slowly(capture: Capture, *arguments: object) -> object:
        assert may_match.wait(WAIT_S)
        return frame_of(capture, *arguments)  # type: ignore[arg-type]

    with monkeypatch.context() as patched:
        patched.setattr(Capture, "frame", slowly)
        assert robot.post("/frames", content=zipped(tmp_path / "views")).json()["views"] == 2
        cell.post(FrameTaken())
        until(lambda: cell.console.told.taking is not None and cell.console.told.taking.matching)
        cell.post(Cleared())
        until(lambda: cell.console.told.shown.area is None)
        assert robot.get("/health").json()["offered"]["who"] == "arm", "everything else goes on meanwhile"
        may_match.set()
        cell.console.wait_until_idle(WAIT_S)
    assert (cell.console.frame.image.shape, cell.console.session.size_px) == ((360, 640, 3), (640, 360))
    assert any("Matched from 2 views" in note for note in cell.console.held.notes)
    drawing = scene.drawing
    corners = np.array(drawing.area.vertices_px)
    cell.do(PointerDragged(tuple(corners.min(axis=0)), tuple(corners.max(axis=0))))
    result = cell.console.session.reconstruction
    assert result is not None
    assert result.frame.stereo is not None
    assert result.frame.stereo.scale == 1.0, "matched again in the area"


def test_views_that_cannot_be_matched_are_told_of_and_what_is_held_stays(
    cell: Cell, robot: httpx.Client, tmp_path: Path
) -> None:
    held, scene = cell.console.held, simulated(Rig.SIDEWAYS)
    write_simulated(tmp_path / "views", scene)
    for path in (tmp_path / "views").glob("*.png"):
        imageio.imwrite(path, np.full_like(imageio.imread(path), 90))
    assert robot.post("/frames", content=zipped(tmp_path / "views")).status_code == 202
    cell.do(FrameTaken())
    assert cell.console.held is held
    newer = cell.console.session.newer
    assert newer is not None
    assert newer.unusable


def test_pushed_frames_do_not_pile_up(cell: Cell, robot: httpx.Client, tmp_path: Path) -> None:
    seen = []
    for number in range(4):
        pushed(robot, tmp_path, f"number {number}", exact_frame(SOLID))
        cell.console.wait_until_idle()
        assert cell.console.session.newer is not None
        seen.append(weakref.ref(cell.console.session.newer.capture))
    gc.collect()
    assert [ref() is not None for ref in seen] == [False, False, False, True]

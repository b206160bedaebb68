"""The robot's side over real sockets: what it reads is what the page shows, and nothing it sends decides anything."""

import json
from base64 import b64encode
from collections.abc import Callable, Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

import cv2
import httpx
import numpy as np
import pytest
import trimesh
from websockets.exceptions import ConnectionClosed, InvalidStatus

from app.digest import evidence_digest
from app.door.people import read_people, with_person, write_people
from app.events import Cleared
from app.robot import stream
from rotrecon.camera import transform
from rotrecon.reconstruction import Reconstruction
from rotrecon.scene.writing import SceneRecord, write_scene
from rotrecon.settings import Settings
from tests.door.conftest import SECRET
from tests.door.robot_side import DRAWN, SOLID, Cell, zipped
from tests.exact import exact_frame
from tests.waiting import WAIT_S, until


@pytest.fixture(scope="module")
def running(people: Path) -> Iterator[Cell]:
    cell = Cell(people)
    yield cell
    cell.stop()


@pytest.fixture
def cell(running: Cell) -> Cell:
    running.do(Cleared())
    return running


@pytest.fixture
def robot(cell: Cell) -> Iterator[httpx.Client]:
    with cell.client("arm") as client:
        yield client


def basic(name: str, secret: str = SECRET) -> str:
    return "Basic " + b64encode(f"{name}:{secret}".encode()).decode()


def result_of(cell: Cell) -> Reconstruction:
    result = cell.console.session.reconstruction
    assert result is not None
    return result


def test_what_is_drawn_is_proposed_and_what_is_cleared_is_not(cell: Cell, robot: httpx.Client) -> None:
    assert robot.get("/decision").json()["state"] == "idle"
    cell.do(*DRAWN)
    told, solid = robot.get("/decision").json(), result_of(cell).solid
    assert solid is not None
    assert (told["state"], told["frame"], told["kind"]) == ("proposed", "base", solid.kind)
    drawing, result = cell.console.session.shown.complete, result_of(cell)
    assert drawing is not None
    assert told["digest"] == evidence_digest(cell.console.frame, drawing, Settings(), result)
    assert (told["who"], told["valid_until"]) == (None, None), "nobody has decided"
    assert told["diameter_m"] == 2 * float(solid.radius_at(0.0))
    low, high = told["diameter_interval_m"]
    assert low < told["diameter_m"] < high
    pose = np.array(told["contact_pose"])
    assert np.allclose(pose[:3, 2], told["approach"])
    assert abs(pose[:3, 1] @ told["axis"]["direction"]) > 1 - 1e-9
    cell.do(Cleared())
    assert robot.get("/decision").json()["state"] == "idle"


def test_the_stream_says_what_changes(cell: Cell) -> None:
    with cell.stream(Authorization=basic("arm")) as socket:
        assert json.loads(socket.recv(WAIT_S))["state"] == "idle"
        socket.send('{"state": "confirmed"}')
        socket.send(b"\xff" * 100)
        cell.do(*DRAWN)
        states = [json.loads(socket.recv(WAIT_S))["state"]]
        while states[-1] != "proposed":
            states.append(json.loads(socket.recv(WAIT_S))["state"])
        cell.do(Cleared())
        while states[-1] != "idle":
            states.append(json.loads(socket.recv(WAIT_S))["state"])
    assert set(states) == {"proposed", "idle"}
    until(lambda: not cell.console._listeners)


def test_the_stream_ends_with_its_user(cell: Cell, people: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "RECHECK_S", 0.05)
    before = read_people(people)
    write_people(people, with_person(before, "arm 2", "robot", SECRET))
    with cell.stream(Authorization=basic("arm 2")) as socket:
        socket.recv(WAIT_S)
        write_people(people, before)
        with pytest.raises(ConnectionClosed) as closed:
            socket.recv(WAIT_S)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1008


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Authorization": basic("arm", "wrong")},
        {"Authorization": basic("nobody")},
        {"Authorization": "Basic ???"},
        {"Authorization": "Basic " + b64encode(b"no colon").decode()},
        {"Authorization": "Bearer " + SECRET},
        {"Authorization": basic("arm"), "Origin": "http://example.org"},
        {"Cookie": "rotrecon=forged"},
    ],
)
def test_nobody_reads_without_a_secret(cell: Cell, headers: dict[str, str]) -> None:
    expected = 403 if "Origin" in headers else 401
    with httpx.Client(base_url=cell.address, headers=headers, trust_env=False) as client:
        for path in ("/decision", "/health", "/scene.ply", "/model.glb"):
            assert client.get(path).status_code == expected
        assert client.post("/frames", content=b"").status_code == expected
    with pytest.raises(InvalidStatus):
        cell.stream(**headers)


@pytest.mark.parametrize(("name", "pushes"), [("arm", True), ("Anna", False), ("Walt", False)])
def test_everybody_reads_and_robots_push(cell: Cell, name: str, pushes: bool) -> None:
    with cell.client(name) as client:
        assert client.get("/decision").status_code == 200
        assert client.post("/frames", content=b"").status_code == (422 if pushes else 403)


def test_nothing_here_decides(cell: Cell, robot: httpx.Client) -> None:
    cell.do(*DRAWN)
    before, session = robot.get("/decision").json(), cell.console.session
    for method in ("POST", "PUT", "PATCH", "DELETE"):
        for path in ("/decision", "/decision/confirm", "/health", "/scene.glb", "/confirm", "/arm"):
            assert robot.request(method, path, json={"state": "confirmed"}).status_code in (404, 405)
    assert robot.get("/decision").json() == before
    now = cell.console.session
    assert replace(now, decision=replace(now.decision, now=session.decision.now)) == session


def test_a_robot_has_no_page(cell: Cell) -> None:
    with httpx.Client(base_url=cell.door.address, auth=("arm", SECRET), trust_env=False) as client:
        assert client.get("/").headers["location"] == "/login"


def test_model_and_scene_are_in_base_coordinates(cell: Cell, robot: httpx.Client) -> None:
    assert robot.get("/model.glb").status_code == 404
    cell.do(*DRAWN)
    solid, frame = result_of(cell).solid, cell.console.frame
    assert solid is not None
    points = transform(frame.T_base_camera, frame.points_m[np.isfinite(frame.depth_m)].astype(float))
    for form in ("glb", "ply"):
        model = trimesh.load(BytesIO(robot.get(f"/model.{form}").content), file_type=form, force="mesh")
        assert model.is_watertight
        assert np.allclose(model.bounds.mean(axis=0), solid.center_m, atol=1e-3)
        scene = robot.get(f"/scene.{form}")
        assert scene.status_code == 200
        cloud = trimesh.load(BytesIO(scene.content), file_type=form)
        assert np.allclose(cloud.bounds, [points.min(axis=0), points.max(axis=0)], atol=1e-5)
    assert robot.get("/model.exe").status_code == 422


def test_health_counts_what_was_refused(cell: Cell, robot: httpx.Client) -> None:
    before = robot.get("/health").json()
    httpx.get(f"{cell.address}/decision", trust_env=False)
    after = robot.get("/health").json()
    assert after["refused"]["not logged in"] == before["refused"].get("not logged in", 0) + 1
    assert (after["status"], after["frame"]["name"], after["pages"]) == ("ok", "A rod", 0)


def test_a_frame_pushed_in_is_announced_and_changes_nothing(cell: Cell, robot: httpx.Client, tmp_path: Path) -> None:
    cell.do(*DRAWN)
    session, frame = cell.console.session, cell.console.frame
    write_scene(tmp_path / "scene", SceneRecord("From the arm", exact_frame(SOLID)))
    answer = robot.post("/frames", content=zipped(tmp_path / "scene"))
    assert answer.status_code == 202
    assert (answer.json()["name"], answer.json()["views"]) == ("From the arm", 0)
    offered = robot.get("/health").json()["offered"]
    assert (offered["name"], offered["who"]) == ("From the arm", "arm")
    cell.console.wait_until_idle()
    now = cell.console.session
    assert (replace(now, newer=None, decision=session.decision), cell.console.frame) == (session, frame)
    assert now.decision.watched is not None
    assert now.decision.watched.identical, "a camera never sends the same pixels twice"


def test_posed_views_can_be_pushed_in(robot: httpx.Client, tmp_path: Path) -> None:
    views = "".join(
        f'[[views]]\nimage = "{side}.png"\ncamera = "main"\n'
        f"T_base_camera = [[1, 0, 0, {x}], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
        for side, x in (("left", 0.0), ("right", 0.1))
    )
    camera = "[cameras.main]\nsize = [32, 24]\nK = [[30, 0, 15.5], [0, 30, 11.5], [0, 0, 1]]\ndistortion = []\n"
    (tmp_path / "scene.toml").write_text(f'format = 1\nname = "Two views"\n{camera}{views}')
    for side in ("left", "right"):
        cv2.imwrite(str(tmp_path / f"{side}.png"), np.full((24, 32, 3), 90, np.uint8))
    answer = robot.post("/frames", content=zipped(tmp_path))
    assert (answer.status_code, answer.json()["views"]) == (202, 2)


def archive(fill: Callable[[ZipFile], Any]) -> bytes:
    packed = BytesIO()
    with ZipFile(packed, "w", ZIP_DEFLATED) as file:
        fill(file)
    return packed.getvalue()


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "no ZIP"),
        (b"PK\x03\x04 nonsense", "no ZIP"),
        (archive(lambda file: None), "scene.toml"),
        (archive(lambda file: file.writestr("scene.toml", "format = 2")), "format"),
        (archive(lambda file: file.writestr("../scene.toml", "")), "leads out"),
        (archive(lambda file: file.writestr("/etc/scene.toml", "")), "leads out"),
        (archive(lambda file: file.writestr("a\\b", "")), "leads out"),
        (archive(lambda file: [file.writestr(f"{n}", "") for n in range(65)]), "more than 64"),
        (archive(lambda file: file.writestr("scene.toml", "format = 1"))[:-30], "no ZIP"),
    ],
)
def test_what_is_no_scene_is_refused_with_a_remedy(robot: httpx.Client, content: bytes, says: str) -> None:
    answer = robot.post("/frames", content=content)
    assert answer.status_code == 422
    assert says in answer.json()["detail"]
    assert "/tmp" not in answer.json()["detail"], "whoever pushes learns nothing of this machine"


def test_what_unpacks_without_end_is_refused(robot: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.robot.pushing.LARGEST_UNPACKED", 1 << 20)
    bomb = archive(lambda file: file.writestr("scene.toml", b" " * (3 << 20)))
    assert "unpacks to more than" in robot.post("/frames", content=bomb).json()["detail"]
    monkeypatch.setattr("app.robot.api.LARGEST_PUSH", 1000)
    assert robot.post("/frames", content=b"x" * 2000).status_code == 413


def test_the_description_is_of_what_is_there(cell: Cell, robot: httpx.Client) -> None:
    described = robot.get("/openapi.json").json()
    assert set(described["paths"]) == {"/decision", "/health", "/scene.{form}", "/model.{form}", "/frames"}
    assert {method for path in described["paths"].values() for method in path} == {"get", "post"}
    assert list(described["paths"]["/frames"]) == ["post"]
    for word in ("T_base_contact", "metres", "nothing here can confirm", "/decision/stream", "valid_until"):
        assert word.lower() in described["info"]["description"].lower()
    decision = described["components"]["schemas"]["DecisionModel"]
    assert set(decision["required"]) == set(decision["properties"]) == set(robot.get("/decision").json())
    assert all("description" in part or "$ref" in str(part) for part in decision["properties"].values())

"""What is kept of a session: it comes back as it was, a damaged file ends nothing, and nothing comes back armed."""

from contextlib import closing
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.adjustable import NUMBERS
from app.clock import seconds
from app.console import Console
from app.console_items import FromPage
from app.deciding.events import ArmPressed, ControlTaken, DecisionEvent, HoldTicked, PageCame, PicturesSent
from app.deciding.states import Decided
from app.events import Event, KindChosen, PolygonClosed, SectionToggled, SettingTyped, UnitChosen, VertexClicked
from app.held import Held
from app.last_session import LastSessions
from app.object_drawing import ObjectDrawing, Pixel
from app.record.store import Record
from app.session import Session, step
from rotrecon.camera import PinholeCamera
from rotrecon.capture import Capture
from rotrecon.drawing import AreaOfInterest, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated, simulate

PAGE = 7
CAMERA = PinholeCamera(320, 240, np.array([[300.0, 0, 160.0], [0, 300.0, 120.0], [0, 0, 1]]))
SIZE_PX = (CAMERA.width, CAMERA.height)


@pytest.fixture(scope="module")
def scene() -> Simulated:
    return simulate("pipe", 3, CAMERA, supersampling=1)


@pytest.fixture(scope="module")
def empty(scene: Simulated) -> Session:
    return on(scene.frame)


def on(frame: Frame) -> Session:
    """A session that has just begun."""
    return Session(SIZE_PX, held=Held(frame, "A pipe", Capture("A pipe", recorded=frame)))


places = st.tuples(st.floats(0, 319, allow_subnormal=False), st.floats(0, 239, allow_subnormal=False))
drawings = st.builds(
    ObjectDrawing,
    st.none() | st.builds(AreaOfInterest, st.lists(places, min_size=3, max_size=5).map(tuple)),
    st.none() | st.builds(ObjectAxis, places, places),
    st.sampled_from([None, "rod", "cone"]),
    st.frozensets(st.integers(0, 300)),
    st.tuples(st.floats(0, 300), st.floats(0, 300)),
    st.sampled_from(["free", "plane"]),
)


@settings(max_examples=30)
@given(st.data())
def test_what_is_kept_comes_back_as_it_was(empty: Session, data: st.DataObject) -> None:
    objects = tuple(data.draw(st.lists(drawings, min_size=1, max_size=3)))
    session = replace(empty, objects=objects, selected=data.draw(st.integers(0, len(objects) - 1)))
    for one in data.draw(st.lists(st.sampled_from([*NUMBERS.values()]), max_size=3)):
        session = step(session, SettingTyped(one.key, one.setting(data.draw(st.sampled_from([one.low, one.high])))))
    session = step(session, UnitChosen(data.draw(st.sampled_from(["mm", "inch"]))))
    with TemporaryDirectory() as folder:
        LastSessions(Path(folder)).keep(session)
        file = LastSessions(Path(folder))
        back = file.resumed(empty)
        assert file.problem is None
    assert (back.objects, back.selected, back.unit, back.chosen) == (
        session.objects,
        session.selected,
        session.unit,
        session.chosen,
    )


def kept(folder: Path, scene: Simulated) -> Session:
    """A session whose file is in a folder."""
    session = replace(on(scene.frame), objects=(ObjectDrawing(scene.drawing.area, scene.drawing.axis),))
    LastSessions(folder).keep(session)
    return session


def test_a_file_damaged_anywhere_is_told_of_left_aside_and_ends_nothing(
    scene: Simulated, empty: Session, tmp_path: Path
) -> None:
    session = kept(tmp_path, scene)
    path = LastSessions(tmp_path).path(scene.frame)
    whole = path.read_bytes()
    damaged = [whole[:n] for n in range(0, len(whole), 40)]
    damaged += [whole[:n] + bytes([whole[n] ^ 1]) + whole[n + 1 :] for n in range(0, len(whole), 17)]
    damaged += [b"\xff\x00" * 50, whole + b" "]
    for content in damaged:
        path.write_bytes(content)
        file = LastSessions(tmp_path)
        assert file.resumed(empty) == empty
        assert file.problem is not None
        assert "damaged" in file.problem
        assert path.with_suffix(".damaged").read_bytes() == content
        assert not path.exists()
        file.keep(session)
        assert path.read_bytes() == whole


def test_a_drawing_or_a_setting_that_cannot_be_is_left_aside(empty: Session, tmp_path: Path) -> None:
    corner: Pixel = (0.0, 0.0)
    off = ObjectDrawing(AreaOfInterest((corner, (900.0, 0.0), (50.0, 50.0))))
    few = ObjectDrawing(AreaOfInterest((corner, (9.0, 9.0))))
    bad = [replace(empty, objects=(one,)) for one in (off, few)]
    bad += [replace(empty, settings=Settings(layers=77)), replace(empty, objects=(ObjectDrawing(),), selected=3)]
    for session in bad:
        LastSessions(tmp_path).keep(session)
        file = LastSessions(tmp_path)
        assert file.resumed(empty) == empty
        assert file.problem is not None


def test_a_disk_that_does_not_obey_is_told_of_once(
    empty: Session, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "sessions").write_text("in the way")
    file = LastSessions(tmp_path)
    for _ in range(2):
        file.keep(replace(empty, objects=(ObjectDrawing(kind="rod"),)))
    assert file.problem is not None
    assert "not kept" in file.problem
    assert len(caplog.records) == 1
    (tmp_path / "sessions").unlink()
    file.keep(replace(empty, objects=(ObjectDrawing(kind="rod"),)))
    assert file.problem is None


def test_each_scene_has_a_session_of_its_own(scene: Simulated, empty: Session, tmp_path: Path) -> None:
    drawn = kept(tmp_path, scene)
    other = on(replace(scene.frame, points_m=scene.frame.points_m + np.float32(0.001)))
    files = LastSessions(tmp_path)
    assert (files.resumed(other), files.problem) == (other, None)
    files.keep(other)
    assert not files.path(other.held.frame).exists(), "nothing was drawn"
    files.keep(replace(other, objects=(ObjectDrawing(kind="cone"),)))
    files.keep(replace(drawn, unit="inch"))
    assert LastSessions(tmp_path).resumed(other).shown.kind == "cone"
    assert LastSessions(tmp_path).resumed(empty).unit == "inch"


def do(console: Console, *events: Event | DecisionEvent) -> None:
    for event in events:
        console.server.get_event_loop().call_soon_threadsafe(console.post, FromPage(PAGE, event))
    console.wait_until_idle()


def started(scene: Simulated, folder: Path, record: Record) -> Console:
    last = LastSessions(folder)
    console = Console(scene.frame, "A pipe", Settings(), port=0, cloud_points=10, record=record, last=last)
    console.start()
    do(console, PageCame(seconds(), PAGE, "Ann"))
    return console


def test_a_console_that_is_started_again_has_its_drawing_and_nothing_decided(scene: Simulated, tmp_path: Path) -> None:
    corners = (VertexClicked(corner, reach_px=0.0) for corner in scene.drawing.area.vertices_px)
    with closing(Record.open(tmp_path)) as record:
        console = started(scene, tmp_path, record)
        do(console, ControlTaken(seconds(), PAGE), *corners, PolygonClosed())
        do(console, KindChosen("cylinder"), SettingTyped("arm_s", 20.0), SettingTyped("sigma_factor", 3.5))
        do(console, SectionToggled(20), UnitChosen("inch"))
        case = console.session.decision.case
        assert case is not None
        now = seconds()
        do(console, PicturesSent(now, PAGE, case.number), ArmPressed(now, PAGE, case.number))
        do(console, *(HoldTicked(now + 0.1 * n, PAGE, case.number) for n in range(13)))
        case = console.session.decision.case
        assert case is not None
        assert isinstance(case.stage, Decided)
        before = console.session
        assert before.reconstruction is not None
        console.stop()
        assert console.told.decision.case is None, "nothing to be told to a robot any more"
        last = record.entry(record.head.id).content
        assert (last["kind"], last["payload"]["reason"]) == ("voided", "the console was closed")

        console = started(scene, tmp_path, record)
        after = console.session
        console.stop()
    assert (after.objects, after.chosen, after.unit) == (before.objects, before.chosen, "inch")
    assert after.settings.sigma_factor == 3.5
    assert after.shown.excluded_sections == {20}
    assert after.decision.control.holder is None
    assert after.decision.case is not None
    assert type(after.decision.case.stage).__name__ == "Proposed"
    assert after.decision.case.offer.digest == case.offer.digest

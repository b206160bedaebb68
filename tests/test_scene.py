"""The scene folder: what is written is read back, what is wrong is said, and the recorded scenes open."""

import os
import re
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rotrecon.errors import SceneError
from rotrecon.frame import DepthCameraNoise, Frame, FrameUnavailable, StereoNoise
from rotrecon.scene.formats.npz import encode_npz
from rotrecon.scene.reading import SHADED_NOTE, read_scene
from rotrecon.scene.writing import SceneRecord, write_scene
from rotrecon.workspace import Workspace
from tests.recordings import FRAMES, recording
from tests.scenes import CAMERA, HEIGHT, TURNED, WIDTH, sample_frame, save, table, with_views

LAWS = settings(deadline=None, max_examples=25)
DEPTHS = arrays(np.float32, (HEIGHT, WIDTH), elements=st.one_of(st.just(np.nan), st.floats(0.125, 4, width=32)))
POSITIVE = st.floats(1e-6, 1e3)
NOISES = st.one_of(
    st.none(), st.builds(StereoNoise, POSITIVE, POSITIVE), st.builds(DepthCameraNoise, POSITIVE, POSITIVE)
)
MOMENTS = st.one_of(st.none(), st.datetimes(timezones=st.sampled_from([UTC, timezone(timedelta(hours=-5.5))])))


@st.composite
def frames(draw: st.DrawFn) -> Frame:
    depth = draw(DEPTHS)
    depth[0, 0] = 1.0
    points = CAMERA.cloud(depth)
    points[..., :2] += np.float32(draw(st.sampled_from([0.0, 0.01])))
    limits = draw(st.sampled_from([Workspace(), Workspace((0.1, 1.5), np.array([[-1.0, -1, 0], [1, 1, 1]]), (0.2, 3))]))
    pose = np.array(draw(st.sampled_from([np.eye(4).tolist(), TURNED])))
    image = draw(arrays(np.uint8, (HEIGHT, WIDTH, 3)))
    return Frame(image, points, CAMERA, pose, draw(NOISES), limits, draw(MOMENTS))


@LAWS
@given(frames())
def test_a_written_frame_is_read_back_exactly(frame):
    with TemporaryDirectory() as folder:
        write_scene(Path(folder) / "scene", SceneRecord("a frame", frame, source="a test"))
        capture = read_scene(Path(folder) / "scene")
    read = capture.recorded
    assert capture.name == "a frame"
    assert "Source: a test" in capture.notes
    assert np.array_equal(read.image, frame.image)
    assert np.array_equal(read.points_m, frame.points_m, equal_nan=True)
    assert np.array_equal(read.camera.K, frame.camera.K)
    assert np.array_equal(read.T_base_camera, frame.T_base_camera)
    assert (read.noise, read.captured_at) == (frame.noise, frame.captured_at)
    assert (read.workspace.reach_m, read.workspace.depth_m) == (frame.workspace.reach_m, frame.workspace.depth_m)
    assert np.array_equal(read.workspace.box_m, frame.workspace.box_m)


def test_a_scene_appears_whole_or_not_at_all(tmp_path, monkeypatch):
    def full(handle: int) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as broken:
        broken.setattr(os, "fsync", full)
        with pytest.raises(SceneError, match=r"No space left on device.*; free some space"):
            write_scene(tmp_path / "scene", SceneRecord("x", sample_frame()))
    assert not any(tmp_path.iterdir())
    write_scene(tmp_path / "scene", SceneRecord("x", sample_frame()), {"truth.json": b"{}"})
    assert {path.name for path in tmp_path.iterdir()} == {"scene"}
    assert {path.name for path in (tmp_path / "scene").iterdir()} == {
        "scene.toml",
        "image.png",
        "depth.npz",
        "truth.json",
    }


def test_a_scene_is_never_written_over_anything(tmp_path):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine").write_text("mine")
    (tmp_path / "empty").mkdir()
    for name in ("file", "full"):
        with pytest.raises(SceneError, match=r"exists already.*name a new folder"):
            write_scene(tmp_path / name, SceneRecord("x", sample_frame()))
    write_scene(tmp_path / "empty", SceneRecord("x", sample_frame()))
    assert read_scene(tmp_path / "empty").name == "x"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"noise": StereoNoise(0.0, 0.1)}, "frame.noise.baseline_m is 0"),
        ({"T_base_camera": np.diag([1.0, 1, -1, 1])}, "not a rigid pose"),
        ({"captured_at": datetime(2026, 1, 31)}, "time zone"),
        ({"points_m": np.full((HEIGHT, WIDTH, 3), np.nan, np.float32)}, "no valid depth"),
        ({"points_m": np.ones((HEIGHT, WIDTH, 3), np.float32)}, "cameras.main.K"),
    ],
)
def test_what_would_not_be_read_again_is_not_written(tmp_path, change, words):
    frame = Frame(**(vars(sample_frame()) | change))
    with pytest.raises(SceneError, match=re.escape(words)):
        write_scene(tmp_path / "scene", SceneRecord("x", frame))
    assert not any(tmp_path.iterdir())


def test_everything_that_a_scene_may_say_is_read(tmp_path):
    frame = read_scene(save(tmp_path, table())).recorded
    assert frame.noise == StereoNoise(0.09, 0.15)
    assert frame.workspace.reach_m == (0.1, 1.5)
    assert frame.captured_at == datetime(2026, 1, 31, tzinfo=UTC)
    assert np.array_equal(frame.T_base_camera, TURNED)
    assert np.array_equal(frame.points_m, sample_frame().points_m)
    assert not frame.points_m.flags.writeable


def test_a_depth_png_is_read_in_its_scale(tmp_path):
    scene = table()
    scene["frame"] |= {"depth": "depth.png", "depth_scale": 0.001}
    frame = read_scene(save(tmp_path, scene)).recorded
    assert np.allclose(frame.depth_m, sample_frame().depth_m, atol=0.0006)


@pytest.mark.parametrize("cloud", ["cloud.npz", "flat.npz"])
def test_a_cloud_takes_the_place_of_depth(tmp_path, cloud):
    scene = table()
    del scene["frame"]["depth"], scene["frame"]["image"]
    scene["frame"]["cloud"] = cloud
    capture = read_scene(save(tmp_path, scene))
    assert np.array_equal(capture.recorded.points_m, sample_frame().points_m)
    assert capture.recorded.image.shape == (HEIGHT, WIDTH, 3)
    assert SHADED_NOTE in capture.notes


def test_the_picture_of_a_cloud_is_its_colours(tmp_path):
    scene = table()
    del scene["frame"]["depth"], scene["frame"]["image"]
    scene["frame"]["cloud"] = "cloud.npz"
    colors = np.random.default_rng(1).integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)
    content = encode_npz(points_m=sample_frame().points_m, colors=colors)
    assert np.array_equal(read_scene(save(tmp_path, scene, **{"cloud.npz": content})).recorded.image, colors)


def test_views_are_read_with_the_limits_of_the_arm(tmp_path):
    capture = read_scene(save(tmp_path, with_views({}, {"T_base_camera": np.eye(4).tolist()})))
    assert len(capture.views) == 2
    assert np.array_equal(capture.views[0].T_base_camera, TURNED)
    assert capture.workspace.reach_m == (0.1, 1.5)
    assert isinstance(capture.frame(), FrameUnavailable)


@pytest.mark.parametrize("name", FRAMES)
def test_a_recorded_frame_opens(name):
    frame = read_scene(recording(name)).frame()
    assert isinstance(frame, Frame)
    assert frame.image.shape == frame.points_m.shape == (frame.camera.height, frame.camera.width, 3)
    assert frame.image.std() > 1
    assert 0.1 < np.isfinite(frame.depth_m).mean() < 1
    assert 0.05 < np.nanmedian(frame.depth_m) < 3


def test_the_recorded_views_open_and_are_matched():
    capture = read_scene(recording("virtual_stereo"))
    assert len(capture.views) == 2
    assert capture.views[0].image.shape == (1024, 1280, 3)
    frame = capture.frame()
    assert isinstance(frame, Frame)
    assert frame.image is capture.views[0].image
    assert frame.views == capture.views
    assert 1.0 < np.nanmedian(frame.depth_m) < 1.5

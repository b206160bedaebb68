"""Foreign recordings become scenes, and say how their camera was found."""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.rosbag2 import StoragePlugin

from rotrecon.camera import PinholeCamera
from rotrecon.capture import Capture
from rotrecon.errors import SceneError
from rotrecon.scene.formats.image import encode_png
from rotrecon.scene.formats.npz import encode_npz
from rotrecon.scene.importing import ImportOptions, import_scene
from rotrecon.scene.intrinsics import Intrinsics, recover_intrinsics
from rotrecon.scene.reading import read_scene
from tests.bags import CAMERA, TOPIC, TRUTH, colors, depth, write_bag
from tests.recordings import recording


def close(capture: Capture, camera: Intrinsics, tolerance: float = 1e-3) -> bool:
    assert capture.recorded is not None
    return np.allclose(capture.recorded.camera.K, camera.K, atol=tolerance)


# Bags


BAGS = [(1, {}), (1, {"big_endian": True}), (2, {}), (2, {"storage": StoragePlugin.MCAP}), (2, {"big_endian": True})]


@pytest.mark.parametrize(("ros", "how"), BAGS)
def test_a_bag_becomes_a_scene(tmp_path, ros, how):
    points = CAMERA.cloud(depth())
    bag = (
        write_bag(tmp_path / "run.bag", 1, points, **how) if ros == 1 else write_bag(tmp_path / "run", 2, points, **how)
    )
    capture = import_scene(bag, tmp_path / "scene")
    frame = capture.recorded
    assert capture.name == "run"
    assert close(capture, TRUTH)
    assert any("intrinsics recovered from the cloud" in note and TOPIC in note for note in capture.notes)
    assert np.array_equal(frame.points_m, points, equal_nan=True)
    assert np.array_equal(frame.image, colors())
    assert frame.captured_at.timestamp() == 1_700_000_000.5
    assert np.array_equal(read_scene(tmp_path / "scene").recorded.points_m, points, equal_nan=True)


@pytest.mark.parametrize("ros", [1, 2])
def test_a_camera_info_that_fits_is_used(tmp_path, ros):
    near = Intrinsics(50.25, 52.25, 15.125, 11.5)
    bag = write_bag(tmp_path / ("run.bag" if ros == 1 else "run"), ros, CAMERA.cloud(depth()), camera=near)
    capture = import_scene(bag, tmp_path / "scene")
    assert close(capture, near, 1e-12)
    assert any("camera_info" in note for note in capture.notes)


def test_a_camera_info_that_does_not_fit_is_not_used(tmp_path):
    bag = write_bag(tmp_path / "run", 2, CAMERA.cloud(depth()), camera=Intrinsics(500.0, 500.0, 15.0, 11.0))
    capture = import_scene(bag, tmp_path / "scene")
    assert close(capture, TRUTH)
    assert any("recovered" in note for note in capture.notes)


def test_intrinsics_that_are_given_are_kept_and_nothing_is_said_to_be_recovered(tmp_path):
    bag = write_bag(tmp_path / "run", 2, CAMERA.cloud(depth()))
    capture = import_scene(bag, tmp_path / "scene", ImportOptions(intrinsics=TRUTH, name="mine"))
    assert close(capture, TRUTH, 1e-12)
    assert capture.name == "mine"
    assert not any("recovered" in note for note in capture.notes)


def test_the_topic_of_a_bag_is_chosen_by_name(tmp_path):
    bag = write_bag(tmp_path / "run", 2, CAMERA.cloud(depth()), topics=("/left", "/right"))
    assert_refused(bag, tmp_path, ImportOptions(), "has clouds on /left, /right; name one of these topics")
    assert_refused(bag, tmp_path, ImportOptions(topic="/up"), "no cloud on topic /up; name one of /left, /right")
    assert any("/right" in note for note in import_scene(bag, tmp_path / "scene", ImportOptions(topic="/right")).notes)


def test_a_damaged_bag_is_refused(tmp_path):
    bag = write_bag(tmp_path / "run.bag", 1, CAMERA.cloud(depth()))
    content = bag.read_bytes()
    for kept in (0, 5, 300, len(content) // 2, len(content) - 40):
        bag.write_bytes(content[:kept])
        assert_refused(bag, tmp_path, ImportOptions(), "truncated or damaged bag")


@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_a_damaged_bag_folder_is_refused(tmp_path, storage):
    bag = write_bag(tmp_path / "run", 2, CAMERA.cloud(depth()), storage=storage)
    content = next(path for path in bag.iterdir() if path.suffix in (".db3", ".mcap"))
    content.write_bytes(content.read_bytes()[: content.stat().st_size // 2])
    assert_refused(bag, tmp_path, ImportOptions(), "truncated or damaged bag")
    (bag / "metadata.yaml").unlink()
    assert_refused(bag, tmp_path, ImportOptions(), "with its metadata.yaml")


def test_a_cloud_in_other_coordinates_is_refused(tmp_path):
    x, y, z = np.moveaxis(CAMERA.cloud(depth()), -1, 0)
    bag = write_bag(tmp_path / "run", 2, np.stack([z, -x, -y], axis=-1), frame="base_link")
    assert_refused(bag, tmp_path, ImportOptions(), "x right, y down, z forward")


def test_the_recorded_bag_gives_its_known_camera(tmp_path):
    capture = import_scene(recording("ros1_can") / "perception_tutorial.bag", tmp_path / "scene")
    assert close(capture, Intrinsics(525.0, 525.0, 319.5, 239.5), 0.01)
    frame = capture.recorded
    assert frame.image.shape == (480, 640, 3)
    assert 0.8 < np.nanmedian(frame.depth_m[283:363, 268:307]) < 1.1
    assert capture.notes == read_scene(tmp_path / "scene").notes


# Clouds


def test_the_recorded_pcd_gives_its_known_camera(tmp_path):
    source = recording("pr2_mug") / "table_scene_mug_stereo_textured.pcd"
    assert close(import_scene(source, tmp_path / "scene"), Intrinsics(964.36, 964.36, 319.81, 223.36), 0.05)


def test_a_cloud_without_colours_says_that_its_picture_is_shaded(tmp_path):
    (tmp_path / "a.npz").write_bytes(encode_npz(points_m=CAMERA.cloud(depth())))
    assert any("shaded" in note for note in import_scene(tmp_path / "a.npz", tmp_path / "scene").notes)


def test_an_unorganised_cloud_needs_its_camera(tmp_path):
    flat = CAMERA.cloud(depth()).reshape(-1, 3)
    (tmp_path / "a.npz").write_bytes(encode_npz(points_m=flat, colors=colors().reshape(-1, 3)))
    for options in (ImportOptions(), ImportOptions(intrinsics=TRUTH), ImportOptions(size=(32, 24))):
        assert_refused(tmp_path / "a.npz", tmp_path, options, "fx,fy,cx,cy in pixels and the size WxH")
    frame = import_scene(
        tmp_path / "a.npz", tmp_path / "scene", ImportOptions(intrinsics=TRUTH, size=(32, 24))
    ).recorded
    assert np.array_equal(frame.points_m, CAMERA.cloud(depth()), equal_nan=True)


def test_the_recorded_cloud_with_its_axes_turned_is_refused(tmp_path):
    options = ImportOptions(intrinsics=Intrinsics(421.139, 421.139, 426.176, 237.017), size=(848, 480))
    assert_refused(recording("concrete_pipe") / "cloud.ply", tmp_path, options, "z pointing away from the camera")


@settings(deadline=None, max_examples=25)
@given(st.floats(30, 300), st.floats(30, 300), st.floats(0, 32), st.floats(0, 24), st.integers(0, 2**31))
def test_intrinsics_are_recovered_in_spite_of_bad_pixels(fx, fy, cx, cy, seed):
    truth = Intrinsics(fx, fy, cx, cy)
    points = PinholeCamera(32, 24, truth.K).cloud(depth())
    random = np.random.default_rng(seed)
    bad = random.random((24, 32)) < 0.1
    points[bad] = random.uniform(0.01, 3, (int(bad.sum()), 3))
    recovered = recover_intrinsics(points)
    assert recovered is not None
    assert np.allclose(recovered.K, truth.K, rtol=0.01, atol=0.1)


@pytest.mark.parametrize(
    "points",
    [
        np.full((24, 32, 3), np.nan, np.float32),
        np.ones((24, 32, 3), np.float32),
        CAMERA.cloud(depth()) * np.array([-1, -1, 1], np.float32),
    ],
)
def test_no_camera_is_made_up(points):
    assert recover_intrinsics(points) is None


# A picture with its depth


@pytest.fixture
def pair(tmp_path) -> tuple[Path, Path]:
    (tmp_path / "rgb.png").write_bytes(encode_png(colors()))
    (tmp_path / "depth.png").write_bytes(encode_png(np.nan_to_num(depth() * 1000).astype(np.uint16)))
    return tmp_path / "rgb.png", tmp_path / "depth.png"


def test_a_picture_with_its_depth_becomes_a_scene(tmp_path, pair):
    image, map_file = pair
    options = ImportOptions(depth=map_file, depth_scale=0.001, intrinsics=TRUTH)
    frame = import_scene(image, tmp_path / "scene", options).recorded
    assert np.array_equal(frame.image, colors())
    assert np.allclose(frame.depth_m, depth(), atol=0.0011, equal_nan=True)
    assert np.array_equal(frame.camera.K, TRUTH.K)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"depth": None, "depth_scale": None}, "source is a picture without depth; give its depth map too"),
        ({"depth_scale": None}, "depth is a PNG without depth_scale"),
        ({"depth_scale": -1.0}, "depth_scale is -1"),
        ({"depth": None}, "depth_scale is 0.001"),
        ({"intrinsics": None}, "give fx,fy,cx,cy in pixels"),
        ({"intrinsics": Intrinsics(-1, 1, 0, 0)}, "intrinsics has focal lengths -1 and 1"),
        ({"size": (31, 24)}, "size is 31 x 24 but the recording is 32 x 24"),
        ({"size": (0, 24)}, "size is not positive"),
        ({"topic": "/points"}, "topic is given for a file that is not a bag"),
        ({"depth": Path("none.png")}, "none.png: depth names a file that does not exist"),
    ],
)
def test_a_pair_that_cannot_be_used_is_refused(tmp_path, pair, change, words):
    options = ImportOptions(**({"depth": pair[1], "depth_scale": 0.001, "intrinsics": TRUTH} | change))
    assert_refused(pair[0], tmp_path, options, words)


def test_a_depth_of_another_size_is_refused(tmp_path, pair):
    pair[1].write_bytes(encode_png(np.ones((5, 6), np.uint16)))
    options = ImportOptions(depth=pair[1], depth_scale=0.001, intrinsics=TRUTH)
    assert_refused(pair[0], tmp_path, options, "depth is 6 x 5 but the picture rgb.png is 32 x 24")


# Whatever else is named


def test_intrinsics_that_contradict_an_organised_cloud_are_refused(tmp_path):
    (tmp_path / "a.npz").write_bytes(encode_npz(points_m=CAMERA.cloud(depth())))
    options = ImportOptions(intrinsics=Intrinsics(500.0, 500.0, 16.0, 12.0))
    assert_refused(tmp_path / "a.npz", tmp_path, options, "leave them out to have them recovered")


@pytest.mark.parametrize("name", ["none.pcd", "none.bag", "none.png", "none.xyz", "none"])
def test_a_missing_source_is_refused(tmp_path, name):
    assert_refused(tmp_path / name, tmp_path, ImportOptions(), "; ")


def test_nothing_is_written_over(tmp_path):
    (tmp_path / "scene").mkdir()
    (tmp_path / "scene" / "mine").write_text("mine")
    (tmp_path / "a.npz").write_bytes(encode_npz(points_m=CAMERA.cloud(depth())))
    with pytest.raises(SceneError, match=r"exists already.*name a new folder"):
        import_scene(tmp_path / "a.npz", tmp_path / "scene")
    assert [path.name for path in (tmp_path / "scene").iterdir()] == ["mine"]


def assert_refused(source: Path, folder: Path, options: ImportOptions, words: str) -> None:
    before = set(folder.iterdir())
    with pytest.raises(SceneError, match=re.escape(words)) as refusal:
        import_scene(source, folder / "refused", options)
    assert re.fullmatch(r"[^\n]+: [^\n]+; [^\n]+\.", str(refusal.value))
    assert set(folder.iterdir()) == before

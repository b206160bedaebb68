"""The scene folder: what is written is read back, what is wrong is said, and the recorded scenes open."""

import os
import re
from copy import deepcopy
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from plyfile import PlyData, PlyElement

from rotrecon.camera import PinholeCamera
from rotrecon.errors import SceneError
from rotrecon.formats.image import encode_png
from rotrecon.formats.npz import encode_npz
from rotrecon.frame import DepthCameraNoise, Frame, FrameUnavailable, StereoNoise
from rotrecon.lens import Lens, pixel_grid
from rotrecon.organise import z_buffer
from rotrecon.scene import SHADED_NOTE, SceneRecord, read_scene, write_scene
from rotrecon.workspace import Workspace
from tests.recordings import FRAMES, recording

LAWS = settings(deadline=None, max_examples=25)
WIDTH, HEIGHT = 8, 6
CAMERA = PinholeCamera(WIDTH, HEIGHT, np.array([[10.0, 0, 3.5], [0, 11.0, 2.5], [0, 0, 1]]))
TURNED = [[0.0, -1.0, 0.0, 0.1], [1.0, 0.0, 0.0, 0.2], [0.0, 0.0, 1.0, 0.3], [0.0, 0.0, 0.0, 1.0]]

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


def sample_frame() -> Frame:
    depth = np.linspace(0.5, 1.5, WIDTH * HEIGHT, dtype=np.float32).reshape(HEIGHT, WIDTH)
    return Frame(np.full((HEIGHT, WIDTH, 3), 90, np.uint8), CAMERA.cloud(depth), CAMERA)


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


def table() -> dict[str, Any]:
    """A scene.toml with everything that may stand in one with a frame."""
    return {
        "format": 1,
        "name": "a scene",
        "cameras": {"main": {"size": [WIDTH, HEIGHT], "K": CAMERA.K.tolist(), "distortion": []}},
        "frame": {
            "camera": "main",
            "image": "image.png",
            "depth": "depth.npz",
            "T_base_camera": deepcopy(TURNED),
            "captured_at": datetime(2026, 1, 31, tzinfo=UTC),
            "noise": {"model": "stereo", "baseline_m": 0.09, "disparity_sigma_px": 0.15},
        },
        "workspace": {"reach_m": [0.1, 1.5], "box_m": [[-1, -1, 0], [1, 1, 1]], "depth_m": [0.2, 3.0]},
    }


def with_views(*changes: dict[str, Any]) -> dict[str, Any]:
    scene = table()
    del scene["frame"]
    scene["views"] = [{"image": "image.png", "camera": "main", "T_base_camera": TURNED} | change for change in changes]
    return scene


def save(folder: Path, scene: dict[str, Any], **files: bytes) -> Path:
    depth = sample_frame().depth_m
    contents = {
        "image.png": encode_png(sample_frame().image),
        "depth.npz": encode_npz(depth_m=depth),
        "depth.png": encode_png(np.rint(depth * 1000).astype(np.uint16)),
        "cloud.npz": encode_npz(points_m=CAMERA.cloud(depth)),
        "flat.npz": encode_npz(points_m=CAMERA.cloud(depth).reshape(-1, 3)),
        "small.png": encode_png(np.zeros((2, 3, 3), np.uint8)),
        "small.npz": encode_npz(depth_m=np.ones((2, 3))),
        "empty.npz": encode_npz(depth_m=np.zeros((HEIGHT, WIDTH))),
        "slanted.npz": encode_npz(points_m=CAMERA.cloud(depth) + np.array([1, 0, 0], np.float32)),
        "cut.png": encode_png(sample_frame().image)[:-20],
        "cut.npz": encode_npz(depth_m=depth)[:-20],
        "scene.toml": tomli_w.dumps(scene).encode(),
    }
    for name, content in (contents | files).items():
        (folder / name).write_bytes(content)
    return folder


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


def test_views_are_read_and_ask_for_stereo_matching(tmp_path):
    capture = read_scene(save(tmp_path, with_views({}, {"T_base_camera": np.eye(4).tolist()})))
    assert len(capture.views) == 2
    assert np.array_equal(capture.views[0].T_base_camera, TURNED)
    assert isinstance(capture.frame(), FrameUnavailable)


REMOVED = object()
K_REMEDY = "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]"


@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        ("format", 2, "format is 2"),
        ("format", "1", "format is '1'"),
        ("format", REMOVED, "format is missing"),
        ("name", REMOVED, "missing required field name"),
        ("name", " ", "name is empty"),
        ("units", "mm", "unknown field units"),
        ("frame.unit", "mm", "unknown field unit); remove it or correct its spelling; the fields there are camera,"),
        ("cameras.main.fov", 60, "the fields there are size, K, distortion"),
        ("cameras.main.size", [8, 6, 3], "size = [640, 480]"),
        ("cameras.main.size", [0, 6], "cameras.main.size is 0 x 6"),
        ("cameras.main.size", [50_000, 50_000], "cameras.main.size is 50000 x 50000"),
        ("cameras.main.size", [9, 6], "frame.depth is 8 x 6 but cameras.main.size is 9 x 6"),
        ("cameras.main.K", [[10, 0], [0, 10]], K_REMEDY),
        ("cameras.main.K", [[-10, 0, 3], [0, 10, 3], [0, 0, 1]], "must be positive"),
        ("cameras.main.K", [[0.004, 0, 3], [0, 0.004, 3], [0, 0, 1]], "no pixels of a 8 x 6 picture"),
        ("cameras.main.K", [[10, 1, 3], [0, 10, 3], [0, 0, 1]], "skew"),
        ("cameras.main.K", [[10, 0, 3], [2, 10, 3], [0, 0, 1]], "skew"),
        ("cameras.main.K", [[10, 0, 3], [0, 10, 3], [0, 0, 2]], "last row"),
        ("cameras.main.K", [[10, 0, float("nan")], [0, 10, 3], [0, 0, 1]], "not finite"),
        ("cameras.main.distortion", [0.1, 0.2, 0.3], "cameras.main.distortion has 3 numbers"),
        ("cameras.main.distortion", [0.1, 0.2, 0.3, float("inf")], "not finite"),
        ("frame", REMOVED, "[frame] and [[views]] are both missing"),
        ("views", [{"image": "image.png", "camera": "main", "T_base_camera": TURNED}] * 2, "are both there"),
        ("frame.camera", "other", "frame.camera is 'other', and the cameras here are main"),
        ("frame.image", "none.png", "none.png: frame.image names a file that does not exist"),
        ("frame.image", "cut.png", "cut.png: frame.image is a truncated or damaged picture"),
        ("frame.image", "small.png", "small.png: frame.image is 3 x 2 but cameras.main.size is 8 x 6"),
        ("frame.image", "/image.png", "leads out of the scene folder"),
        ("frame.image", "../image.png", "leads out of the scene folder"),
        ("frame.image", "a/../image.png", "leads out of the scene folder"),
        ("frame.image", "", "leads out of the scene folder"),
        ("frame.image", ".", "not a file"),
        ("frame.depth", REMOVED, "frame.depth and frame.cloud are both missing"),
        ("frame.cloud", "cloud.npz", "frame.depth and frame.cloud are both there"),
        ("frame.depth", "none.npz", "none.npz: frame.depth names a file that does not exist"),
        ("frame.depth", "cut.npz", "cut.npz: frame.depth is not an NPZ archive, or is truncated"),
        ("frame.depth", "small.npz", "frame.depth is 3 x 2"),
        ("frame.depth", "empty.npz", "frame.depth has no valid depth"),
        ("frame.depth", "depth.png", "depth_scale = 0.001"),
        ("frame.depth", "../../depth.npz", "leads out of the scene folder"),
        ("frame.depth_scale", "mm", "depth_scale = 0.001"),
        ("frame.depth_scale", -1.0, "frame.depth_scale is -1"),
        ("frame.depth_scale", float("nan"), "frame.depth_scale is nan"),
        ("frame.depth_scale", 0.001, "takes no depth_scale"),
        ("frame.T_base_camera", np.diag([1.0, 1, 2, 1]).tolist(), "not a rigid pose"),
        ("frame.T_base_camera", np.diag([1.0, 1, -1, 1]).tolist(), "not a rigid pose"),
        ("frame.T_base_camera", np.diag([1e308, 1, 1, 1]).tolist(), "not a rigid pose"),
        ("frame.T_base_camera", np.eye(3).tolist(), "four rows of four"),
        ("frame.T_base_camera", [[float("nan")] * 4] * 4, "not a rigid pose"),
        ("frame.captured_at", "2026-01-31T12:00:00Z", "captured_at = 2026-01-31T12:00:00Z"),
        ("frame.captured_at", datetime(2026, 1, 31), "time zone"),
        ("frame.noise.model", "laser", 'model = "stereo", baseline_m'),
        ("frame.noise.model", REMOVED, 'model = "stereo", baseline_m'),
        ("frame.noise.baseline_m", "90 mm", "baseline_m"),
        ("frame.noise.baseline_m", 0, "frame.noise.baseline_m is 0; give a positive number"),
        ("frame.noise.disparity_sigma_px", float("inf"), "give a positive number"),
        ("workspace.reach_m", [1.5, 0.1], "workspace.reach_m has the limits 1.5 and 0.1"),
        ("workspace.depth_m", [1.0, float("nan")], "workspace.depth_m"),
        ("workspace.box_m", [[-1, -1, 2], [1, 1, 1]], "lowest and highest corner in metres"),
        ("workspace.reach_m", ["10 cm", "1 m"], "reach_m = [0.1, 1.5], nearest and farthest in metres"),
    ],
)
def test_a_scene_that_is_wrong_is_refused_with_a_remedy(tmp_path, place, value, words):
    scene = table()
    *way, last = place.split(".")
    inner = scene
    for key in way:
        inner = inner[key]
    if value is REMOVED:
        del inner[last]
    else:
        inner[last] = value
    assert_refused(save(tmp_path, scene), words)


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (with_views({}), "[[views]] has a single view"),
        (with_views({}, {"camera": "other"}), "views[1].camera is 'other'"),
        (with_views({}, {"image": "cut.png"}), "cut.png: views[1].image is a truncated or damaged picture"),
        (with_views({}, {"image": "small.png"}), "views[1].image is 3 x 2"),
        (with_views({}, {"T_base_camera": np.diag([2.0, 1, 1, 1]).tolist()}), "views[1].T_base_camera is not a rigid"),
        (with_views({}, {"depth": "depth.npz"}), "unknown field depth"),
    ],
)
def test_views_that_are_wrong_are_refused_with_a_remedy(tmp_path, scene, words):
    assert_refused(save(tmp_path, scene), words)


@pytest.mark.parametrize("content", [b"format = ", b"\xff\xfe", b"format = 1\nformat = 1", b"a = " + b"[" * 5000])
def test_a_scene_that_is_not_toml_is_refused(tmp_path, content):
    assert_refused(save(tmp_path, table(), **{"scene.toml": content}), "is not TOML")


def test_a_folder_without_a_scene_is_refused(tmp_path):
    assert_refused(tmp_path, "make one with rotrecon import")
    assert_refused(tmp_path / "none", "scene.toml is missing")


@pytest.mark.parametrize("image", ["image.png", None])
def test_an_organised_cloud_off_its_rays_names_the_camera_matrix(tmp_path, image):
    scene = table()
    scene["frame"] = {"camera": "main", "cloud": "slanted.npz"} | ({"image": image} if image else {})
    assert_refused(save(tmp_path, scene), "cameras.main.K puts the points of slanted.npz")


def test_a_cloud_that_the_camera_does_not_see_is_refused(tmp_path):
    scene = table()
    scene["frame"] = {"camera": "main", "cloud": "flat.npz"}
    aside = encode_npz(points_m=np.array([[100.0, 0, 1]]))
    assert_refused(save(tmp_path, scene, **{"flat.npz": aside}), "cameras.main sees none of the recorded points")


def assert_refused(folder: Path, words: str) -> None:
    with pytest.raises(SceneError) as refusal:
        read_scene(folder)
    message = str(refusal.value)
    assert message.startswith(str(folder))
    assert words in message
    assert "; " in message
    assert message.endswith(".")


# Clouds without a raster

CLOUDS = arrays(np.float32, (40, 3), elements=st.floats(0.25, 4, width=32))


@LAWS
@given(CLOUDS, arrays(np.uint8, (40, 3)), st.randoms(use_true_random=False))
def test_the_order_of_an_unorganised_cloud_does_not_matter(points, colors, random):
    order = random.sample(range(len(points)), len(points))
    cloud, picture = z_buffer(points, colors, CAMERA)
    again, picture_again = z_buffer(points[order], colors[order], CAMERA)
    assert np.array_equal(cloud, again, equal_nan=True)
    assert np.array_equal(picture, picture_again)


@LAWS
@given(CLOUDS)
def test_the_nearest_point_is_kept(points):
    cloud, _ = z_buffer(points, None, CAMERA)
    nearest = np.full((HEIGHT, WIDTH), np.inf, np.float32)
    for point, (u, v) in zip(points, np.rint(CAMERA.project(points)).astype(int), strict=True):
        if 0 <= u < WIDTH and 0 <= v < HEIGHT:
            nearest[v, u] = min(nearest[v, u], point[2])
    assert np.array_equal(np.nan_to_num(cloud[..., 2], nan=np.inf), nearest)


def test_an_unorganised_ply_is_put_behind_the_pixels(tmp_path):
    points = sample_frame().points_m.reshape(-1, 3)[::-1]
    vertices = np.array([tuple(point) for point in points], [("x", "f4"), ("y", "f4"), ("z", "f4")])
    PlyData([PlyElement.describe(vertices, "vertex")]).write(tmp_path / "cloud.ply")
    scene = table()
    scene["frame"] = {"camera": "main", "cloud": "cloud.ply"}
    assert np.array_equal(read_scene(save(tmp_path, scene)).recorded.points_m, sample_frame().points_m)


# Distorted cameras

WIDE = PinholeCamera(80, 60, np.array([[70.0, 0, 39.5], [0, 70.0, 29.5], [0, 0, 1]]))
BARREL = Lens(WIDE, np.array([-0.2, 0.05, 0.001, -0.001]))


def recorded_step() -> tuple[np.ndarray, np.ndarray]:
    """Depth of a near and a far wall in the distorted raster, and the rays of its pixels."""
    rays = BARREL.cloud(np.ones((60, 80), np.float32))
    return np.where(rays[..., 0] < 0.05, np.float32(1), np.float32(2)), rays


@pytest.mark.parametrize("kind", ["depth", "cloud"])
def test_undistortion_never_invents_a_depth(tmp_path, kind):
    depth, rays = recorded_step()
    distorted = {"size": [80, 60], "K": WIDE.K.tolist(), "distortion": BARREL.distortion.tolist()}
    scene = table() | {"cameras": {"main": distorted}, "frame": {"camera": "main", kind: f"{kind}.npz"}}
    arrays_of = {"depth": {"depth_m": depth}, "cloud": {"points_m": rays * depth[..., None]}}
    folder = save(tmp_path, scene, **{f"{kind}.npz": encode_npz(**arrays_of[kind])})
    frame = read_scene(folder).recorded
    seen = np.isfinite(frame.depth_m)
    assert set(np.unique(frame.depth_m[seen])) == {1, 2}
    off = np.abs(WIDE.project(frame.points_m)[seen] - pixel_grid(WIDE)[seen])
    assert off.max() < 0.75
    x = frame.points_m[..., 0][seen] / frame.depth_m[seen]
    assert np.array_equal(frame.depth_m[seen], np.where(x < 0.05, 1, 2))


def test_the_picture_and_the_depth_are_undistorted_alike(tmp_path):
    depth, _ = recorded_step()
    image = np.repeat(np.where(depth == 1, 255, 0).astype(np.uint8)[..., None], 3, axis=-1)
    distorted = {"size": [80, 60], "K": WIDE.K.tolist(), "distortion": BARREL.distortion.tolist()}
    scene = table() | {"cameras": {"main": distorted}}
    scene["frame"] = {"camera": "main", "image": "image.png", "depth": "depth.npz"}
    files = {"image.png": encode_png(image), "depth.npz": encode_npz(depth_m=depth)}
    frame = read_scene(save(tmp_path, scene, **files)).recorded
    bright = frame.image[..., 0] > 127
    assert (bright == (frame.depth_m == 1))[np.isfinite(frame.depth_m)].mean() > 0.995


def test_a_lens_beyond_all_numbers_leaves_nothing(tmp_path):
    distorted = {"size": [WIDTH, HEIGHT], "K": CAMERA.K.tolist(), "distortion": [1e308, 1e308, 0, 0]}
    assert_refused(save(tmp_path, table() | {"cameras": {"main": distorted}}), "sees none of the recorded points")


def test_where_a_lens_cannot_be_inverted_there_is_no_depth():
    folding = Lens(WIDE, np.array([-2.0, 0.0, 0.0, 0.0]))
    cloud = folding.cloud(np.ones((60, 80), np.float32))
    assert np.isnan(cloud[0, 0]).all()
    assert np.isfinite(cloud[30, 40]).all()


# Recordings


@pytest.mark.parametrize("name", FRAMES)
def test_a_recorded_frame_opens(name):
    frame = read_scene(recording(name)).frame()
    assert isinstance(frame, Frame)
    assert frame.image.shape == frame.points_m.shape == (frame.camera.height, frame.camera.width, 3)
    assert frame.image.std() > 1
    assert 0.1 < np.isfinite(frame.depth_m).mean() < 1
    assert 0.05 < np.nanmedian(frame.depth_m) < 3


def test_the_recorded_views_open_and_ask_for_stereo_matching():
    capture = read_scene(recording("virtual_stereo"))
    assert len(capture.views) == 2
    assert capture.views[0].image.shape == (1024, 1280, 3)
    answer = capture.frame()
    assert isinstance(answer, FrameUnavailable)
    assert "stereo matching" in answer.reason

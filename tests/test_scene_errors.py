"""Whatever is wrong with a scene folder is said in one sentence with the file, the field and the remedy."""

from datetime import datetime

import numpy as np
import pytest

from rotrecon.scene.formats.npz import encode_npz
from tests.scenes import TURNED, assert_refused, save, table, with_views

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
        ("cameras.main.K", [[60, 0, 3], [0, 10, 3], [0, 0, 1]], "so unequal"),
        ("cameras.main.K", [[10, 0, 1e300], [0, 10, 3], [0, 0, 1]], "far outside a picture"),
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
        ("frame.T_base_camera", (np.eye(4) + 1e30 * np.eye(4, k=3)).tolist(), "puts the camera over 1000 m away"),
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
        ("workspace.reach_m", [0.1, 1e30], "nearest and farthest in metres"),
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
    assert_refused(tmp_path / "none", "the scene does not exist")


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

"""A simulated scene repeats, is drawn as an operator would draw it, and comes back from disk as it was."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from rotrecon.camera import PinholeCamera, is_rigid, transform
from rotrecon.frame import StereoNoise
from rotrecon.primitives import Frustum, Primitive
from rotrecon.scene.reading import read_scene
from rotrecon.simulation.ideal_drawing import as_arguments, ideal_drawing, outline_px, perturb
from rotrecon.simulation.simulate import DEFAULT_CAMERA, OBJECTS, TILT_RAD, simulate
from rotrecon.simulation.stereo_noise import StereoErrors
from rotrecon.simulation.truth import write_simulated

SMALL = PinholeCamera(320, 240, np.array([[300.0, 0, 159.5], [0, 300.0, 119.5], [0, 0, 1]]))
WIDE = PinholeCamera(1280, 720, np.array([[900.0, 0, 639.5], [0, 900.0, 359.5], [0, 0, 1]]))


def filled(vertices: np.ndarray, camera: PinholeCamera) -> np.ndarray:
    mask = np.zeros((camera.height, camera.width), np.uint8)
    fixed = np.rint(np.asarray(vertices) * 256).astype(np.int32)
    return cv2.fillPoly(mask, [fixed.reshape(-1, 1, 2)], 1, shift=8).astype(bool)


def test_the_same_seed_gives_the_same_scene_and_another_seed_another() -> None:
    first, again, other = (simulate("cone", seed, camera=SMALL) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first.frame.image, again.frame.image)
    np.testing.assert_array_equal(first.frame.points_m, again.frame.points_m)
    assert first.drawing == again.drawing
    assert not np.array_equal(first.frame.image, other.frame.image)
    assert not np.allclose(first.solid.center_m, other.solid.center_m)


def test_noise_changes_depth_and_nothing_else() -> None:
    noisy, clean = simulate("wire", 1, camera=SMALL), simulate("wire", 1, camera=SMALL, noise=None)
    np.testing.assert_array_equal(noisy.frame.image, clean.frame.image)
    np.testing.assert_array_equal(clean.frame.depth_m, clean.view.depth_m.astype(np.float32))
    assert noisy.drawing == clean.drawing
    assert clean.frame.noise is None
    assert noisy.frame.noise == StereoNoise(0.1, 0.15)
    assert np.isnan(noisy.frame.depth_m).any()


@pytest.mark.parametrize("name", OBJECTS)
def test_truth_in_base_and_camera_coordinates_agree(name: str) -> None:
    scene = simulate(name, 2, camera=SMALL, noise=None, supersampling=1)
    pose = scene.frame.T_base_camera
    assert is_rigid(pose, 1e-12)
    assert np.abs(pose - np.eye(4)).max() > 0.3
    np.testing.assert_allclose(transform(pose, scene.solid_in_camera.center_m), scene.solid.center_m)
    assert 0.6 <= scene.solid_in_camera.center_m[2] <= 1.2
    assert abs(scene.solid_in_camera.direction[2]) <= np.sin(TILT_RAD)
    assert scene.diameter_mm == pytest.approx({"leg": 36, "ball": 216, "wire": 25, "pipe": 100, "cone": 100}[name])


@pytest.mark.parametrize("name", OBJECTS)
def test_the_outline_is_where_the_object_is_seen(name: str) -> None:
    scene = simulate(name, 4, camera=SMALL, noise=None, supersampling=1)
    outline = filled(outline_px(scene.solid_in_camera, SMALL), SMALL)
    border = cv2.dilate(scene.view.mask.astype(np.uint8), np.ones((3, 3))) != cv2.erode(
        scene.view.mask.astype(np.uint8), np.ones((3, 3))
    )
    assert not ((outline != scene.view.mask) & ~border).any()


@pytest.mark.parametrize("name", OBJECTS)
@pytest.mark.parametrize("seed", range(3))
def test_the_drawing_holds_the_middle_of_the_object(name: str, seed: int) -> None:
    scene = simulate(name, seed, noise=None, supersampling=1)
    solid, mask, camera = scene.solid_in_camera, scene.view.mask, scene.frame.camera
    vertices = np.array(scene.drawing.area.vertices_px)
    area = filled(vertices, camera)
    assert (vertices >= 0).all()
    assert (vertices <= [camera.width - 1, camera.height - 1]).all()
    assert (area & mask).sum() > 0.4 * area.sum()
    rows, columns = np.nonzero(area & mask)
    if isinstance(solid, Frustum):
        points = camera.unproject(np.stack([columns, rows], axis=-1), scene.view.depth_m[rows, columns])
        along = (points - solid.center_m) @ solid.direction
        assert np.abs(along).max() < solid.length_m / 2 - 1e-6, "no pixel of an end"
        assert np.ptp(along) > 0.7 * solid.length_m
    else:
        assert len(rows) == mask.sum(), "all of the ball"
    for u, v in (scene.drawing.axis.start_px, scene.drawing.axis.end_px):
        assert area[round(v), round(u)]


def test_the_stroke_runs_along_the_direction_of_the_solid() -> None:
    scene = simulate("pipe", 7, noise=None, supersampling=1)
    stroke = np.subtract(scene.drawing.axis.end_px, scene.drawing.axis.start_px)
    ends = scene.solid_in_camera.center_m + np.outer([-0.1, 0.1], scene.solid_in_camera.direction)
    projected = np.diff(DEFAULT_CAMERA.project(ends), axis=0)[0]
    cosine = stroke @ projected / np.linalg.norm(stroke) / np.linalg.norm(projected)
    assert cosine == pytest.approx(1, abs=1e-5)


def test_an_unsteady_hand_moves_every_point_a_little() -> None:
    drawing = simulate("leg", 0, camera=SMALL, noise=None, supersampling=1).drawing
    moved = perturb(drawing, np.random.default_rng(0), sigma_px=2.0)
    shift = np.subtract(moved.area.vertices_px, drawing.area.vertices_px)
    assert 0 < np.abs(shift).max() < 10
    assert perturb(drawing, np.random.default_rng(0), sigma_px=0.0) == drawing


def test_a_solid_behind_the_camera_has_no_outline() -> None:
    behind: Primitive = Frustum("cylinder", np.array([0, 0, -1.0]), np.array([1.0, 0, 0]), 0.4, 0.02)
    assert np.isnan(outline_px(behind, SMALL)).all()


def test_other_cameras_and_other_errors() -> None:
    scene = simulate(
        "wire", 0, camera=WIDE, noise=StereoErrors(baseline_m=0.2, disparity_sigma_px=0.3), supersampling=1
    )
    assert scene.frame.image.shape == (720, 1280, 3)
    assert scene.frame.noise == StereoNoise(0.2, 0.3)
    assert scene.drawing == ideal_drawing(scene.solid_in_camera, WIDE)


def test_unknown_objects_and_cameras_that_cannot_see_one_are_refused() -> None:
    with pytest.raises(ValueError, match="leg, ball, wire, pipe, cone"):
        simulate("cube", 0)
    keyhole = PinholeCamera(40, 40, np.array([[900.0, 0, 19.5], [0, 900.0, 19.5], [0, 0, 1]]))
    with pytest.raises(ValueError, match="does not fit a picture of 40 x 40 px"):
        simulate("pipe", 0, camera=keyhole)


@pytest.mark.parametrize("name", ["leg", "ball"])
def test_a_scene_written_and_read_again_is_the_same(name: str, tmp_path: Path) -> None:
    scene = simulate(name, 0, camera=SMALL, supersampling=1)
    folder = tmp_path / "scene"
    write_simulated(folder, scene)
    frame = read_scene(folder).frame()
    for field in ("image", "points_m", "T_base_camera"):
        np.testing.assert_array_equal(getattr(frame, field), getattr(scene.frame, field))
    np.testing.assert_array_equal(frame.camera.K, SMALL.K)
    assert frame.noise == scene.frame.noise
    truth = json.loads((folder / "truth.json").read_text())
    assert truth["kind"] == scene.solid.kind
    assert truth["diameter_mm"] == pytest.approx(scene.diameter_mm)
    assert truth["center_m"] == scene.solid.center_m.tolist()
    assert (truth["area"], truth["axis"]) == as_arguments(scene.drawing)

"""Simulated views show one world, a pixel is the mean over its footprint, and flaws do what they say."""

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from rotrecon.camera import PinholeCamera, inverse, transform
from rotrecon.scene.lens import Lens, pinhole
from rotrecon.scene.reading import read_scene
from rotrecon.simulation.flaws import Flaws
from rotrecon.simulation.ideal_drawing import as_arguments
from rotrecon.simulation.pictures import picture
from rotrecon.simulation.simulate import OBJECTS
from rotrecon.simulation.stereo import NO_FLAWS, Place, SimulatedViews, simulate_views
from rotrecon.simulation.surfaces import GRAIN_M, PERIOD_M, TEXTURES, Texture, textured
from rotrecon.simulation.truth import write_simulated

CAMERA = PinholeCamera(640, 360, np.array([[450.0, 0, 319.5], [0, 450.0, 179.5], [0, 0, 1]]))
SMALL = PinholeCamera(320, 180, np.array([[225.0, 0, 159.5], [0, 225.0, 89.5], [0, 0, 1]]))


def views(flaws: Flaws = NO_FLAWS, name: str = "pipe", texture: Texture = "coarse", **more: object) -> SimulatedViews:
    return simulate_views(name, 3, **{"camera": SMALL, "texture": texture, "flaws": flaws} | more)


def light(image: np.ndarray) -> np.ndarray:
    return (image / 255.0) ** 2.2


def seen_again(scene: SimulatedViews, number: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Inner pixels of the object in the reference, and the second picture and its slope along u where they are."""
    inner = cv2.erode(scene.view.mask.astype(np.uint8), np.ones((9, 9))).astype(bool)
    rows, columns = np.nonzero(inner)
    points = scene.view.camera.unproject(np.stack([columns, rows], axis=-1), scene.view.depth_m[inner])
    T_view_reference = inverse(scene.true_poses[number]) @ scene.true_poses[0]
    place = scene.true_lenses[number].camera.project(transform(T_view_reference, points)).astype(np.float32)
    other = scene.views[number].image.mean(axis=-1).astype(np.float32)

    def at(offset: float) -> np.ndarray:
        return cv2.remap(other, place[None] + np.float32([offset, 0]), None, cv2.INTER_CUBIC)[0].astype(float)

    return scene.views[0].image.mean(axis=-1)[inner], at(0.0), at(0.5) - at(-0.5)


@pytest.mark.parametrize("name", OBJECTS)
def test_every_view_shows_a_point_of_the_object_in_the_same_colour_where_its_depth_puts_it(name: str) -> None:
    across = np.eye(4)
    across[:3, 3] = [0.02, 0.08, 0.01]
    across[:3, :3] = cv2.Rodrigues(np.array([0.05, 0.02, 0.03]))[0]
    rig = [Place(pose, pinhole(CAMERA)) for pose in (np.eye(4), across)]
    scene = views(name=name, rig=rig, around_px=4.0)
    here, there, slope = seen_again(scene, 1)
    assert len(here) > 300
    assert np.median(np.abs(here - there)) < 1.0
    shift = (slope * (here - there)).sum() / (slope**2).sum()
    assert abs(shift) < 0.02, "px"


def test_a_pixel_is_the_mean_of_rays_over_its_footprint() -> None:
    scene = views(Flaws(noise_levels=0, glare=0.5, neighbour=True), name="leg")
    K = scene.view.camera.K * [[4], [4], [1]] + np.array([[0, 0, 1.5], [0, 0, 1.5], [0, 0, 0]])
    finer = PinholeCamera(4 * SMALL.width, 4 * SMALL.height, K)
    pose = scene.view.T_base_camera
    coarse = picture(scene.world, pinhole(SMALL), pose)
    fine = picture(scene.world, pinhole(finer), pose, supersampling=1)
    mean = fine.reshape(SMALL.height, 4, SMALL.width, 4, 3).mean(axis=(1, 3))
    near = cv2.dilate(np.isin(scene.view.body, [0, 3]).astype(np.uint8), np.ones((5, 5))) > 0
    np.testing.assert_allclose(coarse[near], mean[near], atol=1e-5)
    assert np.abs(coarse - mean).mean() < 0.01, "walls have fewer rays"
    assert np.percentile(np.abs(coarse - mean), 99.9) < 0.08


def test_the_same_seed_is_the_same_scene_whatever_is_wrong_with_it() -> None:
    plain = views()
    everything = Flaws(3.0, 1.0, 1.2, 0.5, 0.001, 0.1, 0.01, 1.0, True, True)
    other = views(everything, texture="weak", baselines_m=(0.0, 0.1, 0.2))
    assert plain.drawing == other.drawing
    np.testing.assert_array_equal(plain.solid.center_m, other.solid.center_m)
    np.testing.assert_array_equal(plain.true_poses, other.true_poses[:2])
    for wall in (1, 2):
        np.testing.assert_array_equal(plain.world.bodies[wall].T_base_body, other.world.bodies[wall].T_base_body)
    again = views(everything, texture="weak", baselines_m=(0.0, 0.1, 0.2))
    for first, second in zip(other.views, again.views, strict=True):
        np.testing.assert_array_equal(first.image, second.image)
    np.testing.assert_array_equal(views().views[1].image, plain.views[1].image)


def test_a_window_about_the_object_is_part_of_the_whole_picture() -> None:
    whole, part = views(), views(around_px=12.0)
    for all_of_it, some, shot in zip(whole.views, part.views, whole.recorded, strict=True):
        kept = some.image.any(axis=-1)
        assert 0.01 < kept.mean() < 0.6
        np.testing.assert_array_equal(some.image[kept], all_of_it.image[kept])
        rows, columns = np.nonzero(kept)
        assert kept[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1].all()
        middle = transform(inverse(shot.T_base_camera), whole.solid.center_m)
        u, v = np.rint(SMALL.project(middle)).astype(int)
        assert kept[v, u]
    assert part.views[0].image[part.view.mask].any(axis=-1).all()


def test_noise_is_as_strong_as_stated_and_differs_from_view_to_view() -> None:
    clean, noisy = views(), views(Flaws(noise_levels=4.0))
    off = [a.image.astype(float) - b.image for a, b in zip(noisy.views, clean.views, strict=True)]
    assert [error.std() for error in off] == pytest.approx([4.0, 4.0], rel=0.03)
    assert abs(np.corrcoef(off[0].ravel(), off[1].ravel())[0, 1]) < 0.02


def test_gain_multiplies_light_from_view_to_view() -> None:
    even, uneven = (views(Flaws(noise_levels=0, gain=gain), baselines_m=(0, 0.1, 0.2)) for gain in (1.0, 0.8))
    for number in range(3):
        share = light(uneven.views[number].image).mean() / light(even.views[number].image).mean()
        assert share == pytest.approx(0.8**number, rel=0.01)


def test_blur_spreads_light_and_keeps_it() -> None:
    sharp, soft = views(texture="fine"), views(Flaws(noise_levels=0, blur_px=1.5), texture="fine")
    light_of = [light(scene.views[0].image) for scene in (sharp, soft)]
    assert light_of[0].mean() == pytest.approx(light_of[1].mean(), rel=0.01)
    inner = sharp.view.mask
    assert light_of[1][inner].std() < 0.6 * light_of[0][inner].std()


def test_glare_only_adds_light_and_moves_with_the_camera() -> None:
    dull, glossy = views(name="ball"), views(Flaws(noise_levels=0, glare=0.8), name="ball")
    added = [light(b.image) - light(a.image) for a, b in zip(dull.views, glossy.views, strict=True)]
    assert min(more.min() for more in added) >= 0
    assert not added[0][~cv2.dilate(dull.view.mask.astype(np.uint8), np.ones((3, 3))).astype(bool)].any()
    # the highlight is where the normal is halfway to the lamp: another point of the ball for each camera
    toward = glossy.world.toward_light
    spots = []
    for pose, more in zip(glossy.true_poses, added, strict=True):
        v, u = np.unravel_index(cv2.GaussianBlur(more.mean(axis=-1), (0, 0), 2).argmax(), more.shape[:2])
        ray = pose[:3, :3] @ SMALL.unproject(np.array([u, v]), np.array(1.0))
        offset = pose[:3, 3] - glossy.solid.center_m
        half = (ray @ offset) / (ray @ ray)
        along = -half - np.sqrt(half**2 - (offset @ offset - glossy.solid.radius_m**2) / (ray @ ray))
        normal = (offset + along * ray) / glossy.solid.radius_m
        halfway = toward - ray / np.linalg.norm(ray)
        assert normal @ halfway / np.linalg.norm(halfway) > np.cos(np.deg2rad(4))
        spots.append(normal)
    assert np.rad2deg(np.arccos(spots[0] @ spots[1])) > 1.0


def test_stated_poses_and_cameras_are_off_by_the_stated_amounts() -> None:
    flaws = Flaws(pose_error_m=0.003, pose_error_deg=0.2, focal_error=-0.02, principal_error_px=1.5)
    scene = views(flaws)
    np.testing.assert_array_equal(scene.views[0].T_base_camera, scene.true_poses[0])
    error = inverse(scene.true_poses[1]) @ scene.views[1].T_base_camera
    assert np.linalg.norm(error[:3, 3]) == pytest.approx(0.003)
    assert np.linalg.norm(cv2.Rodrigues(error[:3, :3])[0]) == pytest.approx(np.deg2rad(0.2))
    for view in scene.views:
        assert view.camera.focal_px == pytest.approx(0.98 * 225)
        assert np.linalg.norm((view.camera.K - SMALL.K)[:2, 2]) == pytest.approx(1.5)
    np.testing.assert_array_equal(scene.view.camera.K, SMALL.K)
    np.testing.assert_array_equal(scene.views[1].image, views(replace(flaws, noise_levels=2.0)).views[1].image)


@pytest.mark.parametrize("name", OBJECTS)
def test_an_occluder_hides_part_of_the_object_and_a_neighbour_is_seen_beside_it(name: str) -> None:
    alone, beset = views(name=name), views(Flaws(occluder=True, neighbour=True), name=name)
    hidden = alone.view.mask & (beset.view.body == 3)
    assert 0.03 < hidden.sum() / alone.view.mask.sum() < 0.4
    assert (beset.view.depth_m[hidden] < alone.view.depth_m[hidden]).all()
    beside = beset.view.body == 4
    assert beside.sum() > 30
    assert beset.view.depth_m[beside].min() > alone.view.depth_m[alone.view.mask].max()
    assert (beset.view.depth_m[beside] < alone.view.depth_m[beside]).all()
    assert (cv2.dilate(beset.view.mask.astype(np.uint8), np.ones((7, 7))).astype(bool) & beside).any()


def test_textures_differ_in_what_they_give_a_matcher() -> None:
    scenes = {texture: views(texture=texture, camera=CAMERA, baselines_m=(0.0,), around_px=4.0) for texture in TEXTURES}
    detail = {}
    for texture, scene in scenes.items():
        image = scene.views[0].image.mean(axis=-1)
        inner = cv2.erode(scene.view.mask.astype(np.uint8), np.ones((5, 5))).astype(bool)
        detail[texture] = np.abs(cv2.Laplacian(image, cv2.CV_64F))[inner].mean()
    assert detail["plain"] < detail["weak"] < 0.3 * detail["fine"]
    assert detail["coarse"] < 0.3 * detail["fine"]
    assert GRAIN_M * 900 / 0.9 >= 2.5
    weave = textured("repetitive", OBJECTS["pipe"].shape)(np.random.default_rng(0))
    points = np.random.default_rng(1).normal(size=(50, 3))
    np.testing.assert_allclose(weave.albedo(points), weave.albedo(points + PERIOD_M * np.eye(3)[2]), atol=1e-9)


def test_a_distorting_lens_undistorts_to_what_a_pinhole_sees() -> None:
    distortion = np.array([-0.25, 0.1, 0.002, -0.001, 0.0])
    narrow = PinholeCamera(300, 240, np.array([[320.0, 0, 148.0], [0, 318.0, 121.0], [0, 0, 1]]))
    aside = np.eye(4)
    aside[0, 3] = 0.05
    bent, straight = (
        views(rig=[Place(np.eye(4), lens(CAMERA)), Place(aside, lens(narrow))], name="ball")
        for lens in (lambda camera: Lens(camera, distortion), pinhole)
    )
    for shot, view, ideal in zip(bent.recorded, bent.views, straight.views, strict=True):
        off = np.abs(view.image.astype(float) - ideal.image)
        recorded = view.image.any(axis=-1)
        assert np.median(off[recorded]) < 3
        assert np.mean(off[recorded]) < 0.4 * np.abs(shot.image.astype(float) - ideal.image)[recorded].mean()


def test_views_written_and_read_again_are_the_same(tmp_path: Path) -> None:
    aside = np.eye(4)
    aside[:3, 3] = [0.02, 0.1, 0.0]
    rig = [Place(np.eye(4), Lens(SMALL, np.array([-0.1, 0.02, 0.0, 0.0]))), Place(aside, pinhole(CAMERA))]
    scene = views(Flaws(pose_error_m=0.002, focal_error=0.01), rig=rig)
    write_simulated(tmp_path / "scene", scene)
    capture = read_scene(tmp_path / "scene")
    assert capture.recorded is None
    for read, view in zip(capture.views, scene.views, strict=True):
        for field in ("image", "T_base_camera"):
            np.testing.assert_array_equal(getattr(read, field), getattr(view, field))
        np.testing.assert_array_equal(read.camera.K, view.camera.K)
    truth = json.loads((tmp_path / "scene" / "truth.json").read_text())
    assert truth["texture"] == "coarse"
    assert truth["flaws"]["pose_error_m"] == 0.002
    assert (truth["area"], truth["axis"]) == as_arguments(scene.drawing)
    assert truth["diameter_mm"] == pytest.approx(100)
    for number, true in enumerate(truth["views"]):
        np.testing.assert_array_equal(true["T_base_camera"], scene.true_poses[number])
        np.testing.assert_array_equal(true["K"], rig[number].lens.camera.K)
        np.testing.assert_array_equal(true["distortion"], rig[number].lens.distortion)


def test_what_cannot_be_simulated_is_refused() -> None:
    with pytest.raises(ValueError, match="leg, ball, wire, pipe, cone"):
        simulate_views("cube", 0)
    with pytest.raises(ValueError, match="fine, coarse, weak, repetitive, plain"):
        views(texture="furry")  # type: ignore[arg-type]
    moved = np.eye(4)
    moved[0, 3] = 0.1
    for rig in ([], [Place(moved, pinhole(SMALL))]):
        with pytest.raises(ValueError, match="the first place is the reference"):
            views(rig=rig)
    with pytest.raises(ValueError, match="the first place is the reference"):
        views(baselines_m=(0.1, 0.2))
    for wrong in ({"noise_levels": -1.0}, {"gain": 0.0}, {"blur_px": np.inf}, {"focal_error": -1.0}):
        with pytest.raises(ValueError, match=r"no flaw is|a focal length"):
            Flaws(**wrong)

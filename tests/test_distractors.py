"""Simulated scenes without a body of revolution are what their names say, and can be drawn in."""

import numpy as np
import pytest

from rotrecon.drawing import cut_sections
from rotrecon.frame import StereoNoise
from rotrecon.primitives import Frustum, Sphere
from rotrecon.simulation.arrangements.cluttered import heap
from rotrecon.simulation.distractors import MAKERS, SMALL_CAMERA, WHITE, distractor
from rotrecon.simulation.simulate import DEFAULT_CAMERA
from rotrecon.simulation.stereo_noise import StereoErrors

SIZE = (SMALL_CAMERA.width, SMALL_CAMERA.height)


@pytest.mark.parametrize("kind", MAKERS)
def test_a_seed_says_all(kind: str) -> None:
    first, again, other = distractor(kind, 3), distractor(kind, 3), distractor(kind, 4)
    assert first.drawing == again.drawing
    np.testing.assert_array_equal(first.frame.points_m, again.frame.points_m)
    assert first.drawing != other.drawing


@pytest.mark.parametrize("kind", MAKERS)
def test_errors_and_picture_leave_the_scene_and_its_drawing_alone(kind: str) -> None:
    exact, noisy = distractor(kind, 1), distractor(kind, 1, StereoErrors(), picture=True)
    assert exact.drawing == noisy.drawing
    np.testing.assert_array_equal(exact.view.body, noisy.view.body)
    assert not exact.frame.image.any()
    assert noisy.frame.image.std() > 1


@pytest.mark.parametrize("kind", MAKERS)
def test_drawings_can_be_cut_into_sections(kind: str) -> None:
    for seed, camera in enumerate([SMALL_CAMERA, SMALL_CAMERA, DEFAULT_CAMERA]):
        drawing = distractor(kind, seed, camera=camera).drawing
        assert cut_sections(drawing.area, drawing.axis, (camera.width, camera.height)).inside.sum() > 20


@pytest.mark.parametrize("kind", ["wall", "table", "plank"])
def test_what_is_flat_is_a_plane(kind: str) -> None:
    for seed in range(5):
        scene = distractor(kind, seed)
        points = scene.frame.points_m[scene.view.mask].astype(float)
        middle = points - points.mean(axis=0)
        spread = np.linalg.svd(middle, compute_uv=False, full_matrices=False) / np.sqrt(len(points))
        assert spread[2] < (1e-6 if kind != "plank" else 0.2) * spread[1] + 1e-6


@pytest.mark.parametrize("seed", range(12))
def test_what_is_round_is_a_small_part_of_a_heap(seed: int) -> None:
    scene = distractor("heap", seed)
    placed = heap(np.random.default_rng([seed, *b"heap"]).spawn(4)[0]).placed
    drawn = cut_sections(scene.drawing.area, scene.drawing.axis, SIZE)
    seen = scene.view.body.ravel()[drawn.pixel[drawn.inside]]
    share = np.bincount(seen, minlength=len(placed)) / (seen < len(placed) - 1).sum()
    assert all(share[number] < 0.2 for number, (shape, _) in enumerate(placed) if isinstance(shape, Frustum | Sphere))


def test_even_seeds_state_their_noise() -> None:
    assert distractor("wall", 2, WHITE).frame.noise == StereoNoise(WHITE.baseline_m, WHITE.disparity_sigma_px)
    assert distractor("wall", 3, WHITE).frame.noise is None
    assert distractor("wall", 2).frame.noise is None


def test_depth_that_is_lost_is_lost() -> None:
    assert not np.isfinite(distractor("hole", 0).frame.depth_m).any()
    assert 0 < np.isfinite(distractor("few pixels", 0).frame.depth_m).mean() < 0.05


def test_unknown_kinds_are_refused() -> None:
    with pytest.raises(ValueError, match="no 'cat' to simulate"):
        distractor("cat", 0)

"""A stereo camera's errors have the size, the reach and the places that are stated."""

import numpy as np
import pytest

from rotrecon.camera import PinholeCamera
from rotrecon.simulation.rendering import RenderedView
from rotrecon.simulation.simulate import simulate
from rotrecon.simulation.stereo_noise import StereoErrors, correlated_noise, hidden_from_second, stereo_depth

CAMERA = PinholeCamera(640, 480, np.array([[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]]))
FOCAL_BASELINE = 60.0
PERFECT = StereoErrors(disparity_sigma_px=0, window_px=1, half_occlusion=False, hole_share=0)
BAR = slice(300, 340)


def view_of(depth_m: np.ndarray) -> RenderedView:
    nothing = np.zeros(depth_m.shape)
    return RenderedView(np.zeros((*depth_m.shape, 3), np.uint8), depth_m, nothing.astype(np.int8), CAMERA, np.eye(4))


def bar_before_a_wall() -> np.ndarray:
    """Disparity 75 px before 40 px."""
    depth = np.full((CAMERA.height, CAMERA.width), FOCAL_BASELINE / 40)
    depth[:, BAR] = FOCAL_BASELINE / 75
    return depth


def test_everything_can_be_switched_off() -> None:
    depth = bar_before_a_wall()
    np.testing.assert_allclose(stereo_depth(view_of(depth), PERFECT, np.random.default_rng(0)), depth, rtol=1e-12)


def test_disparity_noise_has_the_stated_size_and_correlation() -> None:
    errors = StereoErrors()
    depth = stereo_depth(view_of(np.ones((480, 640))), errors, np.random.default_rng(1))
    error = FOCAL_BASELINE / depth - FOCAL_BASELINE
    assert np.nanstd(error) == pytest.approx(errors.disparity_sigma_px, rel=0.05)
    assert abs(np.nanmean(error)) < 0.01

    def correlation(lag: int) -> float:
        return float(np.nanmean(error[:, :-lag] * error[:, lag:]) / np.nanvar(error))

    assert correlation(1) > 0.9
    assert correlation(4) == pytest.approx(np.exp(-1), abs=0.06)
    assert abs(correlation(15)) < 0.06


def test_noise_without_correlation_is_white() -> None:
    noise = correlated_noise((300, 300), 0.0, np.random.default_rng(0))
    assert np.std(noise) == pytest.approx(1, rel=0.02)
    assert abs((noise[:, 1:] * noise[:, :-1]).mean()) < 0.02


def test_the_shadow_is_as_wide_as_the_step_in_disparity_and_left_of_the_object() -> None:
    hidden = hidden_from_second(FOCAL_BASELINE / bar_before_a_wall())
    expected = np.zeros(hidden.shape, dtype=bool)
    expected[:, BAR.start - 35 : BAR.start] = True
    expected[:, :40] = True
    assert (hidden != expected).sum(axis=1).max() <= 2


def test_a_thin_bar_hides_only_its_own_width() -> None:
    disparity = np.full((2, 400), 40.0)
    disparity[:, 200:210] = 75
    hidden = np.flatnonzero(hidden_from_second(disparity)[0, 40:]) + 40
    assert 9 <= len(hidden) <= 12
    assert hidden.min() >= 200 - 36
    assert hidden.max() <= 210 - 34


def test_outlines_grow_and_nothing_flies_between_two_flat_surfaces() -> None:
    errors = StereoErrors(disparity_sigma_px=0, hole_share=0, half_occlusion=False)
    depth = stereo_depth(view_of(bar_before_a_wall()), errors, np.random.default_rng(0))
    disparity = FOCAL_BASELINE / depth[240]
    between = (disparity > 41) & (disparity < 74)
    assert between.sum() == 0
    assert (disparity > (40 + 75) / 2).sum() > BAR.stop - BAR.start
    far = np.ones(CAMERA.width, dtype=bool)
    far[BAR.start - errors.window_px : BAR.stop + errors.window_px] = False
    np.testing.assert_allclose(disparity[far], 40)


def test_holes_are_blobs_of_the_stated_share() -> None:
    errors = StereoErrors(hole_share=0.02)
    depth = stereo_depth(view_of(np.full((480, 640), 0.8)), errors, np.random.default_rng(2))
    seen = np.isnan(depth[:, 80:])
    assert seen.mean() == pytest.approx(0.02, abs=0.005)
    assert (seen[:, 1:] & seen[:, :-1]).sum() > 0.6 * seen.sum()


def test_what_is_not_there_has_no_depth() -> None:
    depth = np.ones((480, 640))
    depth[:100] = np.inf
    assert np.isnan(stereo_depth(view_of(depth), PERFECT, np.random.default_rng(0))[:100]).all()


def test_the_middle_of_a_ball_keeps_its_depth_and_its_limb_is_drawn_forward_by_the_window() -> None:
    errors = StereoErrors(hole_share=0)
    scene = simulate("ball", 0, noise=errors, supersampling=1)
    error = FOCAL_BASELINE / scene.frame.depth_m - FOCAL_BASELINE / scene.view.depth_m
    rows, columns = np.nonzero(scene.view.mask)
    centre = scene.frame.camera.project(scene.solid_in_camera.center_m)
    radius = np.hypot(columns - centre[0], rows - centre[1])
    error = error[rows, columns]
    middle, limb = radius < 0.5 * radius.max(), radius > radius.max() - 2
    assert np.nanstd(error[middle]) == pytest.approx(errors.disparity_sigma_px, rel=0.25)
    assert np.nanmean(error[limb]) > 5 * errors.disparity_sigma_px

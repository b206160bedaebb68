"""Laws of rectification, and of the way back into the reference's pixels."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.camera import PinholeCamera, inverse, transform
from rotrecon.frame import View
from rotrecon.stereo.canvas import beyond, canvas_over, through, whole
from rotrecon.stereo.carrying import inverse_depths
from rotrecon.stereo.features import in_common_planes
from rotrecon.stereo.fusion import fuse, fused_sigma
from rotrecon.stereo.limits import Limits, depth_limits
from rotrecon.stereo.rectification import rectify
from rotrecon.workspace import Workspace
from tests.views import at

CAMERA = PinholeCamera(64, 48, np.array([[60.0, 0, 30.5], [0, 62.0, 24.5], [0, 0, 1]]))
OTHER = PinholeCamera(80, 50, np.array([[75.0, 0, 41.0], [0, 75.0, 23.0], [0, 0, 1]]))

small = st.floats(-0.2, 0.2)
turns = st.tuples(st.floats(-12, 12), st.floats(-12, 12), st.floats(-180, 180))


def view(camera: PinholeCamera, pose: np.ndarray) -> View:
    return View(np.zeros((camera.height, camera.width, 3), np.uint8), camera, pose)


def pair(pose: np.ndarray):
    base = at(0.3, -0.2, 0.5, (20, -40, 70))
    return rectify(view(CAMERA, base), view(OTHER, base @ pose))


@settings(max_examples=60, deadline=None)
@given(small, small, st.floats(-0.05, 0.05), turns, st.integers(0, 1000))
def test_rays_of_a_point_meet_in_one_row_at_its_disparity(x, y, z, turned, seed):
    if np.hypot(x, y) < 0.02:
        x += 0.05
    rectification = pair(at(x, y, z, turned))
    rng = np.random.default_rng(seed)
    points = CAMERA.unproject(rng.uniform([0, 0], [63, 47], (20, 2)), rng.uniform(0.5, 3.0, 20))
    seen = OTHER.project(transform(inverse(at(x, y, z, turned)), points))
    in_front = np.isfinite(seen).all(axis=1)
    points, seen = points[in_front], seen[in_front]
    matches = in_common_planes(rectification, CAMERA.project(points), seen)
    np.testing.assert_allclose(matches.row_error_px, 0, atol=1e-3)
    np.testing.assert_allclose(matches.inverse_depths(rectification), 1 / points[:, 2], rtol=1e-3)
    assert rectification.baseline_m == pytest.approx(np.sqrt(x * x + y * y + z * z))


@pytest.mark.parametrize("pose", [at(0.1), at(-0.1), at(0, 0.1), at(0, -0.1), at(0.07, 0.05, 0.02, (3, -4, 30))])
@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_exact_disparity_comes_back_as_the_depth_it_was_made_of(pose, scale):
    """A slanted plane 1 / z = a + b u + c v, put on the canvas and carried back."""
    rectification = pair(pose)
    box = (5, 4, 60, 40)
    canvas = canvas_over(rectification, box, scale, (0.5, 1.5))
    v, u = np.indices((canvas.size_px[1], canvas.size_px[0])).reshape(2, -1).astype(np.float64)
    pixels = through(np.linalg.inv(canvas.homography()), np.stack([u, v], axis=-1))
    exact = 0.8 + 0.004 * pixels[:, 0] - 0.003 * pixels[:, 1]
    disparity = exact / rectification.depth_ratios(pixels) * canvas.disparity_of_inverse_depth
    disparity = (disparity - canvas.first_disparity).reshape(canvas.size_px[::-1]).astype(np.float32)
    found = inverse_depths(canvas, disparity, box)
    rows, columns = np.indices(found.shape)
    expected = 0.8 + 0.004 * (columns + 5) - 0.003 * (rows + 4)
    seen = np.isfinite(found)
    assert seen.mean() > 0.5, "what the other picture cannot show is not matched"
    off = np.abs(found[seen] / expected[seen] - 1)
    assert np.mean(off < 1e-3) > 0.95
    assert off.max() < 0.02, "at the border the nearest one is taken"


def test_no_depth_arises_between_two_surfaces():
    rectification = pair(at(0.1, 0.01, 0, (1, 2, 8)))
    canvas = canvas_over(rectification, whole(CAMERA), 1.0, (0.2, 4.0))
    disparity = np.full(canvas.size_px[::-1], 4.0, np.float32)
    disparity[:, (canvas.disparities + canvas.size_px[0]) // 2 :] = 14.0
    disparity[::7, ::5] = -1.0
    found = inverse_depths(canvas, disparity, whole(CAMERA))
    pixels = np.stack(np.indices(found.shape)[::-1], axis=-1).reshape(-1, 2).astype(np.float64)
    back = found.ravel() / rectification.depth_ratios(pixels) * canvas.disparity_of_inverse_depth
    back = back[np.isfinite(back)] - canvas.first_disparity
    assert np.minimum(np.abs(back - 4), np.abs(back - 14)).max() < 0.02
    assert (np.abs(back - 4) < 1).sum() > 100 < (np.abs(back - 14) < 1).sum()


def test_a_rectified_pair_is_not_interpolated():
    image = np.random.default_rng(0).integers(1, 255, (48, 64), dtype=np.uint8)
    colours = np.repeat(image[..., None], 3, axis=2)
    rectification = rectify(View(colours, CAMERA_SQUARE, np.eye(4)), View(colours, CAMERA_SQUARE, at(0.1)))
    canvas = canvas_over(rectification, whole(CAMERA_SQUARE), 1.0, (0.0, 1.0))
    left, top = (round(float(edge)) for edge in canvas.principal_px - CAMERA_SQUARE.K[:2, 2])
    assert np.array_equal(canvas.reference_picture()[top : top + 48, left : left + 64], image)
    assert not beyond(canvas.reference_picture())[top : top + 48, left : left + 64].any()
    assert beyond(canvas.reference_picture())[top : top + 48, : left - 1].all()


CAMERA_SQUARE = PinholeCamera(64, 48, np.array([[60.0, 0, 30.5], [0, 60.0, 24.5], [0, 0, 1]]))


def test_cameras_in_one_place_are_a_mistake_of_the_caller():
    with pytest.raises(ValueError, match="one place"):
        pair(at(0, 0, 0, (0, 5, 0)))


def test_limits_of_the_arm_limit_depth():
    camera = at(0, 0, 2.0, (180, 0, 0))  # looks down from 2 m above the base
    assert depth_limits(Workspace(), camera) == Limits(None, None)
    assert depth_limits(Workspace(depth_m=(0.3, 1.5)), camera) == Limits(0.3, 1.5)
    box = depth_limits(Workspace(box_m=np.array([[-1, -1, 0], [1, 1, 0.8]])), camera)
    assert box.nearest_m == pytest.approx(1.2)
    assert box.farthest_m == pytest.approx(2.0)
    reach = depth_limits(Workspace(reach_m=(0.1, 1.5)), camera)
    assert reach.nearest_m == pytest.approx(0.5)
    assert reach.farthest_m == pytest.approx(3.5)
    assert depth_limits(Workspace(reach_m=(0.1, 1.5), depth_m=(0.2, 3.0)), camera).nearest_m == pytest.approx(0.5)


def test_fusing_averages_what_agrees_and_drops_what_does_not():
    first = np.array([[1.0, 1.0, 1.0, np.nan, np.nan]], np.float32)
    second = np.array([[1.02, 2.0, 2.0, 1.5, np.nan]], np.float32)
    third = np.array([[1.02, 2.02, 3.0, np.nan, np.nan]], np.float32)
    fused = fuse([first, second, third], [0.01, 0.02, 0.02])
    assert fused[0, 0] == pytest.approx((1.0 * 4 + 1.02 + 1.02) / 6)
    assert fused[0, 1] == pytest.approx(2.01)
    assert np.isnan(fused[0, 2]), "no two agree"
    assert fused[0, 3] == pytest.approx(1.5), "one pair alone sees it"
    assert np.isnan(fused[0, 4])


def test_one_pair_is_fused_to_itself_and_order_does_not_matter():
    rng = np.random.default_rng(3)
    maps = [np.where(rng.random((20, 30)) < 0.2, np.nan, 1 + 0.02 * rng.random((20, 30))) for _ in range(3)]
    maps = [one.astype(np.float32) for one in maps]
    assert fuse(maps[:1], [0.1]) is maps[0]
    forth, back = fuse(maps, [0.03, 0.02, 0.01]), fuse(maps[::-1], [0.01, 0.02, 0.03])
    np.testing.assert_allclose(forth, back, rtol=1e-6)


def test_noise_shrinks_with_more_views_and_no_further_than_the_shared_picture_lets_it():
    one = np.array([1.0, 0, 0])
    assert fused_sigma([0.2], [one]) == pytest.approx(0.2)
    alike = fused_sigma([0.2, 0.2], [one, one])
    assert 0.2 / np.sqrt(2) < alike < 0.2
    assert alike == pytest.approx(0.2 * np.sqrt(0.75))
    assert fused_sigma([0.2, 0.2], [one, np.array([0, 1.0, 0])]) == pytest.approx(0.2 / np.sqrt(2))
    assert fused_sigma([0.2, 0.2], [one, -one]) < fused_sigma([0.2, 0.2], [one, one])
    rng = np.random.default_rng(0)
    shared, own = rng.standard_normal(200_000), rng.standard_normal((2, 200_000))
    errors = 0.2 * (shared + own) / np.sqrt(2)
    assert errors.mean(axis=0).std() == pytest.approx(alike, rel=0.01)


@pytest.mark.parametrize("box", [whole(CAMERA), (10, 5, 40, 30)])
def test_pictures_of_a_pair_that_is_rectified_already_are_cut_as_they_would_be_warped(monkeypatch, box):
    rng = np.random.default_rng(5)
    views = [
        View(rng.integers(0, 255, (CAMERA.height, CAMERA.width, 3), np.uint8), CAMERA, at(x, 0.0, 0.0))
        for x in (0.0, 0.1)
    ]
    canvas = canvas_over(rectify(*views), box, 1.0, (0.2, 4.0))
    cut = canvas.reference_picture(), canvas.other_picture()
    monkeypatch.setattr("rotrecon.stereo.canvas.shift_of", lambda H: None)
    warped = canvas.reference_picture(), canvas.other_picture()
    assert cut[0].any()
    for one, other in zip(cut, warped, strict=True):
        np.testing.assert_array_equal(one, other)


def test_disparity_of_a_pair_that_is_rectified_already_is_carried_back_as_if_it_were_interpolated(monkeypatch):
    rng = np.random.default_rng(6)
    picture = np.zeros((48, 64, 3), np.uint8)
    canvas = canvas_over(
        rectify(View(picture, CAMERA_SQUARE, np.eye(4)), View(picture, CAMERA_SQUARE, at(0.1))),
        whole(CAMERA_SQUARE),
        1.0,
        (0.2, 4.0),
    )
    disparity = rng.choice([-1.0, 4.0, 4.5, 14.0], canvas.size_px[::-1]).astype(np.float32)
    box = (-3, -2, 70, 47)
    cut = inverse_depths(canvas, disparity, box)
    monkeypatch.setattr("rotrecon.stereo.carrying.shift_of", lambda H: None)
    assert np.isfinite(cut).mean() > 0.3
    np.testing.assert_array_equal(cut, inverse_depths(canvas, disparity, box))

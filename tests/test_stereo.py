"""Depth of rendered views is right to its stated noise, from whichever side the second camera looks."""

from dataclasses import replace

import numpy as np
import pytest

from rotrecon.camera import PinholeCamera
from rotrecon.capture import Capture
from rotrecon.drawing import AreaOfInterest, DrawingError
from rotrecon.frame import Frame
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from rotrecon.workspace import Workspace
from tests.exact import CAMERA as EXACT_CAMERA
from tests.views import CAMERA, Rig, area_frame_of, at, disparity_errors, frame_of, inner, simulated

OTHER_CAMERA = PinholeCamera(600, 400, np.array([[400.0, 0, 310.0], [0, 405.0, 195.0], [0, 0, 1]]))


@pytest.mark.parametrize("place", ["SIDEWAYS", "LEFT", "VERTICAL", "CONVERGING", "ROLLED"])
def test_depth_of_a_ball_is_right_to_its_stated_noise(place):
    scene = simulated(getattr(Rig, place))
    frame = area_frame_of(scene)
    errors = disparity_errors(frame, scene, inner(scene))
    assert len(errors) > 0.98 * inner(scene).sum()
    assert abs(np.median(errors)) < 0.05
    assert np.mean(np.abs(errors) > 1) < 0.01
    assert 0.6 < frame.noise.disparity_sigma_px / errors[np.abs(errors) < 1].std() < 1.7
    assert frame.noise.baseline_m == pytest.approx(0.1)
    assert frame.stereo.epipolar_error_px < 0.1
    assert frame.stereo.valid_share > 0.9


def test_unequal_cameras_make_a_pair():
    scene = simulated(Rig.CONVERGING, camera=OTHER_CAMERA)
    errors = disparity_errors(area_frame_of(scene), scene, inner(scene))
    assert abs(np.median(errors)) < 0.05
    assert np.mean(np.abs(errors) > 1) < 0.01


def test_the_whole_frame_is_matched_coarsely_and_an_area_again_finely():
    scene = simulated(Rig.SIDEWAYS)
    capture = Capture("views", views=scene.views)
    coarse, fine = capture.frame(), capture.frame(scene.drawing.area)
    assert isinstance(coarse, Frame)
    assert isinstance(fine, Frame)
    assert (coarse.stereo.scale, fine.stereo.scale) == (0.5, 1.0)
    assert np.isfinite(coarse.depth_m).mean() > 0.85
    assert np.isfinite(fine.depth_m).mean() < np.isfinite(coarse.depth_m).mean(), "beyond the area nothing is matched"
    object_alone = inner(scene)
    spreads = [disparity_errors(frame, scene, object_alone).std() for frame in (fine, coarse)]
    assert spreads[0] < 0.8 * spreads[1]
    for frame in (coarse, fine):
        assert frame.image is scene.views[0].image
        assert frame.camera is scene.views[0].camera
        assert frame.views == scene.views
        assert frame.points_m.dtype == np.float32
        assert np.isnan(frame.points_m[np.isnan(frame.depth_m)]).all()


def test_background_does_not_smear_into_the_object():
    """Depths between the ball and the wall behind it are of neither."""
    scene = simulated(Rig.SIDEWAYS)
    frame = area_frame_of(scene)
    truth = scene.view.depth_m
    near, far = truth[scene.view.mask].max(), truth[~scene.view.mask].min()
    between = (frame.depth_m > near + 0.25 * (far - near)) & (frame.depth_m < near + 0.75 * (far - near))
    assert far - near > 0.2
    assert between.sum() < 0.01 * scene.view.mask.sum()


def test_more_views_are_better_and_their_order_does_not_matter():
    scene = simulated(Rig.SIDEWAYS, at(0.2), at(0.3))
    two, four = (Capture("v", views=scene.views[:n]).frame(scene.drawing.area) for n in (2, 4))
    other_order = Capture("v", views=(scene.views[0], *scene.views[:0:-1])).frame(scene.drawing.area)
    assert isinstance(two, Frame)
    assert isinstance(four, Frame)
    assert isinstance(other_order, Frame)
    assert four.stereo.pairs == (3, 2, 1)
    object_alone = inner(scene)
    middle_m = [np.nanmedian(np.abs(frame.depth_m - scene.view.depth_m)[object_alone]) for frame in (two, four)]
    assert middle_m[1] < 0.6 * middle_m[0]
    errors = disparity_errors(four, scene, object_alone)
    assert 0.5 < four.noise.disparity_sigma_px / errors[np.abs(errors) < 1].std() < 1.7
    np.testing.assert_allclose(other_order.depth_m, four.depth_m, rtol=1e-5)


def test_a_view_that_cannot_be_matched_is_left_out_with_its_reason():
    scene = simulated(Rig.SIDEWAYS)
    dark = replace(scene.views[1], image=np.zeros_like(scene.views[1].image))
    frame = frame_of((scene.views[0], dark, scene.views[1]))
    assert frame.stereo.pairs == (2,)
    assert len(frame.stereo.left_out) == 1
    assert "view 2" in frame.stereo.left_out[0]
    assert "too dark" in frame.stereo.left_out[0]


def test_limits_of_the_arm_say_where_to_look():
    scene = simulated(Rig.SIDEWAYS)
    whole = frame_of(scene.views)
    inverse = np.eye(4)
    limited = Capture(
        "v",
        views=tuple(replace(one, T_base_camera=inverse if i == 0 else at(0.1)) for i, one in enumerate(scene.views)),
        workspace=Workspace(depth_m=(0.5, 0.9)),
    ).frame()
    assert isinstance(limited, Frame)
    low, high = limited.stereo.disparities_px
    assert low <= 45 / 0.9 < 45 / 0.5 <= high
    assert np.nanmax(limited.depth_m) < 1.0 < np.nanmax(whole.depth_m)
    assert limited.workspace.depth_m == (0.5, 0.9)


def test_a_ball_is_measured_from_two_pictures():
    scene = simulated(Rig.SIDEWAYS)
    result = reconstruct(area_frame_of(scene), scene.drawing, Settings())
    assert result.solid.kind == "sphere"
    assert 2000 * result.solid.radius_m == pytest.approx(scene.diameter_mm, rel=0.01)


def test_an_area_off_the_picture_is_refused_as_a_drawing():
    scene = simulated(Rig.SIDEWAYS)
    with pytest.raises(DrawingError, match="outside the frame"):
        Capture("v", views=scene.views).frame(AreaOfInterest.rectangle((10, 10), (CAMERA.width + 50, 90)))


def test_a_recorded_frame_ignores_the_area():
    depth = np.full((EXACT_CAMERA.height, EXACT_CAMERA.width), 1.0)
    frame = Frame(np.zeros((*depth.shape, 3), np.uint8), EXACT_CAMERA.cloud(depth), EXACT_CAMERA)
    assert Capture("recorded", recorded=frame).frame(AreaOfInterest.rectangle((1, 1), (5, 5))) is frame

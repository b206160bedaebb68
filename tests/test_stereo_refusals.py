"""Views that hold no depth are refused with what to do about it: each reason has its own scene."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from rotrecon.capture import Capture
from rotrecon.drawing import AreaOfInterest
from rotrecon.frame import Frame, FrameUnavailable, View
from rotrecon.workspace import Workspace
from tests.views import CAMERA, Rig, at, simulated

GREY = 110


def views() -> tuple[View, View]:
    first, second = simulated(Rig.SIDEWAYS).views
    return first, second


def why_not(*given: View, area: AreaOfInterest | None = None) -> str:
    frame = Capture("views", views=given).frame(area)
    assert isinstance(frame, FrameUnavailable), frame.stereo
    return frame.reason


def moved_to(view: View, T_reference_view: np.ndarray) -> View:
    """The picture as it is, said to be from elsewhere."""
    return replace(view, T_base_camera=views()[0].T_base_camera @ T_reference_view)


def test_the_scene_itself_is_matched():
    assert isinstance(Capture("views", views=views()).frame(), Frame)


def test_equal_poses():
    first, second = views()
    assert "equals that of view 1" in why_not(first, moved_to(second, np.eye(4)))


def test_pure_rotation():
    first, second = views()
    reason = why_not(first, moved_to(second, at(turned_deg=(0, 5, 0))))
    assert "only turned" in reason
    assert "move the camera sideways" in reason


def test_poses_too_close():
    reason = why_not(*simulated(at(0.003)).views)
    assert "3 mm beside" in reason
    assert "move it by" in reason


def test_motion_along_the_line_of_sight():
    first, second = views()
    assert "move it sideways" in why_not(first, moved_to(second, at(0.02, 0, 0.1)))


@pytest.mark.parametrize("place", [at(0.1, turned_deg=(0, 120, 0)), at(30.0)])
def test_views_that_do_not_overlap(place):
    first, second = views()
    assert "of what view 1 sees" in why_not(first, moved_to(second, place))


def test_views_that_look_in_too_different_directions():
    first, second = views()
    turned = why_not(first, moved_to(second, at(1.5, 0, 1.0, turned_deg=(0, -85, 0))))
    assert "turn the cameras" in turned


@pytest.mark.parametrize("turned_deg", [(0.6, 0, 0), (0, 0, 2.5)])
def test_calibration_that_the_pictures_contradict(turned_deg):
    first, second = views()
    reason = why_not(first, moved_to(second, Rig.SIDEWAYS @ at(turned_deg=turned_deg)))
    assert "px off the rows" in reason
    assert "calibrate" in reason


def test_a_small_epipolar_error_is_shown_and_not_refused():
    first, second = views()
    frame = Capture("views", views=(first, moved_to(second, Rig.SIDEWAYS @ at(turned_deg=(0.06, 0, 0))))).frame()
    assert isinstance(frame, Frame)
    assert frame.stereo.epipolar_error_px == pytest.approx(450 * np.deg2rad(0.06), abs=0.1)


@pytest.mark.parametrize("place", ["SIDEWAYS", "VERTICAL", "CONVERGING"])
def test_pictures_swapped(place):
    first, second = simulated(getattr(Rig, place)).views
    reason = why_not(replace(first, image=second.image), replace(second, image=first.image))
    assert "swapped" in reason
    assert "exchange" in reason


def test_too_dark_and_saturated():
    first, second = views()
    dark = [replace(view, image=view.image // 12) for view in (first, second)]
    bright = [replace(view, image=np.clip(view.image.astype(int) * 5, 0, 255).astype(np.uint8)) for view in views()]
    assert "view 1 is too dark" in why_not(*dark)
    assert "view 2: its picture is too dark" in why_not(first, dark[1])
    assert "view 1 is saturated" in why_not(*bright)


def test_no_texture_anywhere():
    noise = np.random.default_rng(0).normal(GREY, 1, (2, CAMERA.height, CAMERA.width, 1))
    plain = [
        replace(view, image=np.rint(np.repeat(one, 3, axis=2)).astype(np.uint8))
        for view, one in zip(views(), noise, strict=True)
    ]
    assert "too little contrast" in why_not(*plain)
    limited = Capture("views", views=tuple(plain), workspace=Workspace(depth_m=(0.4, 2.0))).frame()
    assert isinstance(limited, FrameUnavailable)
    assert "too little contrast" in limited.reason
    assert "project a pattern" in limited.reason


def test_no_texture_in_the_area():
    scene = simulated(Rig.SIDEWAYS)
    rng = np.random.default_rng(1)
    area = AreaOfInterest.rectangle((60, 60), (230, 230))
    painted = []
    for view, left in zip(scene.views, (20, 0), strict=True):
        image = view.image.copy()
        part = image[20:270, left:270]
        part[:] = np.rint(rng.normal(GREY, 1.5, part.shape)).clip(0, 255)
        painted.append(replace(view, image=image))
    reason = why_not(*painted, area=area)
    assert "% of the area" in reason
    assert "project a pattern" in reason


def test_an_object_that_moved_between_exposures():
    scene = simulated(Rig.SIDEWAYS)
    first, second = scene.views
    image = second.image.copy()
    u, v, width, height = cv2.boundingRect(scene.view.mask.astype(np.uint8))
    part = (slice(v, v + height // 3), slice(max(u - 80, 0), u + width))
    image[part] = np.roll(image, 9, axis=0)[part]
    area = AreaOfInterest.rectangle((u, v + 9), (u + width, v + height // 3))
    reason = why_not(first, replace(second, image=image), area=area)
    assert "moved between the exposures" in reason
    assert "at rest" in reason

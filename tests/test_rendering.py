"""A rendered view is exact in depth, and every camera sees the same world."""

import numpy as np
import pytest

from rotrecon.camera import PinholeCamera, inverse, transform
from rotrecon.primitives import Frustum
from rotrecon.simulation.rendering import RenderedView, render
from rotrecon.simulation.simulate import OBJECTS, Simulated, simulate

SMALL = PinholeCamera(320, 240, np.array([[300.0, 0, 159.5], [0, 300.0, 119.5], [0, 0, 1]]))


@pytest.fixture(scope="module", params=OBJECTS)
def scene(request: pytest.FixtureRequest) -> Simulated:
    return simulate(request.param, 3, camera=SMALL, noise=None, supersampling=1)


def object_points(view: RenderedView) -> tuple[np.ndarray, np.ndarray]:
    pixels = np.argwhere(view.mask)[:, ::-1]
    return pixels, view.camera.unproject(pixels, view.depth_m[view.mask])


def test_exact_depth_lies_on_the_surface(scene: Simulated) -> None:
    solid = scene.solid_in_camera
    _, points = object_points(scene.view)
    if isinstance(solid, Frustum):
        along = (points - solid.center_m) @ solid.direction
        points = points[np.abs(along) < solid.length_m / 2 - 1e-6]
    assert len(points) > 200
    assert np.abs(solid.distance(points)).max() < 1e-9


def test_the_background_is_well_behind_the_object(scene: Simulated) -> None:
    view = scene.view
    assert (view.body >= 0).all()
    assert view.depth_m[~view.mask].min() > view.depth_m[view.mask].max() + 0.29


def test_moving_camera_and_world_together_changes_nothing(scene: Simulated) -> None:
    turn = np.eye(4)
    turn[:3, :3] = np.array([[0.0, -0.6, 0.8], [1.0, 0, 0], [0, 0.8, 0.6]])
    turn[:3, 3] = [1.0, -2.0, 0.5]
    view = scene.view
    moved = render(scene.world.moved(turn), view.camera, turn @ view.T_base_camera)
    same = moved.body == view.body
    assert same.mean() > 0.9999
    np.testing.assert_allclose(moved.depth_m[same], view.depth_m[same], atol=1e-9)
    assert np.median(np.abs(moved.image.astype(int) - view.image)) == 0
    assert (np.abs(moved.image.astype(int) - view.image) <= 1).mean() > 0.999


def test_a_second_camera_sees_the_same_point_in_the_same_colour(scene: Simulated) -> None:
    view = scene.view
    aside = np.eye(4)
    aside[0, 3] = 0.1
    second = render(scene.world, view.camera, view.T_base_camera @ aside)
    inner = np.flatnonzero(view.mask)[:: max(1, view.mask.sum() // 40)]
    pixels = np.stack([inner % view.camera.width, inner // view.camera.width], axis=-1)
    points = transform(inverse(aside), view.camera.unproject(pixels, view.depth_m.ravel()[inner]))
    nearest = np.rint(view.camera.project(points)).astype(int)
    # a camera turned so that one of its rays meets the point exactly: no interpolation is needed to compare
    compared = 0
    for pixel, point, place in zip(pixels, points, nearest, strict=True):
        shifted = view.camera.K.copy()
        shifted[:2, 2] += place - view.camera.project(point)
        single = shifted.copy()
        single[:2, 2] -= place
        seen = render(scene.world, PinholeCamera(1, 1, single), second.T_base_camera)
        if abs(seen.depth_m[0, 0] - point[2]) < 1e-6:
            compared += 1
            assert np.abs(seen.image[0, 0].astype(int) - view.image[pixel[1], pixel[0]]).max() <= 1
    assert compared > 25


def test_supersampling_changes_colours_at_edges_and_nothing_else() -> None:
    scene = simulate("leg", 0, camera=SMALL, noise=None, supersampling=1)
    fine = render(scene.world, SMALL, scene.view.T_base_camera, supersampling=3)
    np.testing.assert_array_equal(fine.depth_m, scene.view.depth_m)
    assert np.abs(fine.image.astype(int) - scene.view.image).mean() < 12
    with pytest.raises(ValueError, match="supersampling"):
        render(scene.world, SMALL, scene.view.T_base_camera, supersampling=-1)


def test_without_samples_the_picture_is_black_and_the_depth_the_same() -> None:
    scene = simulate("cone", 0, camera=SMALL, noise=None, supersampling=1)
    blank = render(scene.world, SMALL, scene.view.T_base_camera, supersampling=0)
    assert not blank.image.any()
    np.testing.assert_array_equal(blank.depth_m, scene.view.depth_m)
    np.testing.assert_array_equal(blank.body, scene.view.body)

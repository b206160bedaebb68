"""Distorted cameras: brought into the pinhole raster without inventing a depth."""

import numpy as np
import pytest

from rotrecon.camera import PinholeCamera
from rotrecon.scene.formats.image import encode_png
from rotrecon.scene.formats.npz import encode_npz
from rotrecon.scene.lens import Lens, pixel_grid
from rotrecon.scene.reading import read_scene
from tests.scenes import CAMERA, HEIGHT, WIDTH, assert_refused, save, table

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

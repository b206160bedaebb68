"""Clouds without a raster, put behind the pixels of a camera."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from plyfile import PlyData, PlyElement

from rotrecon.scene.organise import z_buffer
from rotrecon.scene.reading import read_scene
from tests.scenes import CAMERA, HEIGHT, WIDTH, sample_frame, save, table

LAWS = settings(deadline=None, max_examples=25)
CLOUDS = arrays(np.float32, (40, 3), elements=st.floats(0.25, 4, width=32))


@LAWS
@given(CLOUDS, arrays(np.uint8, (40, 3)), st.randoms(use_true_random=False))
def test_the_order_of_an_unorganised_cloud_does_not_matter(points, colors, random):
    order = random.sample(range(len(points)), len(points))
    cloud, picture = z_buffer(points, colors, CAMERA)
    again, picture_again = z_buffer(points[order], colors[order], CAMERA)
    assert np.array_equal(cloud, again, equal_nan=True)
    assert np.array_equal(picture, picture_again)


@LAWS
@given(CLOUDS)
def test_the_nearest_point_is_kept(points):
    cloud, _ = z_buffer(points, None, CAMERA)
    nearest = np.full((HEIGHT, WIDTH), np.inf, np.float32)
    for point, (u, v) in zip(points, np.rint(CAMERA.project(points)).astype(int), strict=True):
        if 0 <= u < WIDTH and 0 <= v < HEIGHT:
            nearest[v, u] = min(nearest[v, u], point[2])
    assert np.array_equal(np.nan_to_num(cloud[..., 2], nan=np.inf), nearest)


def test_an_unorganised_ply_is_put_behind_the_pixels(tmp_path):
    points = sample_frame().points_m.reshape(-1, 3)[::-1]
    vertices = np.array([tuple(point) for point in points], [("x", "f4"), ("y", "f4"), ("z", "f4")])
    PlyData([PlyElement.describe(vertices, "vertex")]).write(tmp_path / "cloud.ply")
    scene = table()
    scene["frame"] = {"camera": "main", "cloud": "cloud.ply"}
    assert np.array_equal(read_scene(save(tmp_path, scene)).recorded.points_m, sample_frame().points_m)

"""A cloud made in the memory that its depth stood in is the cloud of that depth."""

import numpy as np
import pytest

from rotrecon.camera import PinholeCamera, depth_before


@pytest.mark.parametrize("size", [(1, 1), (5, 1), (3, 2), (7, 16), (4, 17), (31, 50), (2, 131)])
def test_a_cloud_in_place_is_every_pixel_at_its_depth(size):
    width, height = size
    camera = PinholeCamera(width, height, np.array([[60.0, 0, 2.5], [0, 62.0, 1.5], [0, 0, 1]]))
    depth = np.random.default_rng(height).uniform(0.5, 2.0, (height, width)).astype(np.float32)
    depth[::3, ::2] = np.nan
    depth[1::5, 1::3], depth[2::7] = -1.0, np.inf
    v, u = np.indices(depth.shape)
    known = (depth > 0) & np.isfinite(depth)
    expected = camera.unproject(np.stack([u, v], axis=-1), np.where(known, depth, np.nan))
    np.testing.assert_allclose(camera.cloud(depth), expected, rtol=1e-6, atol=1e-7)
    points = np.empty((height, width, 3), np.float32)
    depth_before(points)[...] = depth
    camera.spread(points)
    np.testing.assert_array_equal(points, camera.cloud(depth))

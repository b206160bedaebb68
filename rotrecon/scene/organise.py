"""Puts clouds behind the pixels of a camera, and draws a picture of a cloud that came without one."""

import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bytes, Cloud
from rotrecon.camera import PinholeCamera
from rotrecon.scene.lens import Lens, pixel_grid

RAY_TOLERANCE_PX = 3.0
"""How far points may lie from the rays of their own pixels, in the median: rectification moves them by 1 or 2."""
UNLIT_GREY = 64
"""Shade of a pixel that has depth but no neighbours to take a normal from, out of 255."""


def z_buffer(points_m: Cloud, colors: Bytes | None, camera: PinholeCamera) -> tuple[Cloud, Bytes | None]:
    """The nearest point behind each pixel of an unorganised cloud (n, 3), whatever the order of its points.

    Returns the organised cloud (height, width, 3), NaN where no point falls, and its colours, black there.
    """
    pixels = np.rint(camera.project(points_m))
    with np.errstate(invalid="ignore"):
        inside = ((pixels >= 0) & (pixels < (camera.width, camera.height))).all(axis=-1)
    points = points_m[inside]
    own_colors = None if colors is None else colors[inside]
    u, v = pixels[inside].astype(np.int64).T
    nearest = _nearest_first(v * camera.width + u, points, own_colors)
    cells = (v * camera.width + u)[nearest]

    cloud = np.full((camera.height * camera.width, 3), np.nan, dtype=np.float32)
    cloud[cells] = points[nearest]
    shape = (camera.height, camera.width, 3)
    if own_colors is None:
        return cloud.reshape(shape), None
    picture = np.zeros((camera.height * camera.width, 3), dtype=np.uint8)
    picture[cells] = own_colors[nearest]
    return cloud.reshape(shape), picture.reshape(shape)


def _nearest_first(cells: NDArray[np.int64], points: Cloud, colors: Bytes | None) -> NDArray[np.int64]:
    """The index of one point for each occupied cell: the nearest, ties broken by value and never by order."""
    ties = [] if colors is None else list(colors.T)
    order = np.lexsort([*ties, points[:, 0], points[:, 1], points[:, 2], cells])
    _, first = np.unique(cells[order], return_index=True)
    return order[first]


def distance_from_rays_px(points_m: Cloud, lens: Lens) -> float:
    """How far the points of an organised cloud (height, width, 3) are seen from their own pixels: the median."""
    seen = np.isfinite(points_m[..., 2])
    offset = lens.project(points_m[seen]) - pixel_grid(lens.camera)[seen]
    return float(np.median(np.hypot(offset[:, 0], offset[:, 1])))


def shade(points_m: Cloud) -> Bytes:
    """A grey RGB picture of an organised cloud (height, width, 3), lit from the camera (Lambert's cosine law).

    Black where there is no depth.
    """
    along_v, along_u = (
        np.gradient(points_m, axis=axis) if points_m.shape[axis] > 1 else 0 * points_m for axis in (0, 1)
    )
    normals = np.cross(along_u, along_v)
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = np.abs((normals * points_m).sum(axis=-1)) / (
            np.linalg.norm(normals, axis=-1) * np.linalg.norm(points_m, axis=-1)
        )
    grey = np.where(
        np.isfinite(cosine), UNLIT_GREY + (255 - UNLIT_GREY) * np.clip(np.nan_to_num(cosine), 0, 1), UNLIT_GREY
    )
    grey[~np.isfinite(points_m[..., 2])] = 0
    return np.repeat(np.rint(grey).astype(np.uint8)[..., None], 3, axis=-1)

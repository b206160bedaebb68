"""Supersampled pictures at a cost that allows hundreds: many rays where something ends, few on walls."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import BLOCK, Bools, Cloud, Floats, freeze
from rotrecon.camera import PinholeCamera, inverse, rotate
from rotrecon.scene.lens import Lens, pixel_grid
from rotrecon.simulation.raycast import Plane
from rotrecon.simulation.rendering import Rays, World, first_bodies, in_shadow, light_back, shade

SUPERSAMPLING = 4
"""Rays along each side of a pixel that shows a solid, an edge or the border of a shadow."""
WALL_SAMPLING = 2
"""The same inside a wall: its grain is two pixels and more, which four rays average to a percent of its contrast."""
MIXED_PX = 2
"""How near an edge pixels are taken for mixed: one would do for straight edges."""


@dataclass(frozen=True)
class Window:
    """A rectangle of pixels, the ends not included."""

    left: int
    top: int
    right: int
    bottom: int


@dataclass(frozen=True, eq=False)
class _Pixels:
    """Rays through pixels' centres, and how they turn within a pixel."""

    x: Floats
    """(N,) with z = 1, and so the others."""
    y: Floats
    x_by_u: Floats
    x_by_v: Floats
    y_by_u: Floats
    y_by_v: Floats

    def __post_init__(self) -> None:
        freeze(self)

    def split(self, index: NDArray[np.intp], samples: int, T_base_camera: Floats) -> Rays:
        """A grid of samples x samples rays (len(index) * samples^2,) within each of the chosen pixels."""
        steps = (np.arange(samples) + 0.5) / samples - 0.5
        dv, du = (offset.reshape(-1) for offset in np.meshgrid(steps, steps, indexing="ij"))
        x = self.x[index, None] + self.x_by_u[index, None] * du + self.x_by_v[index, None] * dv
        y = self.y[index, None] + self.y_by_u[index, None] * du + self.y_by_v[index, None] * dv
        return Rays(x.reshape(-1), y.reshape(-1), T_base_camera)


def picture(
    world: World,
    lens: Lens,
    T_base_camera: Floats,
    supersampling: int = SUPERSAMPLING,
    window: Window | None = None,
) -> Cloud:
    """Linear light (height, width, 3) in the raster that a lens records: means over the footprints of its pixels.

    `T_base_camera` is (4, 4) rigid. Outside a window nothing is rendered and all is black.
    """
    camera = lens.camera
    light = np.zeros((camera.height, camera.width, 3), dtype=np.float32)
    part = Window(0, 0, camera.width, camera.height) if window is None else window
    height, width = part.bottom - part.top, part.right - part.left
    if height <= 0 or width <= 0:
        return light
    pixels = _pixels(lens, part)
    centre = Rays(pixels.x, pixels.y, T_base_camera)
    seen, shadow = _labels(world, centre)
    mixed = _mixed(world, seen.reshape(height, width), shadow.reshape(height, width)).reshape(-1)
    result = np.zeros((height * width, 3), dtype=np.float32)
    for index in _pieces(np.flatnonzero(mixed), supersampling):
        rays = pixels.split(index, supersampling, T_base_camera)
        result[index] = light_back(world, rays, *first_bodies(world, rays)).reshape(len(index), -1, 3).mean(axis=1)
    for number in np.unique(seen[~mixed & (seen >= 0)]):
        for index in _pieces(np.flatnonzero(~mixed & (seen == number)), min(supersampling, WALL_SAMPLING)):
            rays = pixels.split(index, min(supersampling, WALL_SAMPLING), T_base_camera)
            result[index] = _wall_light(world, int(number), rays, shadow[index])
    light[part.top : part.bottom, part.left : part.right] = result.reshape(height, width, 3)
    return light


def _pixels(lens: Lens, part: Window) -> _Pixels:
    """The rays of a window's pixels; within a pixel a lens is linear to a millionth of one."""
    shifted = lens.camera.K - np.array([[0, 0, part.left], [0, 0, part.top], [0, 0, 0]])
    camera = PinholeCamera(part.right - part.left, part.bottom - part.top, shifted)
    grid = pixel_grid(camera).reshape(-1, 2)
    lens = Lens(camera, lens.distortion)
    centre = _directions(lens, grid)
    if lens.distorts:
        by_u, by_v = (2 * (_directions(lens, grid + step) - centre) for step in ((0.5, 0.0), (0.0, 0.5)))
    else:
        by_u, by_v = (np.broadcast_to(step, centre.shape) for step in np.diag(1 / np.diag(camera.K)[:2]))
    x, y = centre.T.copy()
    return _Pixels(x, y, by_u[:, 0], by_v[:, 0], by_u[:, 1], by_v[:, 1])


def _directions(lens: Lens, pixels_px: Floats) -> Floats:
    """Rays (N, 2), z = 1, through places (N, 2) in the raster that a lens records."""
    if not lens.distorts:
        return lens.camera.unproject(pixels_px, np.ones(len(pixels_px)))[:, :2]
    criteria = (cv2.TERM_CRITERIA_MAX_ITER | cv2.TERM_CRITERIA_EPS, 100, 1e-12)
    rays = cv2.undistortPoints(pixels_px.reshape(-1, 1, 2), lens.camera.K, lens.distortion, criteria=criteria)
    return np.asarray(rays, dtype=np.float64).reshape(-1, 2)


def _labels(world: World, rays: Rays) -> tuple[NDArray[np.int8], Bools]:
    """The body (N,) that each ray meets, -1 for none, and whether it is in shadow there, told of planes only."""
    depth, seen = first_bodies(world, rays)
    shadow = np.zeros(len(seen), dtype=bool)
    for number, body in enumerate(world.bodies):
        if isinstance(body.shape, Plane):
            index = np.flatnonzero(seen == number)
            shadow[index] = in_shadow(world, rays.chosen(index), depth[index], number)
    return seen, shadow


def _mixed(world: World, seen: NDArray[np.int8], shadow: Bools) -> Bools:
    """Which pixels (height, width) show a solid or are near an edge, by what is seen in their centres."""
    label = (2 * (seen.astype(np.int16) + 1) + shadow).astype(np.uint8)
    window = np.ones((2 * MIXED_PX + 1, 2 * MIXED_PX + 1), dtype=np.uint8)
    edge = np.asarray(cv2.dilate(label, window)) != np.asarray(cv2.erode(label, window))
    solids = [number for number, body in enumerate(world.bodies) if not isinstance(body.shape, Plane)]
    return edge | np.isin(seen, solids)


def _wall_light(world: World, number: int, rays: Rays, shadow: Bools) -> Floats:
    """Mean light (N, 3) of pixels on a plane, from several rays (N * M,) in each."""
    body = world.bodies[number]
    origin, directions = rays.seen_from(body)
    points = origin - (origin[2] / directions[:, 2:]) * directions
    facing = rotate(inverse(body.T_base_body), world.toward_light)[2:]
    lit = shade(facing, np.where(shadow, 0.0, facing.clip(0, 1)))
    return body.material.albedo(points).reshape(len(shadow), -1, 3).mean(axis=1) * lit[:, None]


def _pieces(index: NDArray[np.intp], samples: int) -> list[NDArray[np.intp]]:
    """Pixels in pieces whose rays stay in the processor's cache."""
    return np.array_split(index, 1 + len(index) * samples**2 // BLOCK)

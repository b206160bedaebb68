"""Pictures and exact depth of a world of analytic bodies; a second camera is one more call."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bools, Bytes, Floats, freeze
from rotrecon.camera import PinholeCamera, inverse, rotate, transform
from rotrecon.raycast import Plane, Shape, first_hit, outward_normals
from rotrecon.texture import GAMMA, Material

AMBIENT = 0.45
"""Share of the light that comes from everywhere: shadows in a lit room stay readable."""
AMBIENT_SLOPE = 0.35
"""How much darker ambient light is away from the lamp, so that curved surfaces look curved there."""


@dataclass(frozen=True, eq=False)
class Body:
    """One thing in the world."""

    shape: Shape
    """In body coordinates."""
    T_base_body: Floats
    """(4, 4) rigid."""
    material: Material

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class World:
    """What stands in front of the camera; the first body is the object."""

    bodies: tuple[Body, ...]
    toward_light: Floats
    """(3,) unit, in base coordinates."""

    def __post_init__(self) -> None:
        freeze(self)

    def moved(self, T_target_base: Floats) -> "World":
        """The same world in another base."""
        bodies = tuple(Body(body.shape, T_target_base @ body.T_base_body, body.material) for body in self.bodies)
        return World(bodies, rotate(T_target_base, self.toward_light))


@dataclass(frozen=True, eq=False)
class RenderedView:
    """What one camera sees."""

    image: Bytes
    """(height, width, 3) RGB."""
    depth_m: Floats
    """(height, width) exact depth along z at the pixels' centres; infinite where no body is seen."""
    body: NDArray[np.int8]
    """(height, width) index of the body at the pixel's centre; -1 for none."""
    camera: PinholeCamera
    T_base_camera: Floats

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def mask(self) -> Bools:
        """(height, width) which pixels show the object."""
        return self.body == 0


@dataclass(frozen=True, eq=False)
class _Rays:
    """Rays of one point in every pixel; with z = 1 in the camera, so that their parameter is depth."""

    origin_m: Floats
    directions: Floats
    depth_m: Floats
    body: NDArray[np.int8]


def render(world: World, camera: PinholeCamera, T_base_camera: Floats, supersampling: int = 1) -> RenderedView:
    """The world as one camera sees it.

    `T_base_camera` is (4, 4) rigid. With supersampling n a colour is the mean of a grid of n x n rays;
    depth and body are always those of the ray through its centre.
    """
    if supersampling < 1:
        raise ValueError("supersampling must be 1 or more")
    centre = _trace(world, camera, T_base_camera, (0.0, 0.0))
    if supersampling == 1:
        light = _light(world, centre)
    else:
        offsets = (np.arange(supersampling) + 0.5) / supersampling - 0.5
        light = np.zeros((len(centre.depth_m), 3))
        for dv in offsets:
            for du in offsets:
                light += _light(world, _trace(world, camera, T_base_camera, (du, dv)))
        light /= supersampling**2
    size = (camera.height, camera.width)
    return RenderedView(
        image=np.rint(255 * light.clip(0, 1) ** (1 / GAMMA)).astype(np.uint8).reshape(*size, 3),
        depth_m=centre.depth_m.reshape(size),
        body=centre.body.reshape(size),
        camera=camera,
        T_base_camera=np.array(T_base_camera, dtype=np.float64),
    )


def _trace(world: World, camera: PinholeCamera, T_base_camera: Floats, offset_px: tuple[float, float]) -> _Rays:
    v, u = np.mgrid[: camera.height, : camera.width]
    pixels = np.stack([u.ravel() + offset_px[0], v.ravel() + offset_px[1]], axis=-1)
    directions = rotate(T_base_camera, camera.unproject(pixels, np.ones(len(pixels))))
    origin = T_base_camera[:3, 3]
    depth = np.full(len(pixels), np.inf)
    seen = np.full(len(pixels), -1, dtype=np.int8)
    for number, body in enumerate(world.bodies):
        T_body_base = inverse(body.T_base_body)
        hit = first_hit(body.shape, transform(T_body_base, origin), rotate(T_body_base, directions))
        nearer = hit < depth
        depth[nearer] = hit[nearer]
        seen[nearer] = number
    return _Rays(origin, directions, depth, seen)


def _light(world: World, rays: _Rays) -> Floats:
    """Linear light (N, 3) that comes back along the rays: Lambert's law, ambient light and cast shadows."""
    light = np.zeros((len(rays.body), 3))
    for number, body in enumerate(world.bodies):
        chosen = np.flatnonzero(rays.body == number)
        points = rays.origin_m + rays.depth_m[chosen, None] * rays.directions[chosen]
        in_body = transform(inverse(body.T_base_body), points)
        normals = rotate(body.T_base_body, outward_normals(body.shape, in_body))
        facing = normals @ world.toward_light
        direct = np.where(_in_shadow(world, points, number), 0.0, facing.clip(0, 1))
        shade = AMBIENT * (1 + AMBIENT_SLOPE * facing) + (1 - AMBIENT) * direct
        light[chosen] = body.material.albedo(in_body) * shade[:, None]
    return light


def _in_shadow(world: World, points_m: Floats, receiver: int) -> Bools:
    """Which points (N, 3) another solid hides from the light; planes bound the room and cast none."""
    hidden = np.zeros(len(points_m), dtype=bool)
    for number, body in enumerate(world.bodies):
        if number == receiver or isinstance(body.shape, Plane):
            continue
        T_body_base = inverse(body.T_base_body)
        hit = first_hit(body.shape, transform(T_body_base, points_m), rotate(T_body_base, world.toward_light))
        hidden |= np.isfinite(hit)
    return hidden

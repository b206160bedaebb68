"""Pictures and exact depth of a world of analytic bodies; a second camera is one more call."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bools, Bytes, Floats, freeze
from rotrecon.camera import PinholeCamera, inverse, rotate
from rotrecon.simulation.raycast import Plane, Shape, bounding_radius_m, first_hit, outward_normals
from rotrecon.simulation.texture import GAMMA, Material

AMBIENT = 0.45
"""Share of the light that comes from everywhere: shadows in a lit room stay readable."""
AMBIENT_SLOPE = 0.35
"""How much darker ambient light is away from the lamp, so that curved surfaces look curved there."""
SHININESS = 60.0
"""Exponent of a glossy highlight: of satin varnish, a streak some 15 degrees wide."""


@dataclass(frozen=True, eq=False)
class Body:
    """One thing in the world."""

    shape: Shape
    """In body coordinates."""
    T_base_body: Floats
    """(4, 4) rigid."""
    material: Material
    gloss: float = 0.0
    """Light of a highlight's middle, where 1 is white; it moves with the camera."""

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
        bodies = tuple(replace(body, T_base_body=T_target_base @ body.T_base_body) for body in self.bodies)
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
class Rays:
    """One ray in every pixel, with z = 1 in the camera, so that the parameter along it is depth."""

    x: Floats
    """(N,) in the camera; so is y."""
    y: Floats
    T_base_camera: Floats

    def seen_from(self, body: Body) -> tuple[Floats, Floats]:
        """Origin (3,) and directions (N, 3) in the coordinates of a body.

        Sums of columns: a product of an (N, 3) and a (3, 3) matrix takes several times as long.
        """
        T_body_camera = inverse(body.T_base_body) @ self.T_base_camera
        directions = np.empty((len(self.x), 3))
        for axis, (right, down, ahead) in enumerate(T_body_camera[:3, :3]):
            directions[:, axis] = self.x * right + self.y * down + ahead
        return T_body_camera[:3, 3], directions

    def chosen(self, index: NDArray[np.intp]) -> "Rays":
        """Some of the rays."""
        return Rays(self.x[index], self.y[index], self.T_base_camera)


def render(world: World, camera: PinholeCamera, T_base_camera: Floats, supersampling: int = 1) -> RenderedView:
    """The world as one camera sees it.

    `T_base_camera` is (4, 4) rigid. With supersampling n a colour is the mean of a grid of n x n rays, and with 0
    the picture stays black; depth and body are always those of the ray through a pixel's centre.
    """
    if supersampling < 0:
        raise ValueError("supersampling must not be negative")
    centre = _rays(camera, T_base_camera, 0.0, 0.0)
    depth, seen = first_bodies(world, centre)
    if supersampling == 0:
        light = np.zeros((len(depth), 3))
    elif supersampling == 1:
        light = light_back(world, centre, depth, seen)
    else:
        offsets = (np.arange(supersampling) + 0.5) / supersampling - 0.5
        light = np.zeros((len(depth), 3))
        for dv, du in product(offsets, repeat=2):
            rays = _rays(camera, T_base_camera, du, dv)
            light += light_back(world, rays, *first_bodies(world, rays))
        light /= supersampling**2
    size = (camera.height, camera.width)
    return RenderedView(
        image=np.rint(255 * light.clip(0, 1) ** (1 / GAMMA)).astype(np.uint8).reshape(*size, 3),
        depth_m=depth.reshape(size),
        body=seen.reshape(size),
        camera=camera,
        T_base_camera=np.array(T_base_camera, dtype=np.float64),
    )


def _rays(camera: PinholeCamera, T_base_camera: Floats, du_px: float, dv_px: float) -> Rays:
    v, u = np.indices((camera.height, camera.width)).reshape(2, -1)
    rays = camera.unproject(np.stack([u + du_px, v + dv_px], axis=-1), np.ones(len(u)))
    return Rays(rays[:, 0].copy(), rays[:, 1].copy(), T_base_camera)


def first_bodies(world: World, rays: Rays) -> tuple[Floats, NDArray[np.int8]]:
    """Depth (N,) of what the rays meet first, and the number (N,) of its body."""
    depth = np.full(len(rays.x), np.inf)
    seen = np.full(len(rays.x), -1, dtype=np.int8)
    for number, body in enumerate(world.bodies):
        near = _rays_near(body, rays)
        hit = first_hit(body.shape, *rays.chosen(near).seen_from(body))
        nearer = hit < depth[near]
        depth[near[nearer]] = hit[nearer]
        seen[near[nearer]] = number
    return depth, seen


def light_back(world: World, rays: Rays, depth_m: Floats, seen: NDArray[np.int8]) -> Floats:
    """Linear light (N, 3) that comes back along the rays: Lambert's law, ambient light, cast shadows and gloss."""
    light = np.zeros((len(seen), 3))
    for number, body in enumerate(world.bodies):
        chosen = np.flatnonzero(seen == number)
        if len(chosen) == 0:
            continue
        lit, depth = rays.chosen(chosen), depth_m[chosen]
        origin, directions = lit.seen_from(body)
        points = origin + depth[:, None] * directions
        normals, toward_light = outward_normals(body.shape, points), _toward_light(world, body)
        facing = normals @ toward_light
        direct = np.where(in_shadow(world, lit, depth, number), 0.0, facing.clip(0, 1))
        light[chosen] = body.material.albedo(points) * shade(facing, direct)[:, None]
        if body.gloss > 0:
            light[chosen] += (body.gloss * _highlight(normals, directions, toward_light) * (direct > 0))[:, None]
    return light


def shade(facing: Floats, direct: Floats) -> Floats:
    """Light (N,) on surfaces of albedo 1, by the cosine to the lamp and what of it is not in shadow."""
    return AMBIENT * (1 + AMBIENT_SLOPE * facing) + (1 - AMBIENT) * direct


def in_shadow(world: World, rays: Rays, depth_m: Floats, receiver: int) -> Bools:
    """At which of the points (N,) another solid hides the light; planes bound the room and cast no shadow."""
    hidden = np.zeros(len(depth_m), dtype=bool)
    for number, body in enumerate(world.bodies):
        if number == receiver or isinstance(body.shape, Plane):
            continue
        near = _points_before(body, rays, depth_m, world.toward_light)
        origin, directions = rays.chosen(near).seen_from(body)
        points = origin + depth_m[near, None] * directions
        hidden[near] |= np.isfinite(first_hit(body.shape, points, _toward_light(world, body)))
    return hidden


def _highlight(normals: Floats, directions: Floats, toward_light: Floats) -> Floats:
    """Blinn's highlight (N,): a power of the cosine between the normal and halfway from light to camera."""
    halfway = toward_light - directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    halfway /= np.linalg.norm(halfway, axis=-1, keepdims=True)
    return (normals * halfway).sum(axis=-1).clip(0, 1) ** SHININESS


def _rays_near(body: Body, rays: Rays) -> NDArray[np.intp]:
    """Which rays pass through the sphere round a body: all others miss it."""
    x, y, z = (inverse(rays.T_base_camera) @ body.T_base_body)[:3, 3]
    outside = x**2 + y**2 + z**2 - bounding_radius_m(body.shape) ** 2
    if not 0 < outside < np.inf:
        return np.arange(len(rays.x))
    along = x * rays.x + y * rays.y + z
    return np.flatnonzero((along > 0) & (along**2 >= outside * (rays.x**2 + rays.y**2 + 1)))


def _points_before(body: Body, rays: Rays, depth_m: Floats, toward_light: Floats) -> NDArray[np.intp]:
    """From which points the way to the light passes through the sphere round a body."""
    T_camera_base = inverse(rays.T_base_camera)
    middle, toward = (T_camera_base @ body.T_base_body)[:3, 3], rotate(T_camera_base, toward_light)
    x, y, z = rays.x * depth_m - middle[0], rays.y * depth_m - middle[1], depth_m - middle[2]
    along = x * toward[0] + y * toward[1] + z * toward[2]
    return np.flatnonzero(x**2 + y**2 + z**2 - along**2 <= bounding_radius_m(body.shape) ** 2)


def _toward_light(world: World, body: Body) -> Floats:
    return rotate(inverse(body.T_base_body), world.toward_light)

"""Where a ray first meets a solid of revolution, a solid with flat faces or a plane, in the body's own coordinates."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.primitives import Frustum, Sphere

ON_CAP_M = 1e-9
"""How near an end a point counts as one of the cap: far above rounding, far below a pixel."""


@dataclass(frozen=True)
class Plane:
    """The plane z = 0 of its body, without end."""


@dataclass(frozen=True)
class Box:
    """A cuboid about the origin."""

    half_lengths_m: tuple[float, float, float]
    """Along x, y and z."""


@dataclass(frozen=True)
class Prism:
    """A regular prism about the z axis, one of its sides facing x; with a half angle, the frustum of a pyramid."""

    sides: int
    inradius_m: float
    """From the axis to the middle of a side, halfway along."""
    length_m: float
    half_angle_rad: float = 0.0
    """Positive where it widens along z."""


@dataclass(frozen=True)
class Stretched:
    """Another shape, scaled along the body's axes: an elliptic cylinder, a roof, an egg."""

    shape: Frustum | Sphere | Prism
    scale: tuple[float, float, float]


Shape = Frustum | Sphere | Plane | Box | Prism | Stretched
"""In body coordinates: a solid's middle is the origin and its axis is z."""


def first_hit(shape: Shape, origins_m: Floats, directions: Floats) -> Floats:
    """Ray parameters (N,) of the first surface in front of the origins; infinite where a ray misses.

    Origins and directions are (N, 3) or (3,), in body coordinates; directions need not be unit vectors.
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if isinstance(shape, Plane):
            return _positive(-origins_m[..., 2] / directions[..., 2])
        if isinstance(shape, Sphere):
            return _sphere_hit(shape, origins_m, directions)
        if isinstance(shape, Box | Prism):
            return _convex_hit(shape, origins_m, directions)
        if isinstance(shape, Stretched):
            # the parameter along a ray is the same before and after a linear map
            return first_hit(shape.shape, origins_m / shape.scale, directions / shape.scale)
        return np.minimum(_lateral_hit(shape, origins_m, directions), _cap_hit(shape, origins_m, directions))


def bounding_radius_m(shape: Shape) -> float:
    """Radius of a sphere about the origin that holds all of a shape, a little larger than need be."""
    if isinstance(shape, Plane):
        return float("inf")
    if isinstance(shape, Sphere):
        radius_m = shape.radius_m
    elif isinstance(shape, Box):
        radius_m = float(np.linalg.norm(shape.half_lengths_m))
    elif isinstance(shape, Prism):
        widest = shape.inradius_m + abs(np.tan(shape.half_angle_rad)) * shape.length_m / 2
        radius_m = float(np.hypot(widest / np.cos(np.pi / shape.sides), shape.length_m / 2))
    elif isinstance(shape, Stretched):
        radius_m = max(shape.scale) * bounding_radius_m(shape.shape)
    else:
        radius_m = float(np.hypot(shape.radius_at(np.array(shape.ends)).max(), shape.length_m / 2))
    return 1.001 * radius_m


def outward_normals(shape: Shape, points_m: Floats) -> Floats:
    """Unit normals (N, 3) at points (N, 3) of the surface, in body coordinates; a plane's is its z axis."""
    if isinstance(shape, Plane):
        return np.broadcast_to(np.array([0.0, 0.0, 1.0]), points_m.shape)
    if isinstance(shape, Sphere):
        return points_m / shape.radius_m
    if isinstance(shape, Box | Prism):
        faces, offset_m = _faces(shape)
        return faces[(points_m @ faces.T - offset_m).argmax(axis=-1)]
    if isinstance(shape, Stretched):
        normals = outward_normals(shape.shape, points_m / shape.scale) / shape.scale
        return normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    z = points_m[..., 2]
    on_cap = np.abs(np.abs(z) - shape.length_m / 2) < ON_CAP_M
    across = np.hypot(points_m[..., 0], points_m[..., 1])
    normals = points_m.copy()
    normals[..., 2] = -np.tan(shape.half_angle_rad) * across
    normals[on_cap] = np.stack([np.zeros_like(z), np.zeros_like(z), np.sign(z)], axis=-1)[on_cap]
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def _sphere_hit(ball: Sphere, origins_m: Floats, directions: Floats) -> Floats:
    near, far = _roots(
        (directions**2).sum(axis=-1),
        (origins_m * directions).sum(axis=-1),
        (origins_m**2).sum(axis=-1) - ball.radius_m**2,
    )
    return np.minimum(_positive(near), _positive(far))


def _lateral_hit(solid: Frustum, origins_m: Floats, directions: Floats) -> Floats:
    """The lateral surface x^2 + y^2 = (radius + slope z)^2 between the two ends."""
    slope = np.tan(solid.half_angle_rad)
    radius = solid.radius_m + slope * origins_m[..., 2]
    growth = slope * directions[..., 2]
    roots = _roots(
        directions[..., 0] ** 2 + directions[..., 1] ** 2 - growth**2,
        origins_m[..., 0] * directions[..., 0] + origins_m[..., 1] * directions[..., 1] - growth * radius,
        origins_m[..., 0] ** 2 + origins_m[..., 1] ** 2 - radius**2,
    )
    hit = np.inf
    for root in roots:
        within = np.abs(origins_m[..., 2] + root * directions[..., 2]) <= solid.length_m / 2
        # the quadratic also describes the mirrored cone beyond the apex, where the radius is negative
        hit = np.minimum(hit, _positive(root, within & (radius + root * growth >= 0)))
    return np.asarray(hit)


def _cap_hit(solid: Frustum, origins_m: Floats, directions: Floats) -> Floats:
    hit = np.inf
    for end_m in solid.ends:
        root = (end_m - origins_m[..., 2]) / directions[..., 2]
        x = origins_m[..., 0] + root * directions[..., 0]
        y = origins_m[..., 1] + root * directions[..., 1]
        hit = np.minimum(hit, _positive(root, x**2 + y**2 <= solid.radius_at(end_m) ** 2))
    return np.asarray(hit)


def _convex_hit(shape: Box | Prism, origins_m: Floats, directions: Floats) -> Floats:
    """The last of the faces that a ray goes in through, unless it has gone out through another before."""
    enter, leave, met = np.asarray(-np.inf), np.asarray(np.inf), np.asarray(True)
    for normal, offset_m in zip(*_faces(shape), strict=True):
        depth, speed = offset_m - origins_m @ normal, directions @ normal
        root = depth / speed
        enter = np.maximum(enter, np.where(speed < 0, root, -np.inf))
        leave = np.minimum(leave, np.where(speed > 0, root, np.inf))
        met = met & ((speed != 0) | (depth >= 0))
    met = met & (enter <= leave)
    return np.minimum(_positive(enter, met), _positive(leave, met))


def _faces(shape: Box | Prism) -> tuple[Floats, Floats]:
    """Unit normals (F, 3) and distances (F,) from the origin of the planes that bound a convex shape."""
    if isinstance(shape, Box):
        return np.concatenate([np.eye(3), -np.eye(3)]), np.tile(shape.half_lengths_m, 2)
    angle = 2 * np.pi * np.arange(shape.sides) / shape.sides
    lean = shape.half_angle_rad
    across, sines = np.cos(lean) * np.stack([np.cos(angle), np.sin(angle)], axis=1), np.full(shape.sides, -np.sin(lean))
    sides = np.concatenate([across, sines[:, None]], axis=1)
    ends = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    offset_m = np.concatenate([np.full(shape.sides, shape.inradius_m * np.cos(lean)), np.full(2, shape.length_m / 2)])
    return np.concatenate([sides, ends]), offset_m


def _roots(a: Floats, half_b: Floats, c: Floats) -> tuple[Floats, Floats]:
    """Both roots of a t^2 + 2 half_b t + c = 0 without cancellation; NaN where there is none."""
    q = -(half_b + np.copysign(np.sqrt(half_b**2 - a * c), half_b))
    return q / a, c / q


def _positive(root: Floats, allowed: Bools | bool = True) -> Floats:
    return np.where((root > 0) & allowed, root, np.inf)

"""What an arrangement is, and how bodies are put before a camera."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.camera import transform
from rotrecon.primitives import Frustum, Sphere, basis_across
from rotrecon.simulation.raycast import Box, Plane, Prism, Shape, Stretched

NEAREST_M, FARTHEST_M = 0.5, 1.2
"""Depth of a thing's middle: the working range of an arm's camera."""
CLOSEST_M = 0.25
"""Depth of the closest small thing: stereo cameras of arms see no nearer."""
FIELD = 0.5
"""Greatest extent of a thing over its depth: what a picture of common cameras holds."""
SMALLEST = 8.0
"""How many times smaller than that a thing may appear: an arm moves closer to what is smaller still."""
BEHIND_M = 0.25
"""Depth between the middle of a thing that stands free and the wall."""
AHEAD = np.array([0.0, 0.0, 1.0])
"""The direction in which the camera looks."""

Placed = tuple[Shape, Floats]
"""A shape and its pose (4, 4) in camera coordinates."""


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Bodies in camera coordinates, and what of them an operator has in mind."""

    placed: tuple[Placed, ...]
    stroke_m: Floats
    """(2, 3) the ends of the stroke."""
    outline_m: Floats
    """(N, 3) points that the area goes round."""
    bumps: tuple[float, float] | None = None
    """Of a surface that is not even: standard deviation, m, and scale, px."""
    kept_share: float = 1.0
    """Share of the picture that has depth."""
    scattered: bool = False
    """Whether depth is nothing but chance."""

    def __post_init__(self) -> None:
        freeze(self)


Maker = Callable[[np.random.Generator], Arrangement]


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """A size as likely to be small as large."""
    return low * (high / low) ** rng.random()


def ahead(rng: np.random.Generator, nearest_m: float = NEAREST_M, farthest_m: float = FARTHEST_M) -> Floats:
    """A place (3,) in the middle of the picture."""
    return np.array([0.0, 0.0, rng.uniform(nearest_m, farthest_m)])


def direction(rng: np.random.Generator, lean_deg: float, least_deg: float = 0.0) -> Floats:
    """A unit vector (3,) at any angle in the picture, leaning into its depth by so much at most and at least."""
    turn, lean = rng.uniform(0, 2 * np.pi), np.deg2rad(rng.uniform(least_deg, lean_deg)) * rng.choice([-1, 1])
    return np.array([np.cos(lean) * np.cos(turn), np.cos(lean) * np.sin(turn), np.sin(lean)])


def pose(middle_m: Floats, axis: Floats, roll_deg: float = 0.0) -> Floats:
    """A pose (4, 4) whose z is an axis, and whose y points toward the camera but for a roll about that axis."""
    roll = np.deg2rad(roll_deg)
    aside, toward = basis_across(axis, -middle_m)
    result = np.eye(4)
    x, y = np.cos(roll) * aside + np.sin(roll) * toward, np.cos(roll) * toward - np.sin(roll) * aside
    result[:3, :3] = np.stack([x, y, axis], axis=1)
    result[:3, 3] = middle_m
    return result


def moved(offset_m: Floats) -> Floats:
    """A pose (4, 4) that only moves."""
    result = np.eye(4)
    result[:3, 3] = offset_m
    return result


def plane(point_m: Floats, normal: Floats) -> Placed:
    """The plane through a point."""
    return Plane(), pose(point_m, normal)


def wall_at(depth_m: float, rng: np.random.Generator, lean_deg: float) -> Placed:
    """A wall straight ahead that leans any way, by so much at most."""
    lean, turn = np.deg2rad(rng.uniform(0, lean_deg)), rng.uniform(0, 2 * np.pi)
    normal = np.array([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), -np.cos(lean)])
    return plane(depth_m * AHEAD, normal)


def rod(middle_m: Floats, axis: Floats, radius_m: float, half_length_m: float = 0.3) -> Placed:
    """A piece of round bar."""
    return Frustum("cylinder", np.zeros(3), AHEAD, 2 * half_length_m, radius_m), pose(middle_m, axis)


def corners(shape: Shape, body: Floats) -> Floats:
    """The corners (8, 3), in camera coordinates, of a box round a placed shape."""
    return transform(body, np.array(list(product((-1, 1), repeat=3))) * _half_lengths(shape))


def standing(shape: Shape, body: Floats, rng: np.random.Generator) -> Arrangement:
    """One thing, free or with its back to a wall; the area goes round it, the stroke along its z."""
    outline = corners(shape, body)
    if rng.random() < 0.4:
        behind = plane(outline[outline[:, 2].argmax()], wall_at(1.0, rng, 20)[1][:3, 2])
    else:
        behind = wall_at(float(body[2, 3]) + BEHIND_M, rng, 30)
    half_length_m = rng.uniform(0.6, 0.95) * _half_lengths(shape)[2]
    stroke = body[:3, 3] + np.outer([-half_length_m, half_length_m], body[:3, 2])
    return Arrangement(((shape, body), behind), stroke, outline)


def before_camera(shape: Shape, rng: np.random.Generator, roll_deg: float, axis: Floats) -> Floats:
    """A pose (4, 4) with a given axis and roll in which the picture holds the shape."""
    closest_m = 2 * float(np.linalg.norm(_half_lengths(shape))) / FIELD
    depth_m = rng.uniform(max(closest_m, CLOSEST_M), max(closest_m, min(SMALLEST * closest_m, FARTHEST_M)))
    return pose(depth_m * np.array([*rng.uniform(-0.05, 0.05, 2), 1.0]), axis, roll_deg)


def along_or_across(
    placed: tuple[Placed, ...], middle_m: Floats, along: Floats, rng: np.random.Generator
) -> Arrangement:
    """A stroke near the middle of what is larger than the picture: along its edge, across it or between."""
    aside, _ = basis_across(along, -middle_m)
    turn = np.deg2rad(rng.choice([0.0, rng.uniform(-10, 10), 90.0, rng.uniform(0, 180)]))
    stroke, across = np.cos(turn) * along + np.sin(turn) * aside, np.cos(turn) * aside - np.sin(turn) * along
    reach_m, half_width_m = rng.uniform(0.05, 0.2), rng.uniform(0.02, 0.12)
    ends = middle_m + rng.normal(0, 0.01) * across + np.outer([-reach_m, reach_m], stroke)
    return Arrangement(placed, ends, np.concatenate([ends + s * half_width_m * across for s in (-1, 1)]))


def patch(surface: Placed, rng: np.random.Generator, scale: float = 1.0) -> Arrangement:
    """A piece of a plane that lies straight ahead, and a stroke on it."""
    _, body = surface
    along = transform(body, np.array([np.cos(turn := rng.uniform(0, 2 * np.pi)), np.sin(turn), 0.0])) - body[:3, 3]
    across = np.cross(along, body[:3, 2])
    half_length_m, half_width_m = scale * rng.uniform(0.05, 0.18), scale * rng.uniform(0.02, 0.1)
    ends = body[:3, 3] + np.outer([-half_length_m, half_length_m], along)
    return Arrangement((surface,), ends, np.concatenate([ends + s * half_width_m * across for s in (-1, 1)]))


def _half_lengths(shape: Shape) -> Floats:
    """Half lengths (3,) of the box round a shape that has an end."""
    if isinstance(shape, Stretched):
        return _half_lengths(shape.shape) * np.array(shape.scale)
    if isinstance(shape, Box):
        return np.array(shape.half_lengths_m)
    if isinstance(shape, Sphere):
        return np.full(3, shape.radius_m)
    if isinstance(shape, Prism):
        widest = shape.inradius_m + abs(np.tan(shape.half_angle_rad)) * shape.length_m / 2
        return np.array([*np.full(2, widest / np.cos(np.pi / shape.sides)), shape.length_m / 2])
    if isinstance(shape, Frustum):
        widest = float(shape.radius_at(np.array(shape.ends)).max())
        return np.array([widest, widest, shape.length_m / 2])
    raise ValueError("a plane has no corners")

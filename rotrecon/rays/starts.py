"""Where the robust loop starts: surfaces read off the segmented sections, without any fine measurement."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.compiled import MATRIX, VECTOR, compiled
from rotrecon.drawing import CrossSegments
from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.surfaces import turn_of

FEWEST_PIXELS = 3
"""A section with fewer has no middle and no width worth the name."""
ROBUST_ROUNDS = 8
"""Reweightings of a line or a circle: each halves what outliers pull, or better."""
STRAY = 4.0
"""Median distances from the middle beyond which a section shows something else."""
CONE_ANGLES_RAD = tuple(np.deg2rad([-40.0, -25.0, -10.0, 10.0, 25.0, 40.0]))
"""Half angles of cones to start from; nearer ones are found from any of them, or from the cylinder."""
CONE_ANGLE_HELD = 0.95
"""Cosine between a start's axis and a direction that is held, below which the start is of no use."""
SMALLEST_M = 1e-4
"""Radii and spreads below this are rounding."""
UNKNOWN = 1e-12
"""Of the strongest of several numbers' information, below which there is none."""


@dataclass(frozen=True, eq=False)
class Ridge:
    """What of the object lies nearest along the middles of its sections; camera coordinates, n sections."""

    points_m: Floats
    """(n, 3) in the order of the stroke."""
    width_m: Floats
    """(n,) from limb to limb, as far as it was segmented."""

    def __post_init__(self) -> None:
        freeze(self)


def ridge(camera: PinholeCamera, depth_m: Floats, segments: CrossSegments, kept: Bools) -> Ridge:
    """Middles and widths of the sections of the kept (S, W) pixels of known depth (S, W)."""
    rows = np.flatnonzero(kept.sum(axis=1) >= FEWEST_PIXELS)
    kept, depth_m = kept[rows], depth_m[rows]
    rank = kept.cumsum(axis=1)
    count = rank[:, -1:]
    low, middle, high = ((rank > share * (count - 1)).argmax(axis=1) for share in (0.02, 0.5, 0.98))
    width = (high - low) / 0.96 + 1
    half = np.maximum(0.1 * width, 1.0)[:, None]
    near = kept & (np.abs(np.arange(kept.shape[1], dtype=np.float64) - middle[:, None]) <= half)
    depth = medians(np.where(near, depth_m, np.inf), near.sum(axis=1))
    across = segments.first_offset_px + middle
    pixel = segments.origin_px + rows[:, None] * segments.along + across[:, None] * segments.across
    return Ridge(camera.unproject(pixel, depth), width * depth / camera.focal_px)


def medians(values: Floats, count: Indices) -> Floats:
    """Lower median (n,) of the `count` (n,) smallest values of each row (n, W), the others being infinite."""
    ordered = np.sort(values, axis=1)
    return ordered[np.arange(len(values)), np.maximum(count - 1, 0) // 2]


def cylinder_starts(edge: Ridge, points_m: Floats, direction: Floats | None, focal_px: float) -> list[Lateral]:
    """Cylinders from a ridge and the object's points (N, 3): by its width, and by the circle its sections lie on.

    `direction` (3,) is the axis' if it is known; else it is the ridge's own.
    """
    middle, along = robust_line(edge.points_m)
    if direction is not None:
        along = direction if direction @ along >= 0 else -direction
    turn = turn_of(along, -middle)
    radius = max(float(np.median(edge.width_m)) / 2, SMALLEST_M)
    starts = [Lateral(middle - radius * turn[1], turn, radius, 0.0, focal_px, tapers=False)]
    circle = robust_circle((points_m - middle) @ turn[:2].T)
    if circle is not None:
        (across, toward), circle_radius = circle
        center = middle + across * turn[0] + toward * turn[1]
        side = 1 if toward > 0 else -1
        starts.append(Lateral(center, turn_of(along, -center), circle_radius, 0.0, focal_px, tapers=False, side=side))
    return starts


def cone_starts(edge: Ridge, direction: Floats | None, focal_px: float) -> list[Lateral]:
    """Cones of which the ridge is a generator, as wide as it is, of several half angles."""
    middle, along = robust_line(edge.points_m)
    toward = turn_of(along, -middle)[1]
    radius = max(float(np.median(edge.width_m)) / 2, SMALLEST_M)
    starts: list[Lateral] = []
    for angle in CONE_ANGLES_RAD:
        axis = np.cos(angle) * along - np.sin(angle) * toward
        if direction is not None and abs(axis @ direction) < CONE_ANGLE_HELD:
            continue
        turn = turn_of(axis, -middle)
        starts.append(Lateral(middle - radius * turn[1], turn, radius, float(np.tan(angle)), focal_px, tapers=True))
    return starts


def ball_starts(edge: Ridge, points_m: Floats, focal_px: float) -> list[Ball]:
    """Balls from a ridge and the object's points (N, 3): by its greatest width, and through the points."""
    third = len(edge.points_m) // 3
    nearest = np.median(edge.points_m[third : len(edge.points_m) - third], axis=0)
    radius = max(float(np.percentile(edge.width_m, 95)) / 2, SMALLEST_M)
    starts = [Ball(nearest * (1 + radius / np.linalg.norm(nearest)), radius, focal_px)]
    sphere = robust_circle(points_m - nearest)
    if sphere is not None:
        center, sphere_radius = sphere
        side = 1 if center @ nearest < 0 else -1
        starts.append(Ball(nearest + center, sphere_radius, focal_px, side))
    return starts


def together(points_m: Floats) -> Floats:
    """The points (m, 3) among (n, 3) that are not far off all others: evenly along a line, none is twice as far from
    their middle as half of them."""
    distance = np.linalg.norm(points_m - np.median(points_m, axis=0), axis=1)
    return points_m[distance <= STRAY * np.median(distance)]


def robust_line(points_m: Floats) -> tuple[Floats, Floats]:
    """Middle (3,) and unit direction (3,), in the order of the points (n, 3), of the line through most of them."""
    # a single one far behind would draw the line to itself, whatever its weight
    points_m = together(points_m)
    middle, direction = _line_through(points_m)
    order = np.arange(len(points_m)) - (len(points_m) - 1) / 2
    return middle, direction if order @ (points_m @ direction) >= 0 else -direction


def robust_circle(points: Floats) -> tuple[Floats, float] | None:
    """Centre (d,) and radius of the circle or sphere through most of the points (N, d); None for a flat set.

    |p|^2 = 2 c p + (R^2 - |c|^2) is linear in the centre and in the bracket (Kasa 1976), reweighted by distance.
    """
    center, radius = _circle_through(np.ascontiguousarray(points))
    return (center, radius) if radius > SMALLEST_M else None


@compiled(VECTOR)
def _weights(distance: Floats) -> Floats:
    """Of points at distances (N,) from what most of them are on."""
    return 1.0 / (1.0 + (distance / max(np.median(distance), SMALLEST_M)) ** 2)


@compiled(MATRIX)
def _line_through(points: Floats) -> tuple[Floats, Floats]:
    """See `robust_line`; the direction may be either."""
    weight, distance = np.ones(len(points)), np.empty(len(points))
    middle, direction = np.zeros(3), np.zeros(3)
    for _ in range(ROBUST_ROUNDS):
        middle = (weight @ points) / weight.sum()
        scatter = np.zeros((3, 3))
        for i in range(len(points)):
            for j in range(3):
                share = weight[i] * (points[i, j] - middle[j])
                for k in range(3):
                    scatter[j, k] += share * (points[i, k] - middle[k])
        direction = np.linalg.eigh(scatter)[1][:, 2].copy()
        for i in range(len(points)):
            x, y, z = points[i, 0] - middle[0], points[i, 1] - middle[1], points[i, 2] - middle[2]
            along_x, along_y, along_z = direction
            aside = (y * along_z - z * along_y) ** 2 + (z * along_x - x * along_z) ** 2
            distance[i] = np.sqrt(aside + (x * along_y - y * along_x) ** 2)
        weight = _weights(distance)
    return middle, direction


@compiled(MATRIX, VECTOR, VECTOR)
def _least_squares(terms: Floats, values: Floats, weight: Floats) -> Floats:
    """The shortest of the best factors (k,) of terms (N, k) that add up to values (N,), by weight (N,)."""
    normal, pull = np.zeros((terms.shape[1], terms.shape[1])), np.zeros(terms.shape[1])
    for i in range(len(terms)):
        for j in range(terms.shape[1]):
            share = weight[i] * terms[i, j]
            pull[j] += share * values[i]
            for k in range(terms.shape[1]):
                normal[j, k] += share * terms[i, k]
    strength, along = np.linalg.eigh(normal)
    found = np.zeros(len(pull))
    for j in range(len(pull)):
        if abs(strength[j]) > UNKNOWN * np.abs(strength).max():
            found += (along[:, j] * pull).sum() / strength[j] * along[:, j]
    return found


@compiled(VECTOR)
def _square(vector: Floats) -> float:
    total = 0.0
    for value in vector:
        total += value * value
    return total


@compiled(MATRIX)
def _circle_through(points: Floats) -> tuple[Floats, float]:
    """See `robust_circle`; of a flat set the radius is no more than rounding."""
    count, axes = points.shape
    terms, squared = np.ones((count, axes + 1)), np.empty(count)
    terms[:, :axes] = 2 * points
    for i in range(count):
        squared[i] = _square(points[i])
    weight, distance = np.ones(count), np.empty(count)
    center, radius = np.zeros(axes), 0.0
    for _ in range(ROBUST_ROUNDS):
        solution = _least_squares(terms, squared, weight)
        center = solution[:axes]
        radius = float(np.sqrt(max(solution[axes] + _square(center), 0.0)))
        if not radius > SMALLEST_M:
            break
        for i in range(count):
            off = 0.0
            for j in range(axes):
                off += (points[i, j] - center[j]) ** 2
            distance[i] = abs(np.sqrt(off) - radius)
        weight = _weights(distance)
    return center, radius

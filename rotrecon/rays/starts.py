"""Where the robust loop starts: surfaces read off the segmented sections, without any fine measurement."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.camera import PinholeCamera
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
    weight = np.ones(len(points_m))
    middle, offset, direction = points_m.mean(axis=0), points_m, np.array([0.0, 1.0, 0.0])
    for _ in range(ROBUST_ROUNDS):
        middle = np.average(points_m, axis=0, weights=weight)
        offset = points_m - middle
        _, vectors = np.linalg.eigh((offset * weight[:, None]).T @ offset)
        direction = vectors[:, 2]
        distance = np.linalg.norm(np.cross(offset, direction), axis=1)
        weight = 1.0 / (1.0 + np.square(distance / max(float(np.median(distance)), SMALLEST_M)))
    order = np.arange(len(points_m)) - (len(points_m) - 1) / 2
    return middle, direction if order @ (offset @ direction) >= 0 else -direction


def robust_circle(points: Floats) -> tuple[Floats, float] | None:
    """Centre (d,) and radius of the circle or sphere through most of the points (N, d); None for a flat set.

    |p|^2 = 2 c p + (R^2 - |c|^2) is linear in the centre and in the bracket (Kasa 1976), reweighted by distance.
    """
    terms = np.concatenate([2 * points, np.ones((len(points), 1))], axis=1)
    squared = (points**2).sum(axis=1)
    weight = np.ones(len(points))
    center, radius = np.zeros(points.shape[1]), 0.0
    for _ in range(ROBUST_ROUNDS):
        weighted = terms * weight[:, None]
        solution: Floats = np.linalg.pinv(weighted.T @ terms, rcond=1e-12, hermitian=True) @ (weighted.T @ squared)
        center = solution[:-1]
        radius2 = float(solution[-1] + center @ center)
        if not radius2 > SMALLEST_M**2:
            return None
        radius = float(np.sqrt(radius2))
        distance = np.abs(np.linalg.norm(points - center, axis=1) - radius)
        weight = 1.0 / (1.0 + np.square(distance / max(float(np.median(distance)), SMALLEST_M)))
    return center, radius

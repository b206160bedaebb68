"""Where rays meet a cylinder or a cone, where they are nearest to it, and the derivatives of both, ray by ray.

In the surface's own coordinates, h along its axis, it is x^2 + y^2 = (radius + slope h)^2; the camera is at `origin`
(3,), and `turn` (3, 3) takes the camera's directions there. A point of a ray u = (x, y, h) at depth z is origin + z u.
"""

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.compiled import FLAG, FLOAT, MATRIX, VECTOR, compiled
from rotrecon.rays.traces import FLANK, Rays, root_of


@compiled(MATRIX, VECTOR, FLOAT, FLOAT, FLOAT, FLOAT, FLOAT)
def _quadratic(
    turn: Floats, origin: Floats, radius: float, slope: float, u: float, v: float, w: float
) -> tuple[float, float, float, float, float]:
    """A direction (x, y, h), and a and b of the quadratic a z^2 + 2 b z + c of its depths."""
    x = turn[0, 0] * u + turn[0, 1] * v + turn[0, 2] * w
    y = turn[1, 0] * u + turn[1, 1] * v + turn[1, 2] * w
    h = turn[2, 0] * u + turn[2, 1] * v + turn[2, 2] * w
    growth = slope * h
    a = x * x + y * y - growth * growth
    # a ray along a cone's flank meets it at infinity, one steeper than that from the other side
    if abs(a) < FLANK:
        a = FLANK
    return x, y, h, a, origin[0] * x + origin[1] * y - (radius + slope * origin[2]) * growth


@compiled(MATRIX, MATRIX, VECTOR, FLOAT, FLOAT, FLOAT, FLOAT)
def crossings(
    rays: Rays, turn: Floats, origin: Floats, radius: float, slope: float, side: float, grazing: float
) -> tuple[Floats, Floats, Floats, Bools]:
    """Points (3, N) where rays meet the surface, their depths, the roots of the discriminant, and what truly hits.

    `grazing` is the share of radius and distance that such a ray may miss its outline by.
    """
    count = rays.shape[1]
    points, depth, root = np.empty((3, count)), np.empty(count), np.empty(count)
    hit = np.empty(count, np.bool_)
    c = origin[0] ** 2 + origin[1] ** 2 - (radius + slope * origin[2]) ** 2
    for i in range(count):
        x, y, h, a, b = _quadratic(turn, origin, radius, slope, rays[0, i], rays[1, i], rays[2, i])
        grazed = grazing * abs(b * (radius + slope * (origin[2] - b / a * h)))
        z, root[i], hit[i] = root_of(a, b, c, side, grazed)
        depth[i] = z
        points[0, i], points[1, i], points[2, i] = origin[0] + z * x, origin[1] + z * y, origin[2] + z * h
    return points, depth, root, hit


@compiled(MATRIX, MATRIX, VECTOR, FLOAT, FLOAT)
def nearest(rays: Rays, turn: Floats, origin: Floats, radius: float, slope: float) -> tuple[Floats, Floats, Floats]:
    """Points (3, N) of rays nearest to the surface, the square of their distance from the axis, and their depth."""
    count = rays.shape[1]
    points, squared, depth = np.empty((3, count)), np.empty(count), np.empty(count)
    for i in range(count):
        x, y, h, a, b = _quadratic(turn, origin, radius, slope, rays[0, i], rays[1, i], rays[2, i])
        z = -b / a
        depth[i] = z
        x, y = origin[0] + z * x, origin[1] + z * y
        points[0, i], points[1, i], points[2, i] = x, y, origin[2] + z * h
        squared[i] = x * x + y * y
    return points, squared, depth


@compiled(MATRIX, FLOAT, FLOAT, FLAG)
def gradient(points: Floats, radius: float, slope: float, tapers: bool) -> Floats:
    """Derivatives (k, N) of (x^2 + y^2 - (radius + slope h)^2) / 2 at points (3, N), by the surface's parameters."""
    count = points.shape[1]
    found = np.empty((6 if tapers else 5, count))
    for i in range(count):
        x, y, h = points[0, i], points[1, i], points[2, i]
        there = radius + slope * h
        lever = h + slope * there
        found[0, i], found[1, i] = -x, -y
        found[2, i], found[3, i] = -x * lever, -y * lever
        found[4, i] = -there
        if tapers:
            found[5, i] = -there * h
    return found


@compiled(MATRIX, FLOAT, FLOAT)
def tilted(turn: Floats, aside: float, toward: float) -> Floats:
    """A rotation (3, 3) whose last row, the axis, is moved along its first two; they follow it the shortest way."""
    axis = turn[2] + aside * turn[0] + toward * turn[1]
    axis /= np.sqrt((axis * axis).sum())
    across = turn[0] - (turn[0] * axis).sum() * axis
    across /= np.sqrt((across * across).sum())
    found = np.empty((3, 3))
    found[0], found[1], found[2] = across, np.cross(axis, across), axis
    return found

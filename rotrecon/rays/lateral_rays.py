"""Where rays meet a cylinder or a cone, where they are nearest to it, and the derivatives of both, ray by ray.

In the surface's own coordinates, h along its axis, it is x^2 + y^2 = (radius + slope h)^2; the camera is at `origin`
(3,), and `turn` (3, 3) takes the camera's directions there. A point of a ray u = (x, y, h) at depth z is origin + z u.
"""

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.compiled import COUNT, FLOAT, MATRIX, VECTOR, compiled
from rotrecon.rays.traces import FLANK, Rays, root_of

SMALLEST_M = 1e-9
"""A radius is never less where a distance is counted in it."""


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


@compiled(MATRIX, VECTOR, FLOAT, FLOAT, FLOAT, FLOAT, FLOAT)
def _nearest(
    turn: Floats, origin: Floats, radius: float, slope: float, u: float, v: float, w: float
) -> tuple[float, float, float, float, float]:
    """The point (x, y, h) of a ray nearest to the surface, its depth, and the radius there."""
    x, y, h, a, b = _quadratic(turn, origin, radius, slope, u, v, w)
    z = -b / a
    height = origin[2] + z * h
    return origin[0] + z * x, origin[1] + z * y, height, z, radius + slope * height


@compiled(MATRIX, FLOAT, FLOAT, COUNT)
def _gradient(points: Floats, radius: float, slope: float, parameters: int) -> Floats:
    """Derivatives (k, N) of (x^2 + y^2 - (radius + slope h)^2) / 2 at points (3, N), by the surface's parameters."""
    count = points.shape[1]
    found = np.empty((parameters, count))
    for i in range(count):
        x, y, h = points[0, i], points[1, i], points[2, i]
        there = radius + slope * h
        lever = h + slope * there
        found[0, i], found[1, i] = -x, -y
        found[2, i], found[3, i] = -x * lever, -y * lever
        found[4, i] = -there
        if parameters > 5:
            found[5, i] = -there * h
    return found


@compiled(MATRIX, MATRIX, VECTOR, FLOAT, FLOAT, FLOAT, FLOAT)
def met(
    rays: Rays, turn: Floats, origin: Floats, radius: float, slope: float, side: float, grazing: float
) -> tuple[Floats, Bools]:
    """Depths (N,) where rays meet the surface, and which truly do.

    `grazing` is the share of radius and distance that such a ray may miss its outline by.
    """
    count = rays.shape[1]
    depth, hit = np.empty(count), np.empty(count, np.bool_)
    c = origin[0] ** 2 + origin[1] ** 2 - (radius + slope * origin[2]) ** 2
    for i in range(count):
        _, _, h, a, b = _quadratic(turn, origin, radius, slope, rays[0, i], rays[1, i], rays[2, i])
        grazed = grazing * abs(b * (radius + slope * (origin[2] - b / a * h)))
        depth[i], _, hit[i] = root_of(a, b, c, side, grazed)
    return depth, hit


@compiled(MATRIX, MATRIX, VECTOR, FLOAT, FLOAT, FLOAT, FLOAT, COUNT)
def traced(
    rays: Rays, turn: Floats, origin: Floats, radius: float, slope: float, side: float, grazing: float, parameters: int
) -> tuple[Floats, Floats, Floats, Bools]:
    """Derivatives (k, N) of the depths where rays meet the surface, as far as they have no common factor; those factors
    (N,), the depths, and what truly hits."""
    count = rays.shape[1]
    points, scale, depth = np.empty((3, count)), np.empty(count), np.empty(count)
    hit = np.empty(count, np.bool_)
    c = origin[0] ** 2 + origin[1] ** 2 - (radius + slope * origin[2]) ** 2
    for i in range(count):
        x, y, h, a, b = _quadratic(turn, origin, radius, slope, rays[0, i], rays[1, i], rays[2, i])
        grazed = grazing * abs(b * (radius + slope * (origin[2] - b / a * h)))
        z, root, hit[i] = root_of(a, b, c, side, grazed)
        depth[i], scale[i] = z, -side / root
        points[0, i], points[1, i], points[2, i] = origin[0] + z * x, origin[1] + z * y, origin[2] + z * h
    return _gradient(points, radius, slope, parameters), scale, depth, hit


@compiled(MATRIX, MATRIX, VECTOR, FLOAT, FLOAT)
def passed(rays: Rays, turn: Floats, origin: Floats, radius: float, slope: float) -> tuple[Floats, Floats]:
    """How far (N,) rays pass outside the surface, and the depths of their points nearest to it."""
    count = rays.shape[1]
    gap, depth = np.empty(count), np.empty(count)
    for i in range(count):
        x, y, _, depth[i], there = _nearest(turn, origin, radius, slope, rays[0, i], rays[1, i], rays[2, i])
        gap[i] = (x * x + y * y - there * there) / (2 * there)
    return gap, depth


@compiled(MATRIX, MATRIX, VECTOR, FLOAT, FLOAT, COUNT)
def grazed(
    rays: Rays, turn: Floats, origin: Floats, radius: float, slope: float, parameters: int
) -> tuple[Floats, Floats, Floats, Floats]:
    """Derivatives (k, N) of what `passed` tells, as far as they have no common factor; those factors (N,); and that."""
    count = rays.shape[1]
    points, scale, gap, depth = np.empty((3, count)), np.empty(count), np.empty(count), np.empty(count)
    for i in range(count):
        x, y, h, depth[i], there = _nearest(turn, origin, radius, slope, rays[0, i], rays[1, i], rays[2, i])
        points[0, i], points[1, i], points[2, i] = x, y, h
        scale[i], gap[i] = 1.0 / there, (x * x + y * y - there * there) / (2 * there)
    return _gradient(points, radius, slope, parameters), scale, gap, depth


@compiled(MATRIX, MATRIX, VECTOR, FLOAT, FLOAT)
def asides(rays: Rays, turn: Floats, origin: Floats, radius: float, slope: float) -> Floats:
    """How far (N,) beside the axis rays pass, over the radius there."""
    aside = np.empty(rays.shape[1])
    for i in range(len(aside)):
        x, y, _, _, there = _nearest(turn, origin, radius, slope, rays[0, i], rays[1, i], rays[2, i])
        aside[i] = np.sqrt(x * x + y * y) / max(there, SMALLEST_M)
    return aside


@compiled(MATRIX, FLOAT, FLOAT)
def tilted(turn: Floats, aside: float, toward: float) -> Floats:
    """A rotation (3, 3) whose last row, the axis, is moved along its first two; they follow it the shortest way."""
    found = np.empty((3, 3))
    across, between, axis = found
    size, along = 0.0, 0.0
    for j in range(3):
        axis[j] = turn[2, j] + aside * turn[0, j] + toward * turn[1, j]
        size += axis[j] * axis[j]
    for j in range(3):
        axis[j] /= np.sqrt(size)
        along += turn[0, j] * axis[j]
    size = 0.0
    for j in range(3):
        across[j] = turn[0, j] - along * axis[j]
        size += across[j] * across[j]
    for j in range(3):
        across[j] /= np.sqrt(size)
    for j in range(3):
        k, m = (j + 1) % 3, (j + 2) % 3
        between[j] = axis[k] * across[m] - axis[m] * across[k]
    return found

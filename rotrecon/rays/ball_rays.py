"""Where rays meet a ball, and where they are nearest to its centre, ray by ray.

Points of a ray u = (x, y, 1) at depth z are z u - center, as seen from the centre; on the ball their square is that of
the radius.
"""

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.compiled import FLOAT, MATRIX, VECTOR, compiled
from rotrecon.rays.traces import Rays, root_of


@compiled(MATRIX, VECTOR, FLOAT, FLOAT, FLOAT)
def crossings(
    rays: Rays, center: Floats, radius: float, side: float, grazing: float
) -> tuple[Floats, Floats, Floats, Bools]:
    """Points (3, N) where rays meet the ball, their depths, the roots of the discriminant, and what truly hits.

    `grazing` is the share of radius and distance that such a ray may miss its outline by.
    """
    count = rays.shape[1]
    points, depth, root = np.empty((3, count)), np.empty(count), np.empty(count)
    hit = np.empty(count, np.bool_)
    c = center[0] ** 2 + center[1] ** 2 + center[2] ** 2 - radius**2
    for i in range(count):
        x, y, w = rays[0, i], rays[1, i], rays[2, i]
        a, b = x * x + y * y + w * w, -(center[0] * x + center[1] * y + center[2] * w)
        z, root[i], hit[i] = root_of(a, b, c, side, grazing * radius * abs(b))
        depth[i] = z
        points[0, i], points[1, i], points[2, i] = z * x - center[0], z * y - center[1], z * w - center[2]
    return points, depth, root, hit


@compiled(MATRIX, VECTOR)
def nearest(rays: Rays, center: Floats) -> tuple[Floats, Floats, Floats]:
    """Points (3, N) of rays nearest to the centre, the square of their distance from it, and their depth."""
    count = rays.shape[1]
    points, squared, depth = np.empty((3, count)), np.empty(count), np.empty(count)
    for i in range(count):
        x, y, w = rays[0, i], rays[1, i], rays[2, i]
        z = (center[0] * x + center[1] * y + center[2] * w) / (x * x + y * y + w * w)
        depth[i] = z
        x, y, w = z * x - center[0], z * y - center[1], z * w - center[2]
        points[0, i], points[1, i], points[2, i] = x, y, w
        squared[i] = x * x + y * y + w * w
    return points, squared, depth

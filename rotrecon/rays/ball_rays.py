"""Where rays meet a ball, and where they are nearest to its centre, ray by ray.

Points of a ray u = (x, y, 1) at depth z are z u - center, as seen from the centre; on the ball their square is that of
the radius.
"""

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.compiled import FLOAT, MATRIX, VECTOR, compiled
from rotrecon.rays.traces import Rays, root_of


@compiled(VECTOR, FLOAT)
def _constant(center: Floats, radius: float) -> float:
    """c of the quadratic a z^2 + 2 b z + c of depths, the same for all rays."""
    return center[0] ** 2 + center[1] ** 2 + center[2] ** 2 - radius**2


@compiled(MATRIX, VECTOR, FLOAT, FLOAT, FLOAT)
def met(rays: Rays, center: Floats, radius: float, side: float, grazing: float) -> tuple[Floats, Bools]:
    """Depths (N,) where rays meet the ball, and which truly do.

    `grazing` is the share of radius and distance that such a ray may miss its outline by.
    """
    count, c = rays.shape[1], _constant(center, radius)
    depth, hit = np.empty(count), np.empty(count, np.bool_)
    for i in range(count):
        x, y, w = rays[0, i], rays[1, i], rays[2, i]
        a, b = x * x + y * y + w * w, -(center[0] * x + center[1] * y + center[2] * w)
        depth[i], _, hit[i] = root_of(a, b, c, side, grazing * radius * abs(b))
    return depth, hit


@compiled(MATRIX, VECTOR, FLOAT, FLOAT, FLOAT)
def traced(
    rays: Rays, center: Floats, radius: float, side: float, grazing: float
) -> tuple[Floats, Floats, Floats, Bools]:
    """Derivatives (4, N) of the depths where rays meet the ball, as far as they have no common factor; those factors
    (N,), the depths, and what truly hits."""
    count, c = rays.shape[1], _constant(center, radius)
    columns, scale, depth = np.empty((4, count)), np.empty(count), np.empty(count)
    hit = np.empty(count, np.bool_)
    for i in range(count):
        x, y, w = rays[0, i], rays[1, i], rays[2, i]
        a, b = x * x + y * y + w * w, -(center[0] * x + center[1] * y + center[2] * w)
        z, root, hit[i] = root_of(a, b, c, side, grazing * radius * abs(b))
        depth[i], scale[i] = z, -side / root
        columns[0, i], columns[1, i], columns[2, i] = center[0] - z * x, center[1] - z * y, center[2] - z * w
        columns[3, i] = -radius
    return columns, scale, depth, hit


@compiled(MATRIX, VECTOR, FLOAT)
def grazed(rays: Rays, center: Floats, radius: float) -> tuple[Floats, Floats, Floats]:
    """Derivatives (4, N) of how far rays pass outside the ball, times its radius; that, and the depth nearest to it."""
    count = rays.shape[1]
    columns, gap, depth = np.empty((4, count)), np.empty(count), np.empty(count)
    for i in range(count):
        x, y, w = rays[0, i], rays[1, i], rays[2, i]
        z = (center[0] * x + center[1] * y + center[2] * w) / (x * x + y * y + w * w)
        depth[i] = z
        x, y, w = z * x - center[0], z * y - center[1], z * w - center[2]
        columns[0, i], columns[1, i], columns[2, i], columns[3, i] = -x, -y, -w, -radius
        gap[i] = (x * x + y * y + w * w - radius * radius) / (2 * radius)
    return columns, gap, depth

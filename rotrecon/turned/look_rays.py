"""Where rays meet cones, one each, and the median of what looks at each height: ray by ray."""

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices
from rotrecon.compiled import COUNT, FLOAT, MATRIX, NUMBA, VECTOR, compiled
from rotrecon.rays.traces import FLANK, root_of

PLACES = NUMBA.types.Array(NUMBA.int32, 1, "C", readonly=True)


@compiled(VECTOR, MATRIX, MATRIX, FLOAT, FLOAT, FLOAT)
def met_cones(
    origin: Floats, turned: Floats, rows: Floats, side: float, grazing: float, outer: float
) -> tuple[Floats, Floats, Floats, Bools]:
    """Derivatives (5, N) of half of x^2 + y^2 - r(h)^2 by an axis' four parameters and the radius, where rays meet.

    `origin` (3,) and `turned` (3, N) are those of `Lines`, `rows` (5, N) holds their squares and mixed products, and
    the height, radius and slope of each ray's cone. With the depths, the roots of the discriminants, and which rays
    pass so far beside the axis that the discriminant is less than a share `outer` of what it is in the middle. Rays
    that miss, or graze by a share of radius and distance, are continued as those of `Lateral`.
    """
    count = turned.shape[1]
    columns, depth, root, beside = np.empty((5, count)), np.empty(count), np.empty(count), np.empty(count, np.bool_)
    for i in range(count):
        square, mixed, height, radius, slope = rows[0, i], rows[1, i], rows[2, i], rows[3, i], rows[4, i]
        at_origin, growth = radius + slope * (origin[2] - height), slope * turned[2, i]
        a, b = square - growth * growth, mixed - at_origin * growth
        if abs(a) < FLANK:
            a = FLANK
        nearest = radius + slope * (origin[2] - b / a * turned[2, i] - height)
        c = origin[0] ** 2 + origin[1] ** 2 - at_origin * at_origin
        z, root[i], _ = root_of(a, b, c, side, grazing * abs(nearest * b))
        depth[i], beside[i] = z, root[i] ** 2 < outer * abs(a) * radius**2
        x, y = origin[0] + z * turned[0, i], origin[1] + z * turned[1, i]
        lever = height + slope * radius
        columns[0, i], columns[1, i], columns[2, i], columns[3, i] = -x, -y, -x * lever, -y * lever
        columns[4, i] = -radius
    return columns, depth, root, beside


@compiled(VECTOR, PLACES, COUNT, COUNT)
def grouped_medians(values: Floats, place: Indices, count: int, fewest: int) -> Floats:
    """(count,) medians of values (N,) by their place (N,); NaN where there are fewer than so many."""
    ends = np.zeros(count + 1, np.int64)
    for i in range(len(place)):
        ends[place[i] + 1] += 1
    ends = np.cumsum(ends)
    ordered, filled = np.empty(len(values)), ends[:-1].copy()
    for i in range(len(values)):
        ordered[filled[place[i]]] = values[i]
        filled[place[i]] += 1
    found = np.full(count, np.nan)
    for group in range(count):
        if ends[group + 1] - ends[group] >= max(fewest, 1):
            found[group] = np.median(ordered[ends[group] : ends[group + 1]])
    return found

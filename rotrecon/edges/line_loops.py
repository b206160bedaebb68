"""Edges across an outline, and the lines that go through them: point by point, and line by line."""

import numpy as np

from rotrecon.arrays import Cloud, Floats
from rotrecon.compiled import COUNT, FLOAT, MATRIX, NUMBA, VECTOR, compiled

STEP_PX = 0.5
"""Distance of the samples along a normal, and of the lines tried; each is then moved onto its own edges."""
LEAST_GRADIENT = 1.0
"""Grey levels a pixel: the noise of a plain surface, averaged like this, stays below."""
NEAR_PX = 0.6
"""Standard deviation of an edge from a line it counts for: half a step of the lines, and the spread of the edges."""
BEND_PRIOR = 0.02
"""Weight of no bend against all votes, where lines are moved onto edges."""
UNHELD = 1e-9
"""Weight of no shift and no tilt, so that a line without edges is one still."""
SAME_STEP = 1e-9
"""Difference of two steps that is rounding."""
COLOURS = NUMBA.types.Array(NUMBA.float32, 3, "C", readonly=True)


@compiled(MATRIX, MATRIX, VECTOR)
def samples_at(point_px: Floats, normal_px: Floats, across_px: Floats) -> tuple[Cloud, Cloud]:
    """u and v (N, T) at distances (T,) along the normals (N, 2) from points (N, 2)."""
    u = np.empty((len(point_px), len(across_px)), np.float32)
    v = np.empty_like(u)
    for n in range(len(point_px)):
        for t in range(len(across_px)):
            u[n, t] = point_px[n, 0] + across_px[t] * normal_px[n, 0]
            v[n, t] = point_px[n, 1] + across_px[t] * normal_px[n, 1]
    return u, v


@compiled(COLOURS, VECTOR, VECTOR)
def steepest(change: Cloud, across_px: Floats, least_px: Floats) -> tuple[Floats, Floats]:
    """Places and shares (N, T - 2), as votes have them, of a picture's slopes (N, T, 3) no farther in than (N,)."""
    count, samples, _ = change.shape
    place, share = np.empty((count, samples - 2)), np.zeros((count, samples - 2))
    strength = np.empty(samples, np.float32)
    for n in range(count):
        for t in range(samples):
            red, green, blue = change[n, t]
            strength[t] = np.sqrt(red * red + green * green + blue * blue)
        strongest = np.float32(LEAST_GRADIENT)
        for t in range(1, samples - 1):
            before, here, after = strength[t - 1], strength[t], strength[t + 1]
            curved = max(here + here - before - after, np.float32(1e-12))
            away = (after - before) / (curved + curved)
            place[n, t - 1] = across_px[t] + STEP_PX * min(max(away, -0.5), 0.5)
            if here >= before and here > after and here > LEAST_GRADIENT and across_px[t] >= least_px[n]:
                share[n, t - 1] = here
                strongest = max(strongest, here)
        for t in range(samples - 2):
            share[n, t] = np.float32(share[n, t]) / strongest
    return place, share


@compiled(VECTOR, COUNT, NUMBA.float64[::1])
def _add_from(line: Floats, first: int, total: Floats) -> None:
    """Add to totals (A,) what a line (T,), and zeros beyond its ends, hold from a place on."""
    low, high = max(-first, 0), min(len(total), len(line) - first)
    if high > low:
        held, here = line[first + low : first + high], total[low:high]
        for i in range(high - low):
            here[i] += held[i]


@compiled(MATRIX, VECTOR, MATRIX)
def support_of(share: Floats, shift: Floats, places: Floats) -> Floats:
    """Support (A, B) of lines at places (B, R), in steps, moved by shifts (A,); edges are where `share` (R, T) says."""
    rows, last = share.shape[0], share.shape[1] - 1
    near = share.copy()
    for step in range(1, round(2 * NEAR_PX / STEP_PX) + 1):
        fade = np.exp(-0.5 * (step * STEP_PX / NEAR_PX) ** 2)
        for row in range(rows):
            for t in range(last + 1 - step):
                near[row, t + step] = max(near[row, t + step], fade * share[row, t])
                near[row, t] = max(near[row, t], fade * share[row, t + step])
    near[:, 0], near[:, last] = 0.0, 0.0
    # shifts that are a step apart are rounded alike
    alike = len(shift) > 1 and abs(shift[1] - shift[0] - 1.0) < SAME_STEP
    mean = np.empty((len(shift), len(places)))
    for b in range(len(places)):
        total = np.zeros(len(shift))
        for row in range(rows):
            if alike:
                _add_from(near[row], int(np.rint(shift[0] + places[b, row])), total)
            else:
                for a in range(len(shift)):
                    total[a] += near[row, min(max(int(np.rint(shift[a] + places[b, row])), 0), last)]
        mean[:, b] = total / rows
    return mean


@compiled(MATRIX, VECTOR, VECTOR, FLOAT, FLOAT)
def smooth_line(shapes: Floats, weight: Floats, place: Floats, held: float, unbent: float) -> Floats:
    """The line (N,) of shapes (N, 3) nearest to places (N,), by weight (N,), and prior weights of no line, no bend."""
    weighted = shapes.T * weight
    normal = weighted @ shapes
    for i in range(3):
        normal[i, i] += held if i < 2 else unbent
    return shapes @ np.linalg.solve(normal, weighted @ place)


@compiled(VECTOR, MATRIX, MATRIX, MATRIX, VECTOR)
def onto_edges(across_px: Floats, place_px: Floats, share: Floats, shapes: Floats, start_px: Floats) -> Floats:
    """A line (N,) moved, by least squares, onto the edges beside it."""
    line, off, weight = start_px.copy(), np.empty(len(start_px)), np.empty(len(start_px))
    for near in (1.5, 1.0):
        for n in range(len(line)):
            best = 0
            weight[n] = 0.0
            for t in range(len(across_px)):
                if abs(across_px[t] - line[n]) < near and share[n, t] > weight[n]:
                    best, weight[n] = t, share[n, t]
            off[n] = place_px[n, best] - line[n]
        line += smooth_line(shapes, weight, off, UNHELD, BEND_PRIOR * len(line))
    return line

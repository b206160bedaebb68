"""Planes in an organised cloud: what an object stands on or hangs before.

A plane n . P = h is linear in pixels when depth is inverted, 1 / z = (n . ray) / h, and a stereo camera errs in 1 / z
by the same amount everywhere: so it is a plane there too, and the one of least squares.
"""

from typing import cast

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.camera import PinholeCamera

TRIPLES = 150
"""Planes tried through three random pixels: one through a fifth of them is met with a chance of 70 %, one through a
third with 99.6 %."""
JUDGES = 1500
"""Pixels that choose among them: their share is known to 1 %."""
REFITS = 3
"""Least squares over what lies on the plane, repeated until hardly a pixel changes sides."""
FEWEST_PIXELS = 30
"""Fewer do not hold a plane against noise."""
SLENDER = 1e-3
"""Area of a triple's triangle over that of all pixels below which its plane is not determined."""


def planes_through(pixels: Floats, inverse_depth: Floats, tolerance: Floats, least: int, most: int) -> list[Floats]:
    """The planes that most pixels lie on, one after the other, each taking its pixels away from the next.

    `pixels` (n, 2), `inverse_depth` and its `tolerance` (n,), 1/m. At most `most` planes of at least `least` pixels,
    each (3,): 1 / z = p[0] u + p[1] v + p[2]. The same for the same pixels: chance is seeded.
    """
    rng = np.random.default_rng(0)
    terms = np.column_stack([pixels, np.ones(len(pixels))])
    left = np.ones(len(pixels), dtype=bool)
    found: list[Floats] = []
    while len(found) < most and left.sum() >= max(least, FEWEST_PIXELS):
        plane = _most_voted(terms[left], inverse_depth[left], tolerance[left], rng)
        if plane is None:
            break
        on = left & (np.abs(terms @ plane - inverse_depth) < tolerance)
        if on.sum() < max(least, FEWEST_PIXELS):
            break
        found.append(plane)
        left &= ~on
    return found


def off_plane(plane: Floats, pixels: Floats, inverse_depth: Floats) -> Floats:
    """How much larger (n,) an inverse depth is than that of a plane at pixels (n, 2), 1/m: positive in front of it."""
    return inverse_depth - pixels @ plane[:2] - plane[2]


def refined(plane: Floats, pixels: Floats, inverse_depth: Floats, tolerance: Floats) -> tuple[Floats, Bools]:
    """The plane of least squares through all pixels (n, 2) on a plane, and which pixels (n,) lie on it."""
    terms = np.column_stack([pixels, np.ones(len(pixels))])
    on = np.abs(terms @ plane - inverse_depth) < tolerance
    for _ in range(REFITS):
        if on.sum() < FEWEST_PIXELS:
            break
        weight = 1.0 / tolerance[on]
        plane = least_squares(terms[on] * weight[:, None], inverse_depth[on] * weight)
        on = np.abs(terms @ plane - inverse_depth) < tolerance
    return plane, on


def normal_of(plane: Floats, camera: PinholeCamera) -> Floats:
    """Unit normal (3,) of a plane, in camera coordinates, away from the camera."""
    # 1 / z = p . (u, v, 1) and (u, v, 1) = K ray
    normal = camera.K.T @ plane
    return normal / np.linalg.norm(normal)


def least_squares(terms: Floats, values: Floats) -> Floats:
    """Coefficients (m,) with which terms (n, m) come nearest to values (n,); terms may be of any size."""
    scale = np.abs(terms).max(axis=0)
    solution, *_ = cast(tuple[Floats, ...], np.linalg.lstsq(terms / scale, values, rcond=None))
    return solution / scale


def _most_voted(terms: Floats, inverse_depth: Floats, tolerance: Floats, rng: np.random.Generator) -> Floats | None:
    """The plane through three of n pixels that the others lie closest to, refined on those that lie on it."""
    judge = rng.integers(0, len(terms), min(JUDGES, len(terms)))
    terms, inverse_depth, tolerance = terms[judge], inverse_depth[judge], tolerance[judge]
    triple = rng.integers(0, len(terms), (TRIPLES, 3))
    corners = terms[triple]
    spread = np.ptp(terms[:, :2], axis=0).prod()
    held = np.abs(np.linalg.det(corners)) > SLENDER * spread
    if not held.any():
        return None
    solutions = np.linalg.solve(corners[held], inverse_depth[triple[held]][..., None])
    planes = np.asarray(solutions, dtype=np.float64)[..., 0]
    off = np.minimum(np.square((planes @ terms.T - inverse_depth) / tolerance), 1.0).sum(axis=1)
    return refined(planes[off.argmin()], terms[:, :2], inverse_depth, tolerance)[0]

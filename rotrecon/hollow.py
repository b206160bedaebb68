"""Which way a pipe runs that is seen from inside: there a camera is near the axis, and sees symmetry everywhere."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera
from rotrecon.foreground import Foreground, places_of
from rotrecon.planes import least_squares, normal_of

CELL_PX = 12
"""Side of the squares whose normals are taken: wide enough for noise, flat enough on any pipe that fits a picture."""
FILLED_SHARE = 0.6
"""Share of a square that depth must fill for its normal to be trusted."""
FEWEST_NORMALS = 6
"""Fewer do not show what direction none of them has."""
ROUNDS = 10
"""Of reweighting: the ends of a pipe and what lies in it count for little by then."""
ROUNDING = 1e-9
"""Sine of an angle that is none."""
AHEAD = 0.01
"""Share of the depth by which a place is moved along the direction: far above rounding, far below the curve of a
projected line."""


def runs_along(found: Foreground, camera: PinholeCamera) -> Floats | None:
    """Direction (2,) in the frame, at the object's middle, of the straight lines on its surface; None if unknown.

    In space it is the one that most of the surface's normals are perpendicular to.
    """
    places = places_of(found.mask)
    pixels, inverse_depth = found.patch.frame_px(places), found.patch.inverse_depth[found.mask]
    terms = np.column_stack([pixels, np.ones(len(pixels))])
    column, row = (places // CELL_PX).astype(int).T
    _, cell, count = np.unique(row * found.mask.shape[1] + column, return_inverse=True, return_counts=True)
    normals = [
        normal_of(least_squares(terms[cell == number], inverse_depth[cell == number]), camera)
        for number in np.flatnonzero(count >= FILLED_SHARE * CELL_PX**2)
    ]
    if len(normals) < FEWEST_NORMALS:
        return None
    direction = _square_to_most(np.array(normals))
    middle_m = camera.unproject(pixels.mean(axis=0), 1 / np.median(inverse_depth))
    here, ahead = camera.project(np.array([middle_m, middle_m + AHEAD * middle_m[2] * direction]))
    return (ahead - here) / np.linalg.norm(ahead - here)


def _square_to_most(normals: Floats) -> Floats:
    """The direction (3,) that most of the normals (n, 3) are perpendicular to: least squares, reweighted."""
    direction = np.linalg.eigh(normals.T @ normals)[1][:, 0]
    for _ in range(ROUNDS):
        off = np.abs(normals @ direction)
        weight = 1.0 / (1.0 + np.square(off / max(float(np.median(off)), ROUNDING)))
        direction = np.linalg.eigh((normals * weight[:, None]).T @ normals)[1][:, 0]
    return direction

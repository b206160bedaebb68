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
AHEAD = 0.01
"""Share of the depth by which a place is moved along the direction: far above rounding, far below the curve of a
projected line."""


def runs_along(found: Foreground, camera: PinholeCamera) -> Floats | None:
    """Direction (2,) in the frame, at the object's middle, of the straight lines on its surface; None if unknown.

    In space it is the one that the surface's normals are most nearly perpendicular to.
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
    direction = np.linalg.eigh(np.array(normals).T @ np.array(normals))[1][:, 0]
    middle_m = camera.unproject(pixels.mean(axis=0), 1 / np.median(inverse_depth))
    here, ahead = camera.project(np.array([middle_m, middle_m + AHEAD * middle_m[2] * direction]))
    return (ahead - here) / np.linalg.norm(ahead - here)

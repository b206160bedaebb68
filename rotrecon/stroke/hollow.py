"""The line along a pipe that is seen from inside: there a camera is near the axis, and sees symmetry everywhere."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera
from rotrecon.primitives import basis_across
from rotrecon.stroke.foreground import Foreground, places_of
from rotrecon.stroke.planes import least_squares, normal_of
from rotrecon.stroke.stroke_ends import SPAN

CELL_PX = 12
"""Side of the squares whose normals are taken: wide enough for noise, flat enough on any pipe that fits a picture."""
FILLED_SHARE = 0.6
"""Share of a square that depth must fill for its normal to be trusted."""
FEWEST_NORMALS = 6
"""Fewer do not show what direction none of them has."""
MIDDLE_SHARE = 0.05
"""Share of the visible arc, to each side of its middle, whose pixels are on the middle line."""
AHEAD = 0.01
"""Share of the depth by which a place is moved along the direction: far above rounding, far below the curve of a
projected line."""


def straight_line(found: Foreground, camera: PinholeCamera) -> tuple[Floats, Floats] | None:
    """A place (2,) in the frame on the middle one of the straight lines on the object, and its direction (2,).

    In space it is the direction that the surface's normals are most nearly perpendicular to. None if too little of
    the surface is seen.
    """
    pixels, inverse_depth = found.patch.frame_px(places_of(found.mask)), found.patch.inverse_depth[found.mask]
    normals = _normals(found, camera)
    if len(normals) < FEWEST_NORMALS:
        return None
    direction = np.linalg.eigh(normals.T @ normals)[1][:, 0]
    rays = camera.unproject(pixels, np.ones(len(pixels)))
    aside, toward = basis_across(direction, rays.mean(axis=0))
    round_rad = np.arctan2(rays @ aside, rays @ toward)
    low, high = np.quantile(round_rad, SPAN)
    middle = np.abs(round_rad - (low + high) / 2) <= MIDDLE_SHARE * (high - low)
    if not middle.any():
        return None
    here_m = camera.unproject(pixels[middle].mean(axis=0), 1 / np.median(inverse_depth[middle]))
    here, ahead = camera.project(np.array([here_m, here_m + AHEAD * here_m[2] * direction]))
    return here, (ahead - here) / np.linalg.norm(ahead - here)


def _normals(found: Foreground, camera: PinholeCamera) -> Floats:
    """Unit normals (n, 3) of squares of the object's surface."""
    places, inverse_depth = places_of(found.mask), found.patch.inverse_depth[found.mask]
    terms = np.column_stack([found.patch.frame_px(places), np.ones(len(places))])
    column, row = (places // CELL_PX).astype(int).T
    _, cell, count = np.unique(row * found.mask.shape[1] + column, return_inverse=True, return_counts=True)
    filled = np.flatnonzero(count >= FILLED_SHARE * CELL_PX**2)
    planes = [least_squares(terms[cell == number], inverse_depth[cell == number]) for number in filled]
    return np.array([normal_of(plane, camera) for plane in planes]).reshape(-1, 3)

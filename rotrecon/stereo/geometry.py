"""Whether two poses can make a pair, from what is known of cameras and poses alone."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import inverse, transform
from rotrecon.frame import View
from rotrecon.stereo.canvas import corners, whole
from rotrecon.stereo.limits import Limits
from rotrecon.stereo.rectification import Rectification, rectify

SMALLEST_BASELINE_M = 1e-3
"""Poses of an arm are known to some tenths of a millimetre: a shorter way between cameras is not known at all."""
TURNED_RAD = float(np.deg2rad(0.5))
"""Smaller turns are the arm's own error."""
MOST_ALONG_SIGHT = 0.75
"""Share of the way that may go along the line of sight: beyond about 50 degrees the pictures differ in scale."""
LEAST_DEPTH_RATIO = 0.35
"""Pixels that the common planes see under more than about 70 degrees are smeared."""
LEAST_OVERLAP = 0.2
"""Share of the reference's pixels that the other view must see, at the depth where it sees most."""
GRID = 9
"""Pixels and depths a side that overlap is tried with."""
TRIED_M = (0.2, 10.0)
"""Depths that it is tried with where the arm has no limits: what cameras on arms look at."""


def pair_of(views: tuple[View, ...], number: int, limits: Limits) -> Rectification | str:
    """The reference and one other view rectified; or why their poses make no pair, and what to do."""
    reference, other = views[0], views[number]
    T_reference_other = inverse(reference.T_base_camera) @ other.T_base_camera
    baseline_m = float(np.linalg.norm(T_reference_other[:3, 3]))
    if baseline_m < SMALLEST_BASELINE_M:
        turned = np.arccos(np.clip((np.trace(T_reference_other[:3, :3]) - 1) / 2, -1, 1)) > TURNED_RAD
        how = "is only turned from that of view 1" if turned else "equals that of view 1"
        return f"its pose {how}, and pictures from one place hold no depth; move the camera sideways between them"
    pair = rectify(reference, other)
    seen = overlap(reference, other, limits)
    if seen < LEAST_OVERLAP:
        return (
            f"it sees {100 * seen:.0f} % of what view 1 sees at best, too little; "
            "turn the cameras to one place, or bring them nearer to each other"
        )
    if pair.along_sight > MOST_ALONG_SIGHT:
        return "the camera moved along its line of sight, which holds hardly any depth; move it sideways"
    turned_away = min(pair.depth_ratios(corners(whole(reference.camera))).min(), _ratios(pair.R_other, other).min())
    if turned_away < LEAST_DEPTH_RATIO:
        return "it looks in too different a direction to be matched; turn the cameras less against each other"
    return pair


def overlap(reference: View, other: View, limits: Limits) -> float:
    """Share of the reference's pixels that the other view sees too, at the depth where that is largest."""
    camera = reference.camera
    u, v = np.meshgrid(np.linspace(0, camera.width - 1, GRID), np.linspace(0, camera.height - 1, GRID))
    pixels = np.stack([u.ravel(), v.ravel()], axis=-1)
    T_other_reference = inverse(other.T_base_camera) @ reference.T_base_camera
    near, far = limits.nearest_m or TRIED_M[0], limits.farthest_m or TRIED_M[1]
    shares: list[float] = []
    for depth_m in np.geomspace(min(near, far), max(near, far), GRID):
        points = camera.unproject(pixels, np.full(len(pixels), depth_m))
        seen = other.camera.project(transform(T_other_reference, points))
        with np.errstate(invalid="ignore"):
            inside = (seen >= -0.5) & (seen <= np.array([other.camera.width, other.camera.height]) - 0.5)
        shares.append(float(inside.all(axis=1).mean()))
    return max(shares)


def _ratios(R: Floats, view: View) -> Floats:
    """Depth in the common planes over depth along a view's z, at its corner pixels (4,)."""
    row = R[2] @ np.linalg.inv(view.camera.K)
    return corners(whole(view.camera)) @ row[:2] + row[2]

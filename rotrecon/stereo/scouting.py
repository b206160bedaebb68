"""A quick look at where surfaces are: a pair matched at a quarter of its resolution, over all disparities."""

import numpy as np

from rotrecon.arrays import Cloud
from rotrecon.stereo.canvas import canvas_over, whole
from rotrecon.stereo.carrying import inverse_depths
from rotrecon.stereo.limits import NEAREST_M, Limits
from rotrecon.stereo.matching import match
from rotrecon.stereo.rectification import Rectification

STEP_PX = 4
"""A quarter of the resolution: a thin object of 20 px is still 5 px wide, and it takes a fiftieth of the time."""
WINDOW_PX, SPECKLE_PX = 5, 30
"""Specks are smaller at that resolution."""
WIDEST_DISPARITY = 0.35
"""Of the picture's width: the greater part of what is nearer is seen by one camera alone."""


def scout(pair: Rectification, limits: Limits) -> Cloud:
    """Inverse depth along z (1/m) on every fourth pixel of the reference (h / 4, w / 4); NaN where none is seen.

    It is looked for between the limits, where there are none between infinity and disparities of a third of the
    picture: unlike features, a surface without contrast is found between its outlines.
    """
    camera = pair.reference.camera
    widest = min(WIDEST_DISPARITY * camera.width / (camera.focal_px * pair.baseline_m), 1 / NEAREST_M)
    far, near = limits.farthest_m, limits.nearest_m
    sought = (0.0 if far is None else 1 / far, widest if near is None else 1 / near)
    canvas = canvas_over(pair, whole(camera), 1 / STEP_PX, sought)
    return inverse_depths(canvas, match(canvas, WINDOW_PX, SPECKLE_PX).disparity_px, whole(camera), STEP_PX)


def span(inverse_depth: Cloud, tail: float, fewest: int) -> tuple[float, float] | None:
    """Smallest and largest of some inverse depths, a share `tail` at either end left out; None for too few."""
    known = inverse_depth[np.isfinite(inverse_depth)]
    if len(known) < fewest:
        return None
    low, high = np.quantile(known, [tail, 1 - tail])
    return float(low), float(high)

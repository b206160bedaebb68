"""Between which depths surfaces are looked for: what the arm's limits say, else what matched features show."""

from itertools import product

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import inverse, transform
from rotrecon.stereo.canvas import Box, corners
from rotrecon.stereo.features import Matches
from rotrecon.stereo.rectification import Rectification
from rotrecon.workspace import Workspace

FEATURE_MARGIN = 0.25
"""Of the disparity of the nearest and the farthest feature: surfaces reach nearer and farther than their texture."""
FEATURE_TAIL = 0.01
"""Share of the features at either end that may be matched wrongly."""
NEAREST_M = 0.05
"""Surfaces nearer to a camera are out of focus."""

DepthLimits = tuple[float | None, float | None]
"""Nearest and farthest depth along the reference's z, m; None where nothing limits it."""


def depth_limits(workspace: Workspace, T_base_camera: Floats) -> DepthLimits:
    """What the arm's limits leave of the depths in front of a camera."""
    near, far = workspace.depth_m if workspace.depth_m is not None else (None, None)
    nears, fars = [near], [far]
    if workspace.box_m is not None:
        ends = np.array(list(product(*workspace.box_m.T)))
        depths = transform(inverse(T_base_camera), ends)[:, 2]
        nears.append(float(depths.min()))
        fars.append(float(depths.max()))
    if workspace.reach_m is not None:
        base_depth = float(inverse(T_base_camera)[2, 3])
        nears.append(base_depth - workspace.reach_m[1])
        fars.append(base_depth + workspace.reach_m[1])
    nears = [depth for depth in nears if depth is not None and depth > NEAREST_M]
    fars = [depth for depth in fars if depth is not None and depth > NEAREST_M]
    return max(nears, default=None), min(fars, default=None)


def inverse_depths_of_limits(limits: DepthLimits, pair: Rectification, box: Box) -> tuple[float | None, float | None]:
    """Smallest and largest inverse depth (1/m) in the common planes at which limits can put a pixel of a box."""
    ratio = corners_ratio(pair, box)
    near, far = limits
    low = None if far is None else float((1 / (ratio * far)).min())
    high = None if near is None else float((1 / (ratio * near)).max())
    return low, high


def corners_ratio(pair: Rectification, box: Box) -> Floats:
    """Depth in the common planes over depth along the reference's z, at the corners (4,) of a box."""
    K_inverse = np.linalg.inv(pair.reference.camera.K)
    pixels = np.concatenate([corners(box), np.ones((4, 1))], axis=1)
    return pixels @ (pair.R_reference @ K_inverse)[2]


def inverse_depths_of_features(matches: Matches, pair: Rectification) -> tuple[float, float]:
    """Smallest and largest inverse depth (1/m) in the common planes of N > 0 matched features, with a margin."""
    inverse_depth = matches.disparity_px / (pair.reference.camera.focal_px * pair.baseline_m)
    low, high = np.quantile(inverse_depth, [FEATURE_TAIL, 1 - FEATURE_TAIL])
    return max(float(low) * (1 - FEATURE_MARGIN), 0.0), float(high) * (1 + FEATURE_MARGIN)

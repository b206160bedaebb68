"""Between which depths the arm can use a surface, and so where surfaces are looked for."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import inverse, transform
from rotrecon.workspace import Workspace

NEAREST_M = 0.05
"""What is nearer to a camera is out of focus."""


@dataclass(frozen=True)
class Limits:
    """Nearest and farthest depth along the reference's z, m; None where nothing limits it."""

    nearest_m: float | None = None
    farthest_m: float | None = None


def depth_limits(workspace: Workspace, T_base_camera: Floats) -> Limits:
    """What the arm's limits leave of the depths in front of a camera."""
    nearest, farthest = [NEAREST_M], [np.inf]
    if workspace.depth_m is not None:
        nearest.append(workspace.depth_m[0])
        farthest.append(workspace.depth_m[1])
    if workspace.box_m is not None:
        ends = np.array(list(product(*workspace.box_m.T)))
        depths = transform(inverse(T_base_camera), ends)[:, 2]
        nearest.append(float(depths.min()))
        farthest.append(float(depths.max()))
    if workspace.reach_m is not None:
        base_m = float(inverse(T_base_camera)[2, 3])
        nearest.append(base_m - workspace.reach_m[1])
        farthest.append(base_m + workspace.reach_m[1])
    near, far = max(nearest), min(farthest)
    return Limits(near if near > NEAREST_M else None, far if np.isfinite(far) else None)

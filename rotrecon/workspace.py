"""What the arm can reach: the pre-selection of points before anything else is done (paper 3)."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Cloud, Floats, freeze


@dataclass(frozen=True, eq=False)
class Workspace:
    """Limits of the arm and its camera; a limit that is None does not exist."""

    reach_m: tuple[float, float] | None = None
    """Nearest and farthest distance from the origin of the base."""
    box_m: Floats | None = None
    """(2, 3) lowest and highest corner in base coordinates."""
    depth_m: tuple[float, float] | None = None
    """Nearest and farthest depth along the camera's z."""

    def __post_init__(self) -> None:
        freeze(self)


def available(points_m: Cloud, T_base_camera: Floats, workspace: Workspace) -> Bools:
    """Which points (..., 3), in camera coordinates, the arm can use; (...) bool. Points without depth are not."""
    usable = np.isfinite(points_m[..., 2])
    if workspace.depth_m is not None:
        low, high = workspace.depth_m
        usable &= (points_m[..., 2] >= low) & (points_m[..., 2] <= high)
    if workspace.reach_m is None and workspace.box_m is None:
        return usable
    in_base = points_m @ T_base_camera[:3, :3].T.astype(np.float32) + T_base_camera[:3, 3].astype(np.float32)
    if workspace.reach_m is not None:
        distance = np.sqrt(np.einsum("...i,...i->...", in_base, in_base))
        usable &= (distance >= workspace.reach_m[0]) & (distance <= workspace.reach_m[1])
    if workspace.box_m is not None:
        # an axis at a time: a reduction over three elements takes several times as long
        for axis, (low, high) in enumerate(workspace.box_m.T):
            usable &= (in_base[..., axis] >= low) & (in_base[..., axis] <= high)
    return usable


def out_of_reach(point_m: Floats, workspace: Workspace) -> str | None:
    """Why the arm cannot be at a point (3,) in base coordinates, in words; None where it can."""
    away_m = float(np.linalg.norm(point_m))
    if workspace.reach_m is not None and not workspace.reach_m[0] <= away_m <= workspace.reach_m[1]:
        low, high = workspace.reach_m
        return f"{away_m:.2f} m from the base, which reaches {low:g} to {high:g} m"
    if workspace.box_m is not None:
        for name, value, (low, high) in zip("xyz", point_m, workspace.box_m.T, strict=True):
            if not low <= value <= high:
                return f"{name} = {value:.2f} m, beyond the arm's box ({low:g} to {high:g} m)"
    return None

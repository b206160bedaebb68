"""Where the camera should go next: how well the diameter would be known from other places, before going there."""

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.predicted_interval import half_width_from, present_of
from rotrecon.primitives import Primitive
from rotrecon.reconstruction import Reconstruction
from rotrecon.workspace import out_of_reach

ANGLES_RAD = tuple(np.deg2rad([-75.0, -60.0, -45.0, -30.0, -15.0, 0.0, 15.0, 30.0, 45.0, 60.0, 75.0]).tolist())
"""Round the object's axis from where the camera is: a finer ring would promise no more than its numbers hold."""
NEARNESSES = (0.6, 0.8, 1.0, 1.25)
"""Distances from the object's middle over the present one; beyond, what is assumed of the noise may not hold."""
AS_GOOD = 0.05
"""Share by which an interval may be wider than the narrowest for the shorter way to be the better one."""


@dataclass(frozen=True, eq=False)
class ViewFrom:
    """A place of the camera, and what is expected from there."""

    T_base_camera: Floats
    """(4, 4) rigid."""
    angle_rad: float
    """By which the camera is turned about the object's direction, right-handed."""
    nearness: float
    """Distance from the object's middle over the present one."""
    distance_m: float
    toward: str
    """Which way round that is, as the camera sees it now: left, right, up or down; empty for straight ahead."""
    half_width_m: float
    """Half the 95 % interval of the diameter, of a measurement from there alone."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class NextView:
    """The best of the places that were tried."""

    best: ViewFrom
    now_m: float
    """Half the present 95 % interval of the diameter."""
    tried: tuple[ViewFrom, ...]
    """All of which something can be said, the best first."""
    beyond_reach: int
    """Places that the arm's limits do not allow."""
    by_distance: tuple[ViewFrom, ...]
    """The best at each distance, the nearest first."""


def next_view(result: Reconstruction) -> NextView | None:
    """The place from which the diameter would be known best; None where no interval is known, or nothing can be said.

    Places are on rings about the object's axis, looking the way the camera looks now. The program measures one frame
    at a time: what is predicted is the interval of a frame from there alone.
    """
    present = present_of(result)
    if present is None:
        return None
    tried: list[ViewFrom] = []
    beyond_reach = 0
    for angle_rad in ANGLES_RAD:
        for nearness in NEARNESSES:
            T_base_camera = moved_round(result.frame.T_base_camera, present.solid, angle_rad, nearness)
            if out_of_reach(T_base_camera[:3, 3], result.frame.workspace) is not None:
                beyond_reach += 1
                continue
            half_width_m = half_width_from(present, T_base_camera)
            if half_width_m is not None:
                away_m = float(np.linalg.norm(T_base_camera[:3, 3] - present.solid.center_m))
                toward = _toward(result.frame.T_base_camera, T_base_camera)
                tried.append(ViewFrom(T_base_camera, angle_rad, nearness, away_m, toward, half_width_m))
    if not tried:
        return None
    at_each = [[view for view in tried if view.nearness == nearness] for nearness in NEARNESSES]
    tried.sort(key=lambda view: view.half_width_m)
    by_distance = tuple(_best(views) for views in at_each if views)
    return NextView(_best(tried), present.half_width_m, tuple(tried), beyond_reach, by_distance)


def _best(views: list[ViewFrom]) -> ViewFrom:
    """Of those that are as good as the best, the one that takes the shortest way."""
    least_m = min(view.half_width_m for view in views)
    good = [view for view in views if view.half_width_m <= (1 + AS_GOOD) * least_m]
    return min(good, key=lambda view: abs(view.angle_rad) + abs(1 - view.nearness))


def moved_round(T_base_camera: Floats, solid: Primitive, angle_rad: float, nearness: float) -> Floats:
    """The camera's pose (4, 4) turned about a solid's axis, then moved toward its middle; base coordinates."""
    turn = _about(solid.direction, angle_rad)
    pose = np.eye(4)
    pose[:3, :3] = turn @ T_base_camera[:3, :3]
    pose[:3, 3] = solid.center_m + nearness * (turn @ (T_base_camera[:3, 3] - solid.center_m))
    return pose


def _about(direction: Floats, angle_rad: float) -> Floats:
    """Rotation (3, 3) about a unit vector (Rodrigues)."""
    x, y, z = direction
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sin(angle_rad) * cross + (1 - cos(angle_rad)) * (cross @ cross)


def _toward(T_base_camera: Floats, T_base_moved: Floats) -> str:
    """Which way a camera is turned, as it sees it; empty where it is not."""
    right, down, _ = T_base_camera[:3, :3].T @ (T_base_moved[:3, 2] - T_base_camera[:3, 2])
    if max(abs(right), abs(down)) < np.finfo(np.float32).eps:
        return ""
    # it goes on looking at the object, and so goes left where it comes to look to the right
    if abs(right) >= abs(down):
        return "left" if right > 0 else "right"
    return "up" if down > 0 else "down"

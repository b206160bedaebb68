"""The limits of the arm and its camera as pieces of line in base coordinates."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera, transform
from rotrecon.workspace import Workspace

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
EDGES = [(a, b) for a in range(8) for b in range(a + 1, 8) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1]
CIRCLE_PIECES = 72


def limit_lines(workspace: Workspace, camera: PinholeCamera, T_base_camera: Floats) -> dict[str, Floats]:
    """Pieces of line (n, 2, 3) of each limit there is: circles of the reach, edges of the box, rectangles of the depth.

    Metres in base coordinates.
    """
    lines: dict[str, Floats] = {}
    if workspace.reach_m is not None:
        lines["reach"] = np.concatenate([radius_m * _unit_circles() for radius_m in workspace.reach_m])
    if workspace.box_m is not None:
        low, high = workspace.box_m
        lines["box"] = (low + CORNERS * (high - low))[np.array(EDGES)]
    if workspace.depth_m is not None:
        right, bottom = camera.width - 0.5, camera.height - 0.5
        corners = np.array([(-0.5, -0.5), (right, -0.5), (right, bottom), (-0.5, bottom)])
        rings = [camera.unproject(corners, np.full(4, depth_m)) for depth_m in workspace.depth_m]
        lines["depth"] = transform(T_base_camera, np.concatenate([_closed(ring) for ring in rings]))
    return lines


def _unit_circles() -> Floats:
    """Pieces (n, 2, 3) of the three great circles of the unit sphere that lie in the planes of the axes."""
    angle = np.arange(CIRCLE_PIECES) * (2 * np.pi / CIRCLE_PIECES)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(CIRCLE_PIECES)], axis=1)
    return np.concatenate([_closed(np.roll(circle, shift, axis=1)) for shift in range(3)])


def _closed(points: Floats) -> Floats:
    """Pieces (n, 2, 3) of the line through points (n, 3) and back to the first."""
    return np.stack([points, np.roll(points, -1, axis=0)], axis=1)

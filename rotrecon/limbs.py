"""Where the outline of a surface lies in the picture, and where the depth map says the object ends."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Floats, Indices, freeze
from rotrecon.fitting import Outline
from rotrecon.patch import Patch
from rotrecon.surfaces import Ball, Lateral, Surface

MASK_REACH_PX = 12.0
"""How far from a predicted outline the mask's edge is looked for."""
MASK_STEP_PX = 0.5
"""Pixels are looked up at this pitch."""
MASK_SIGMA_PX = 1.0
"""Matching moves a mask's edge by a pixel or so, the same way everywhere (measured on rendered pairs)."""
ONLY_GAP_PX = 1.5
"""Unknown depth wider than this between object and background leaves the edge anywhere in it."""
DEEP = 1.5
"""Radii behind the outline from which on a pixel is background, and before which it is the object."""
CLEAR_SHARE = 0.25
"""Of an outline, below which what is seen of the mask's edge says little."""
CIRCLE_POINTS = 180
"""Limb points of a ball."""


@dataclass(frozen=True, eq=False)
class Limbs:
    """Points of an outline in the picture."""

    point_px: Floats
    """(n, 2)"""
    normal_px: Floats
    """(n, 2) unit, away from the object."""
    side: Indices
    """(n,) 0 or 1: to the left or the right along the axis; 0 for all of a ball."""
    along: Floats
    """(n,) height along the axis, m; of a ball the angle round the outline, rad."""
    depth_m: Floats
    """(n,)"""

    def __post_init__(self) -> None:
        freeze(self)


def limbs_of(surface: Surface, patch: Patch, heights_m: Floats) -> Limbs:
    """Limb points of a surface, of a lateral one at heights (n,) along its axis; those outside the patch are left out.

    At a limb the surface's normal is square to the ray.
    """
    points, normals, side, along = _of_ball(surface) if isinstance(surface, Ball) else _of_lateral(surface, heights_m)
    # the tangent plane holds the camera, so that its trace in the picture is the tangent of the outline
    K = patch.camera.K
    normal_px = normals[:, :2] / np.array([K[0, 0], K[1, 1]])
    normal_px /= np.linalg.norm(normal_px, axis=1, keepdims=True)
    point_px = patch.camera.project(points)
    seen = np.isfinite(point_px).all(axis=1) & (patch.pixel_of(point_px) >= 0)
    return Limbs(point_px[seen], normal_px[seen], side[seen], along[seen], points[seen, 2])


def _of_lateral(surface: Lateral, heights_m: Floats) -> tuple[Floats, Floats, Indices, Floats]:
    axis_points = surface.center_m + heights_m[:, None] * surface.direction
    radius = surface.radius_m + surface.slope * heights_m
    height = axis_points @ surface.direction
    foot = axis_points - height[:, None] * surface.direction
    distance = np.linalg.norm(foot, axis=1)
    toward = foot / distance[:, None]
    aside = np.cross(surface.direction, toward)
    # (n - slope a) . p = 0 with p = axis point + radius n
    cosine = (surface.slope * height - radius) / distance
    sine = np.sqrt(np.maximum(1.0 - cosine**2, 0.0))
    there = (np.abs(cosine) < 1.0) & (radius > 0)
    sides: list[tuple[Floats, Floats]] = []
    for sign in (-1.0, 1.0):
        outward = cosine[:, None] * toward + sign * sine[:, None] * aside
        sides.append(
            ((axis_points + radius[:, None] * outward)[there], (outward - surface.slope * surface.direction)[there])
        )
    count = int(there.sum())
    points, normals = (np.concatenate([side[part] for side in sides]) for part in (0, 1))
    return points, normals, np.repeat(np.arange(2, dtype=np.int32), count), np.tile(heights_m[there], 2)


def _of_ball(ball: Ball) -> tuple[Floats, Floats, Indices, Floats]:
    distance = float(np.linalg.norm(ball.center_m))
    toward = ball.center_m / distance
    sine = min(ball.radius_m / distance, 1.0)
    angle = np.linspace(0, 2 * np.pi, CIRCLE_POINTS, endpoint=False)
    across = np.cross(toward, np.array([0.0, 1.0, 0.0]))
    across /= np.linalg.norm(across)
    round_about = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(toward, across)
    normals = np.sqrt(1 - sine**2) * round_about - sine * toward
    return ball.center_m + ball.radius_m * normals, normals, np.zeros(CIRCLE_POINTS, dtype=np.int32), angle


def mask_outline(limbs: Limbs, size_m: float, patch: Patch) -> Outline | None:
    """The rays at which the object's depth gives way to that of the background; None where that is nowhere seen.

    `size_m` is the object's radius: what lies further behind the limb than a few of it is background.
    """
    offset = np.arange(-MASK_REACH_PX, MASK_REACH_PX + MASK_STEP_PX / 2, MASK_STEP_PX)
    place = limbs.point_px[:, None] + offset[None, :, None] * limbs.normal_px[:, None]
    pixel = patch.pixel_of(place.reshape(-1, 2)).reshape(len(limbs.point_px), len(offset))
    behind = np.where(pixel >= 0, patch.depth_m[pixel], np.nan) - limbs.depth_m[:, None]
    is_object, is_background = np.abs(behind) < DEEP * size_m, behind > DEEP * size_m
    column = np.arange(len(offset))
    first_background = np.where(is_background.any(axis=1), is_background.argmax(axis=1), -1)
    before = is_object & (column < first_background[:, None])
    last_object = np.where(before.any(axis=1), len(offset) - 1 - before[:, ::-1].argmax(axis=1), -1)
    gap_px = (first_background - last_object) * MASK_STEP_PX
    clear = (last_object >= 0) & (gap_px <= ONLY_GAP_PX + MASK_STEP_PX)
    if clear.sum() < CLEAR_SHARE * len(clear):
        return None
    edge = (offset[first_background[clear]] + offset[last_object[clear]]) / 2
    return outline_at(
        limbs.point_px[clear] + edge[:, None] * limbs.normal_px[clear], np.full(len(edge), MASK_SIGMA_PX), patch
    )


def outline_at(point_px: Floats, sigma_px: Floats, patch: Patch) -> Outline:
    """An outline through points (n, 2) of the picture."""
    return Outline(patch.camera.unproject(point_px, np.ones(len(point_px))).T, sigma_px, patch.focal_px)

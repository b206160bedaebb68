"""Where the outline of a surface lies in the picture, and where the depth map says the object ends."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import CrossSegments
from rotrecon.edges.edges import Side, find_edges
from rotrecon.rays.ball import Ball
from rotrecon.rays.fitting import Outline
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.patch import Patch
from rotrecon.rays.surfaces import Surface

MASK_SIGMA_PX = 1.0
"""Matching moves a mask's edge by a pixel or so, the same way everywhere (measured on rendered pairs)."""
WIDEST_GAP_PX = 24.0
"""Of unknown depth between object and background that says anything."""
CLEAR_SHARE = 0.25
"""Of an outline, below which what is seen of the mask's edge says little."""
OUTLINE_SECTIONS, OUTLINE_REACH = 241, 1.5
"""Heights at which the outline is looked for, and how far to both sides of the middle, in lengths of the stroke."""
BLUR_DOUBT, PIXEL_BLUR_PX = 0.5, 0.5
"""Standard deviation of where the outline lies in a smeared edge, over the smear, and the blur of pixels alone, which
thin things seem to have most of: focus, compression and what a limb reflects smear it more."""
FEWEST_LIMBS = 12
"""Fewer limb points are no outline."""
REACH_SHARE, LEAST_REACH_PX, MOST_REACH_PX = 0.25, 4.0, 10.0
"""Share of the half width within which an edge is looked for, px at least and at most."""
NEAR_REACH_PX, NEAR_SPREAD_PX = 2.5, 1.5
"""How far one is looked for from a surface which has followed edges already: 99 of 100 are nearer (measured on rendered
pictures); and where they become unlikely."""
FIRST_ARC, CIRCLE_ARCS, ARC_POINTS = 2, 4, 45
"""Number of the first arc of a ball's outline, after the limbs 0 and 1 of other surfaces; arcs, each seen or not by
itself; and the limb points of each."""


@dataclass(frozen=True, eq=False)
class Limbs:
    """Points of an outline in the picture."""

    point_px: Floats
    """(n, 2)"""
    normal_px: Floats
    """(n, 2) unit, away from the object."""
    side: Indices
    """(n,) 0 or 1: to the left or the right along the axis; of a ball the number of the arc, 2 to 5."""
    along: Floats
    """(n,) height along the axis, m; of a ball the angle round the outline, rad."""
    depth_m: Floats
    """(n,)"""

    def __post_init__(self) -> None:
        freeze(self)

    def chosen(self, which: Bools) -> "Limbs":
        """Some of the points."""
        place, normal, side = self.point_px[which], self.normal_px[which], self.side[which]
        return Limbs(place, normal, side, self.along[which], self.depth_m[which])


def limbs_of(surface: Surface, camera: PinholeCamera, heights_m: Floats) -> Limbs:
    """Limb points of a surface, of a lateral one at heights (n,) along its axis; outside the picture they are left out.

    At a limb the surface's normal is square to the ray.
    """
    points, normals, side, along = _of_ball(surface) if isinstance(surface, Ball) else _of_lateral(surface, heights_m)
    # the tangent plane holds the camera, so that its trace in the picture is the tangent of the outline
    K = camera.K
    normal_px = normals[:, :2] / np.array([K[0, 0], K[1, 1]])
    normal_px /= np.linalg.norm(normal_px, axis=1, keepdims=True)
    point_px = camera.project(points)
    size = np.array([camera.width, camera.height])
    with np.errstate(invalid="ignore"):
        seen = ((point_px >= 0) & (point_px <= size - 1)).all(axis=1)
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
    angle = np.linspace(0, 2 * np.pi, CIRCLE_ARCS * ARC_POINTS, endpoint=False)
    across = np.cross(toward, np.array([0.0, 1.0, 0.0]))
    across /= np.linalg.norm(across)
    round_about = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(toward, across)
    normals = np.sqrt(1 - sine**2) * round_about - sine * toward
    arc = FIRST_ARC + np.repeat(np.arange(CIRCLE_ARCS, dtype=np.int32), ARC_POINTS)
    return ball.center_m + ball.radius_m * normals, normals, arc, angle


def mask_outline(segments: CrossSegments, kept: Bools, usable: Bools, patch: Patch) -> Outline | None:
    """The rays at which the segmented (S, W) object gives way to other usable (S, W) pixels, section by section.

    Where depth is unknown between the two, over no wide gap, the edge may be anywhere in it. None when most
    sections end at the area's border, or in wider gaps.
    """
    columns: Indices = np.arange(kept.shape[1], dtype=np.int32)
    found = kept.any(axis=1)
    places: list[Floats] = []
    gaps: list[Floats] = []
    for turned in (1, -1):
        object_, other = kept[:, ::turned], (usable & ~kept)[:, ::turned]
        first = object_.argmax(axis=1)
        last_other = np.maximum.accumulate(np.where(other, columns, -1), axis=1)[np.arange(len(first)), first]
        gap = first - last_other
        clear = found & (last_other >= 0) & (gap <= WIDEST_GAP_PX)
        column = (first + last_other) / 2 if turned > 0 else kept.shape[1] - 1 - (first + last_other) / 2
        across = (segments.first_offset_px + column[clear])[:, None] * segments.across
        places.append(segments.origin_px + np.flatnonzero(clear)[:, None] * segments.along + across)
        gaps.append(gap[clear].astype(np.float64))
    gap_px = np.concatenate(gaps)
    if len(gap_px) < CLEAR_SHARE * 2 * found.sum():
        return None
    return outline_at(np.concatenate(places), np.maximum(MASK_SIGMA_PX, gap_px / 2), patch)


def outline_at(point_px: Floats, sigma_px: Floats, patch: Patch) -> Outline:
    """An outline through points (n, 2) of the picture."""
    rays = np.ascontiguousarray(patch.camera.unproject(point_px, np.ones(len(point_px))).T)
    return Outline(rays, sigma_px, patch.focal_px)


@dataclass(frozen=True, eq=False)
class SeenOutline:
    """What the picture shows of an outline."""

    edges: Outline | None
    """None where no side of it can be trusted."""
    sides: tuple[int, ...]
    """Those that can, in the order of the stretches of edges: numbers of limbs, or of arcs of a ball's."""

    @property
    def rank(self) -> tuple[int, int]:
        """The more of it is seen, the better."""
        return (len(self.sides), 0 if self.edges is None else len(self.edges))

    def doubting(self, before: "SeenOutline", surface: Surface) -> "SeenOutline":
        """The same, less sure of each side by how far from a surface it is seen here and was seen before.

        Two looks hardly ever differ (measured on rendered pictures: by 0.01 px, and in 3 of 100 by 0.07 px); where they
        do, shading is taken for blur or a print for an edge in one of them.
        """
        if self.edges is None or before.edges is None:
            return self
        earlier = dict(zip(before.sides, before.edges.offsets_px(surface).tolist(), strict=True))
        now = zip(self.sides, self.edges.offsets_px(surface).tolist(), strict=True)
        return replace(self, edges=self.edges.less_sure(np.array([px - earlier.get(side, px) for side, px in now])))


NOTHING_SEEN = SeenOutline(None, ())


def seen_outline(
    surface: Surface, patch: Patch, segments: CrossSegments, length_m: float, followed: bool = False
) -> SeenOutline:
    """The edges in the picture near the outline of a surface, beside a stroke along `length_m` of it; a ball's all.

    They are near one that has `followed` edges before, but for a ball, each arc of which moves by itself.
    """
    if surface.side > 0 or patch.is_plain:
        return NOTHING_SEEN
    heights_m = np.linspace(-OUTLINE_REACH, OUTLINE_REACH, OUTLINE_SECTIONS) * length_m
    limbs = limbs_of(surface, patch.camera, heights_m)
    if isinstance(surface, Ball):
        return edges_at(limbs, surface, patch)
    # what is beside the stroke is not at its heights where one looks along the axis
    row = (limbs.point_px - segments.origin_px) @ segments.along
    return edges_at(limbs.chosen((row >= 0) & (row <= len(segments.pixel))), surface, patch, followed)


def edges_at(limbs: Limbs, surface: Surface, patch: Patch, followed: bool = False) -> SeenOutline:
    """The edges in a patch's picture near limb points of a surface, the nearer if it has `followed` edges before."""
    if len(limbs.side) < FEWEST_LIMBS:
        return NOTHING_SEEN
    radius_m = surface.radius_m + surface.slope * limbs.along if isinstance(surface, Lateral) else surface.radius_m
    half_width_px = radius_m / limbs.depth_m * patch.focal_px
    far_px = float(np.clip(REACH_SHARE * np.median(half_width_px), LEAST_REACH_PX, MOST_REACH_PX))
    reach_px, spread_px = (NEAR_REACH_PX, NEAR_SPREAD_PX) if followed else (far_px, None)
    found = find_edges(patch.image, limbs.point_px, limbs.normal_px, reach_px, half_width_px, limbs.side, spread_px)
    trusted = {
        int(number): side for number, side in zip(np.unique(limbs.side), found.sides, strict=True) if side.trusted
    }
    usable = np.isfinite(found.offset_px) & np.isin(limbs.side, list(trusted))
    if not usable.any():
        return NOTHING_SEEN
    place = limbs.point_px[usable] + found.offset_px[usable, None] * limbs.normal_px[usable]
    stretches = [np.flatnonzero(limbs.side[usable] == number).astype(np.int32) for number in trusted]
    alike = zip(stretches, (side.alike_px for side in trusted.values()), strict=True)
    outline = replace(outline_at(place, found.sigma_px[usable], patch), alike=tuple(alike))
    return SeenOutline(outline.less_sure(np.array([_smeared_px(side) for side in trusted.values()])), tuple(trusted))


def _smeared_px(side: Side) -> float:
    """Standard deviation of where an outline lies in an edge that is blurred by more than pixels are."""
    return BLUR_DOUBT * float(np.sqrt(max(side.blur_px**2 - PIXEL_BLUR_PX**2, 0.0)))

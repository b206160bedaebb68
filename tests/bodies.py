"""Bodies of several solids on one axis before a wall, as a noisy stereo camera would see them."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from rotrecon.arrays import Bools, Cloud, Floats
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, CrossSegments, Drawing, ObjectAxis, cut_sections
from rotrecon.frame import Frame
from rotrecon.primitives import Frustum, Primitive, basis_across
from rotrecon.rays.ball import Ball
from rotrecon.rays.correlation import Likeness
from rotrecon.rays.fitting import Outline
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.patch import Patch, clear_depth, patch_of
from rotrecon.rays.ray_fit import RayFit, Sight
from rotrecon.rays.starts import Ridge, ridge
from rotrecon.rays.surfaces import turn_of
from rotrecon.segmentation import segment
from rotrecon.settings import Settings
from rotrecon.simulation.raycast import first_hit
from rotrecon.simulation.stereo_noise import correlated_noise

CAMERA = PinholeCamera(640, 480, np.array([[700.0, 0, 319.5], [0, 700.0, 239.5], [0, 0, 1]]))
BASELINE_M = 0.1
WALL_M = 0.6
"""Behind the body's middle."""

Knee = tuple[float, float]
"""Height along the axis and radius, m."""
BOTTLE: tuple[Knee, ...] = ((-0.1, 0.035), (0.03, 0.035), (0.06, 0.014), (0.1, 0.014))
MUG_WITH_FOOT: tuple[Knee, ...] = ((-0.05, 0.028), (-0.03, 0.028), (-0.03, 0.04), (0.05, 0.04))
FLANGED_PIPE: tuple[Knee, ...] = ((-0.15, 0.03), (0.03, 0.03), (0.03, 0.05), (0.07, 0.05))
CYLINDER: tuple[Knee, ...] = ((-0.1, 0.035), (0.1, 0.035))
CONE: tuple[Knee, ...] = ((-0.08, 0.03), (0.08, 0.06))
_HEIGHT = np.linspace(-0.1, 0.1, 41)
VASE: tuple[Knee, ...] = tuple((float(h), 0.035 + 0.012 * float(np.cos(h / 0.1 * 2.4 + 0.5))) for h in _HEIGHT)

BODIES: dict[str, tuple[Knee, ...]] = {
    "bottle": BOTTLE,
    "mug": MUG_WITH_FOOT,
    "flange": FLANGED_PIPE,
    "vase": VASE,
    "cylinder": CYLINDER,
    "cone": CONE,
}


@dataclass(frozen=True, eq=False)
class Body:
    """A polyline of radii turned about an axis."""

    knees: tuple[Knee, ...]
    center_m: Floats
    direction: Floats

    def solids(self) -> list[Primitive]:
        return [
            Frustum(
                "cone",
                self.center_m + (low + high) / 2 * self.direction,
                self.direction,
                high - low,
                (first + last) / 2,
                float(np.arctan((last - first) / (high - low))),
            )
            for (low, first), (high, last) in zip(self.knees[:-1], self.knees[1:], strict=True)
            if high > low
        ]

    def radius_at(self, height_m: Floats) -> Floats:
        height, radius = np.array(self.knees).T
        # at a step the two radii share a height
        return np.interp(height_m, height + 1e-9 * np.arange(len(height)), radius)

    def on(self, surface: Lateral, height_m: Floats) -> Floats:
        """Heights along this axis of heights along that of a surface, which may point the other way."""
        sense = np.sign(surface.direction @ self.direction)
        return (surface.center_m - self.center_m) @ self.direction + sense * height_m

    @property
    def low_m(self) -> float:
        return self.knees[0][0]

    @property
    def high_m(self) -> float:
        return self.knees[-1][0]

    def lateral(self, height_m: float = 0.0, slope: float = 0.0, tapers: bool = False) -> Lateral:
        """The surface at a height, as its start would be."""
        radius = float(self.radius_at(np.array(height_m))) - slope * height_m
        return Lateral(self.center_m, turn_of(self.direction, -self.center_m), radius, slope, 700.0, tapers)


def body_at(knees: tuple[Knee, ...], seed: int, distance_m: float = 0.7, most_tilt: float = 0.6) -> Body:
    """A body about the picture's middle, its axis in any direction of the picture, tilted out of it."""
    rng = np.random.default_rng(seed)
    angle, tilt = rng.uniform(0, 2 * np.pi), rng.uniform(-most_tilt, most_tilt)
    direction = np.array([np.cos(tilt) * np.cos(angle), np.cos(tilt) * np.sin(angle), np.sin(tilt)])
    center = np.array([*rng.uniform(-0.02, 0.02, 2), distance_m])
    return Body(knees, center, direction)


def depth_of(solids: list[Primitive], camera: PinholeCamera = CAMERA, wall_m: float = WALL_M) -> Floats:
    """Exact depth (height, width)."""
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    rays = camera.unproject(np.stack([u, v], axis=-1), np.ones(u.shape))
    depth = np.full(u.shape, solids[0].center_m[2] + wall_m)
    for solid in solids:
        axes = np.stack([*basis_across(solid.direction, -solid.center_m), solid.direction], axis=1)
        depth = np.minimum(depth, first_hit(solid, -solid.center_m @ axes, rays @ axes))
    return depth


def noisy_frame(depth_m: Floats, seed: int, sigma_px: float = 0.25, correlation_px: float = 0.0) -> Frame:
    """Disparity noise added to a depth map."""
    rng = np.random.default_rng(seed)
    focal_baseline = CAMERA.focal_px * BASELINE_M
    disparity = focal_baseline / depth_m + sigma_px * correlated_noise(depth_m.shape, correlation_px, rng)
    return Frame(np.zeros((*depth_m.shape, 3), dtype=np.uint8), CAMERA.cloud(focal_baseline / disparity), CAMERA)


def drawing_round(body: Body, low_m: float, high_m: float, margin_px: float = 8.0) -> Drawing:
    """A stroke along the axis between two heights, and an area round it as wide as the body and a margin."""
    start, end = CAMERA.project(body.center_m + np.array([[low_m], [high_m]]) * body.direction)
    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([-along[1], along[0]])
    widest = max(radius for _, radius in body.knees)
    half = widest * CAMERA.focal_px / (body.center_m[2] - 0.1) + margin_px
    corners = [start - half * across, end - half * across, end + half * across, start + half * across]
    area = AreaOfInterest(tuple((float(u), float(v)) for u, v in corners))
    stroke = (start + 2 * along, end - 2 * along)
    return Drawing(area, ObjectAxis(*((float(u), float(v)) for u, v in stroke)))


def patch_seen(frame: Frame, drawing: Drawing) -> Patch:
    """The patch of a drawing, segmented as by the paper."""
    segments, kept, _ = _segmented(frame, drawing)
    return patch_of(frame, drawing.area, segments, kept)


def ridge_seen(frame: Frame, drawing: Drawing) -> Ridge:
    """The ridge of what is segmented in a drawing."""
    segments, kept, depth_m = _segmented(frame, drawing)
    return ridge(frame.camera, depth_m.astype(np.float64), segments, kept & np.isfinite(depth_m))


def _segmented(frame: Frame, drawing: Drawing) -> tuple[CrossSegments, Bools, Cloud]:
    segments = cut_sections(drawing.area, drawing.stroke, (frame.camera.width, frame.camera.height))
    clean = clear_depth(frame.depth_m, segments.pixel)
    usable = segments.inside & np.isfinite(clean)
    return segments, segment(clean, usable, segments.inside, Settings()).kept, clean


def as_fit(
    surface: Lateral | Ball, outlines: tuple[tuple[Outline, float], ...] = (), guard: float = 1e3, sigma: float = 1.0
) -> RayFit:
    """A surface as if it had been fitted, exactly and to white noise."""
    count = len(surface.units(1.0))
    free, nothing = np.ones(count, dtype=np.bool_), np.zeros(0)
    pixels, unalike = np.zeros(0, dtype=np.int32), Likeness(0.0, 0.0)
    return RayFit(
        surface, Sight(guard=guard), outlines, free, pixels, nothing, sigma, unalike, lambda: np.zeros((count, count))
    )


@cache
def seen(
    knees: tuple[Knee, ...], seed: int, sigma_px: float = 0.25, correlation_px: float = 0.0
) -> tuple[Body, Patch, Ridge]:
    """A body as a stroke along all of it sees it, and what its segmented pixels show."""
    body = body_at(knees, seed, most_tilt=0.5)
    frame = noisy_frame(depth_of(body.solids()), seed, sigma_px, correlation_px)
    drawing = drawing_round(body, body.low_m - 0.03, body.high_m + 0.03)
    return body, patch_seen(frame, drawing), ridge_seen(frame, drawing)

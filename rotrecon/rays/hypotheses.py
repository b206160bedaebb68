"""The best coarse surface of each shape: every start is followed a little way, the best of them further."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import CrossSegments
from rotrecon.rays.ball import Ball
from rotrecon.rays.coarse_fit import coarse, coarse_pixels
from rotrecon.rays.fitting import Outline
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.limbs import mask_outline
from rotrecon.rays.losses import cauchy
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import depths_of, spread
from rotrecon.rays.starts import Ridge, ball_starts, cone_starts, cylinder_starts, ridge, together
from rotrecon.rays.surfaces import Surface
from rotrecon.rays.traces import Range, limited
from rotrecon.sections.radii import Shape

SCOUT_PIXELS = 150
"""For the starts; the best of them goes on with all coarse pixels."""
SCOUT_EDGES = 40
COST_SCALE = 3.0
"""Standard deviations of the noise."""


@dataclass(frozen=True, eq=False)
class Held:
    """What is known of the object beforehand."""

    direction: Floats | None = None
    """(3,) unit, of its axis."""
    radius_m: Range | None = None
    """Its lowest and highest; equal when it is known."""

    def __post_init__(self) -> None:
        freeze(self)

    def limiting(self, start: Surface) -> Surface:
        """A start that keeps to the limits of the radius."""
        return replace(start, radius_m=limited(start.radius_m, self.radius_m), limits_m=self.radius_m)

    def free(self, surface: Surface) -> Bools:
        """(k,) which parameters of a surface are to be found."""
        free = np.ones(len(surface.units(1.0)), dtype=np.bool_)
        is_ball = isinstance(surface, Ball)
        if self.direction is not None and not is_ball:
            free[2:4] = False
        if self.radius_m is not None and self.radius_m[0] == self.radius_m[1]:
            free[3 if is_ball else 4] = False
        return free


@dataclass(frozen=True, eq=False)
class Scene:
    """What of the object is known before anything is fitted."""

    patch: Patch
    ridge: Ridge
    pixels: Indices
    """Some inner ones of the segmented."""
    outline: Outline | None
    """Of the segmented pixels."""
    length_m: float
    segments: CrossSegments
    depth_m: Floats
    """(S, W) of the segmented cells; NaN elsewhere."""

    def __post_init__(self) -> None:
        freeze(self)


def scene_of(camera: PinholeCamera, patch: Patch, segments: CrossSegments, kept: Bools, depth_m: Floats) -> Scene:
    """The scene of segmented cells (S, W) of known depth (S, W)."""
    edge = ridge(camera, depth_m, segments, kept)
    length_m = float(np.linalg.norm(np.ptp(together(edge.points_m), axis=0))) if len(edge.points_m) else 0.0
    usable = segments.inside & np.isfinite(depth_m)
    outline = mask_outline(segments, kept, usable, patch)
    seen_m = np.where(kept, depth_m, np.nan)
    return Scene(patch, edge, coarse_pixels(patch, segments, kept), outline, length_m, segments, seen_m)


def hypotheses(scene: Scene, held: Held) -> dict[Shape, tuple[float, Surface]]:
    """Cost and surface of each shape; costs are of the same pixels at the same scale."""
    patch, pixels = scene.patch, scene.pixels
    points_m = (patch.rays[:, pixels] * patch.depth_m[pixels]).T
    focal_px = patch.focal_px
    starts: dict[Shape, Sequence[Surface]] = {
        "cylinder": cylinder_starts(scene.ridge, points_m, held.direction, focal_px),
        "cone": cone_starts(scene.ridge, held.direction, focal_px),
        "sphere": ball_starts(scene.ridge, points_m, focal_px),
    }
    limited_starts: dict[Shape, list[Surface]] = {
        shape: [held.limiting(start) for start in of_shape] for shape, of_shape in starts.items()
    }
    followed: dict[Shape, Surface] = {
        shape: best_of(scene, held, of_shape) for shape, of_shape in limited_starts.items() if shape != "cone"
    }
    cylinder = followed["cylinder"]
    assert isinstance(cylinder, Lateral)
    followed["cone"] = best_of(scene, held, [replace(cylinder, tapers=True), *limited_starts["cone"]])
    return {shape: (coarse_cost(scene, surface), surface) for shape, surface in followed.items()}


def best_of(scene: Scene, held: Held, starts: Sequence[Surface]) -> Surface:
    """The surface that the best start leads to, fitted coarsely."""
    scouts = spread(scene.pixels, SCOUT_PIXELS)
    edges = (
        None
        if scene.outline is None
        else scene.outline.chosen(spread(np.arange(len(scene.outline), dtype=np.int32), SCOUT_EDGES))
    )
    found = [
        coarse(start, scene.patch, scouts, start.units(scene.length_m), held.free(start), edges) for start in starts
    ]
    best = min(found, key=lambda surface: coarse_cost(scene, surface)) if len(found) > 1 else found[0]
    return coarse(best, scene.patch, scene.pixels, best.units(scene.length_m), held.free(best), scene.outline)


def coarse_cost(scene: Scene, surface: Surface) -> float:
    """Of a surface's residuals, heavy-tailed, at a scale that noise and a real object's flaws are within."""
    residual = depths_of(scene.patch, scene.pixels).predict(surface).residual
    cost = float(cauchy(residual / COST_SCALE)[0].sum())
    if scene.outline is not None:
        cost += float(cauchy(scene.outline.predict(surface).residual)[0].sum())
    return cost if np.isfinite(cost) else np.inf

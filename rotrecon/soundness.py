"""Whether what a surface was fitted to is round at all, and is one object: what the picture of its depths says."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.limbs import limbs_of
from rotrecon.rays.losses import MEDIAN_LOSS, TO_SIGMA
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import RayFit

AGREES_SIGMA = 4.0
"""Residuals within which a depth agrees with the surface."""
AGREES_RADIUS = 0.08
"""Depths nearer to the surface than this share of its radius agree too: real objects are not that round."""
BEYOND_PX = (3.0, 5.0, 7.0)
"""Outside the outline, where the object must have ended: farther than windows reach."""
GOES_ON = 0.5
"""Radii behind the limb before which a pixel outside the outline still belongs to the same thing."""
PATTERN_RAD, PATTERN_BINS, PATTERN_FEWEST = float(np.deg2rad(66.0)), 10, 5
"""Angles that are compared, in so many bins of so many pixels at least: limbs have flaws of their own."""
LIMBS = 80


@dataclass(frozen=True, eq=False)
class Soundness:
    """How a fit stands up to all depths that it should explain."""

    inlier_share: float
    """Of the known depths inside the outline, those that agree."""
    roughness: float
    """Spread of the depths that agree, along the ray, over the radius, as far as neighbours deviate alike."""
    pattern: float
    """How much of what is left follows the angle at which the surface is hit, over the radius: flats and edges do."""
    arc_rad: float
    """How far round the axis depths agree."""
    ended: tuple[float, float]
    """Share of either side's outline beyond which something far behind is seen."""
    goes_on: tuple[float, float]
    """Share of either side's outline beyond which the same surface goes on."""
    agreeing: Bools
    """(N,) pixels of the patch that agree."""

    def __post_init__(self) -> None:
        freeze(self)


def soundness_of(fit: RayFit, patch: Patch, heights_m: tuple[float, float]) -> Soundness:
    """The soundness of a fit between two heights along its axis; of a ball everywhere."""
    surface = fit.surface
    depth_m, hit = surface.meet(patch.rays)
    known = patch.drawn & hit & np.isfinite(patch.depth_m)
    points = patch.rays * depth_m
    if isinstance(surface, Lateral):
        height = surface.turn[2] @ (points - surface.center_m[:, None])
        known &= (height >= heights_m[0]) & (height <= heights_m[1])
    behind_m = np.abs(patch.depth_m - depth_m)
    sigma_m = fit.sigma * patch.noise.sigma_m(depth_m)
    agreeing = known & (behind_m < np.maximum(AGREES_SIGMA * sigma_m, AGREES_RADIUS * surface.size_m))
    ended, goes_on = _beyond(fit, patch, heights_m)
    return Soundness(
        inlier_share=float(agreeing.sum() / max(known.sum(), 1)),
        roughness=_roughness(fit, sigma_m[agreeing]),
        pattern=_pattern(fit, points[:, fit.pixels], fit.residual * patch.noise.sigma_m(depth_m[fit.pixels])),
        arc_rad=_arc(fit, points[:, agreeing]),
        ended=ended,
        goes_on=goes_on,
        agreeing=agreeing,
    )


def _roughness(fit: RayFit, sigma_m: Floats) -> float:
    if len(sigma_m) == 0:
        return np.inf
    return float(np.sqrt(fit.likeness.alike) * np.median(sigma_m)) / fit.surface.size_m


def _pattern(fit: RayFit, points: Floats, behind_m: Floats) -> float:
    """Root mean square of the median residual (n,) of bins of the angle at which points (3, n) are hit, less noise."""
    angle = _angle(fit, points)
    widest = min(PATTERN_RAD, float(np.arcsin(min(fit.sight.guard, 1.0))))
    edges = np.linspace(-widest, widest, PATTERN_BINS + 1)
    number = np.digitize(angle, edges) - 1
    bins = [behind_m[number == each] for each in range(PATTERN_BINS)]
    bins = [one for one in bins if len(one) >= PATTERN_FEWEST]
    if not bins:
        return np.inf
    medians = np.array([np.median(one) for one in bins])
    noise = [
        (MEDIAN_LOSS * TO_SIGMA * np.median(np.abs(one - middle))) ** 2 / len(one)
        for one, middle in zip(bins, medians, strict=True)
    ]
    # over a narrower range the same flats show less
    return PATTERN_RAD / widest * float(np.sqrt(max(np.mean(medians**2) - np.mean(noise), 0.0))) / fit.surface.size_m


def _angle(fit: RayFit, points: Floats) -> Floats:
    """Angle (n,) round the axis of points (3, n), 0 toward the camera; of a ball from the line of sight."""
    surface = fit.surface
    offset = points - surface.center_m[:, None]
    if isinstance(surface, Lateral):
        return np.arctan2(surface.turn[0] @ offset, -surface.side * (surface.turn[1] @ offset))
    toward = -surface.center_m / np.linalg.norm(surface.center_m)
    return np.arccos(np.clip(toward @ offset / surface.radius_m, -1, 1))


def _arc(fit: RayFit, points: Floats) -> float:
    """Angle round the axis, or round the centre of a ball in its widest section, that points (3, n) span."""
    if points.shape[1] == 0:
        return 0.0
    angle = _angle(fit, points)
    if not isinstance(fit.surface, Lateral):
        return 2 * float(np.percentile(angle, 98))
    low, high = np.percentile(angle, [1, 99])
    return float(high - low)


def _beyond(
    fit: RayFit, patch: Patch, heights_m: tuple[float, float]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Shares of the outline's two sides beyond which the background is seen, and the same surface."""
    surface = fit.surface
    if surface.side > 0:
        return (0.0, 0.0), (0.0, 0.0)
    limbs = limbs_of(surface, patch.camera, np.linspace(*heights_m, LIMBS))
    side = limbs.side if isinstance(surface, Lateral) else (limbs.along > np.pi).astype(np.int32)
    place = limbs.point_px[:, None] + np.array(BEYOND_PX)[:, None] * limbs.normal_px[:, None]
    pixel = patch.pixel_of(place.reshape(-1, 2)).reshape(-1, len(BEYOND_PX))
    behind = np.where(pixel >= 0, patch.depth_m[pixel], np.nan) - limbs.depth_m[:, None]
    far = np.nanmax(np.where(np.isfinite(behind), behind, -np.inf), axis=1, initial=-np.inf) > GOES_ON * surface.size_m
    same = (np.abs(behind) <= GOES_ON * surface.size_m).sum(axis=1) >= 2

    def share(which: Bools) -> tuple[float, float]:
        first, second = (float(which[side == number].mean()) if (side == number).any() else 0.0 for number in (0, 1))
        return first, second

    return share(far & ~same), share(same)

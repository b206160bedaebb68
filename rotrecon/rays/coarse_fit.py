"""A surface on its way from a start: some of the pixels, a heavy-tailed loss, and then the edges of the outline."""

from dataclasses import replace

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices
from rotrecon.drawing import CrossSegments
from rotrecon.rays.fitting import Measurement, Outline, refine
from rotrecon.rays.losses import TO_SIGMA, cauchy, robust_scale
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import depths_of, spread
from rotrecon.rays.surfaces import Surface

COARSE_PIXELS = 1200
"""Enough to find the way; the fine rounds take all."""
COARSE_SCALE = 0.2
"""First scale of the coarse rounds over the radius, along the ray."""
SHRINK = 4.0
"""From one scale to the next."""
LAST_SCALE = 2.0
"""The coarse rounds end at this multiple of the noise."""
OUTLINE_SCALE = 0.1
"""Scale of the outline's residuals over that of the depths in coarse rounds, at least one sigma."""
FOLLOWED_PX, FOLLOWED_SHARE = (4.0, 1.0), 0.2
"""Scales at which a surface first follows the edges, and the share of its depths that have a say meanwhile."""
COARSE_ITERATIONS, FOLLOWING_ITERATIONS = 6, 10
LIMB_SHARE = 0.1
"""Of a section, at each side."""


def coarse(
    start: Surface,
    patch: Patch,
    pixels: Indices,
    units: Floats,
    free: Bools,
    outline: Outline | None,
) -> Surface:
    """A surface after rounds over some pixels, from a start down to the scale of what is left."""
    depths = depths_of(patch, pixels)
    measurements: list[Measurement] = [depths, *([outline] if outline is not None else [])]
    sigma_m = float(np.median(patch.noise.sigma_m(patch.depth_m[pixels])))
    scale, surface = max(COARSE_SCALE * start.size_m / sigma_m, LAST_SCALE), start
    while True:
        weighting = [(scale, 1.0), (max(OUTLINE_SCALE * scale, 1.0), 1.0)][: len(measurements)]
        refined = refine(surface, measurements, weighting, cauchy, free, units, COARSE_ITERATIONS)
        surface = refined.surface
        left = TO_SIGMA * float(np.median(np.abs(depths.predict(surface).residual)))
        if max(left, LAST_SCALE) >= scale / 2:
            return surface
        scale = max(scale / SHRINK, left, LAST_SCALE)


def follow(
    surface: Surface,
    patch: Patch,
    pixels: Indices,
    units: Floats,
    free: Bools,
    outlines: tuple[Outline, Outline | None],
) -> Surface:
    """A surface moved until its outline is where edges are, some of its depths and the mask's outline having a say."""
    depths = depths_of(patch, spread(pixels, int(FOLLOWED_SHARE * len(pixels))))
    scale = max(robust_scale(depths.predict(surface).residual), LAST_SCALE)
    edges, mask = outlines
    measurements: list[Measurement] = [depths, replace(edges, sigma_px=np.ones(len(edges)))]
    measurements += [] if mask is None else [mask]
    for edge_scale in FOLLOWED_PX:
        weighting = [(scale, 1.0), (edge_scale, 1.0), (edge_scale, FOLLOWED_SHARE)][: len(measurements)]
        surface = refine(surface, measurements, weighting, cauchy, free, units, FOLLOWING_ITERATIONS).surface
    return surface


def coarse_pixels(patch: Patch, segments: CrossSegments, kept: Bools) -> Indices:
    """Some of the segmented pixels, evenly, without those nearest to the limbs, whose depth is believed least.

    `kept` (S, W) are the segmented cells.
    """
    count = kept.sum(axis=1, keepdims=True)
    rank = kept.cumsum(axis=1)
    inner = kept & (rank > LIMB_SHARE * count) & (rank <= (1 - LIMB_SHARE) * count)
    width = patch.camera.width
    place = np.stack(np.divmod(segments.pixel[inner], width)[::-1], axis=-1)
    usable = np.zeros(len(patch.depth_m), dtype=np.bool_)
    usable[patch.pixel_of(place.astype(np.float64))] = True
    return spread(np.flatnonzero(usable & np.isfinite(patch.depth_m)).astype(np.int32), COARSE_PIXELS)

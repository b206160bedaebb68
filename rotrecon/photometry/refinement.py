"""A fitted surface refined until the pictures of several cameras agree over it, outlines in all of them included."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.frame import Frame
from rotrecon.photometry.carrying import carrier_of
from rotrecon.photometry.matches import FEWEST_PIXELS, Other, matches_of
from rotrecon.photometry.outlines import CarriedOutline, outline_in
from rotrecon.photometry.sharpening import sharpened
from rotrecon.photometry.sureness import covariance_of
from rotrecon.photometry.visible import shown
from rotrecon.rays.fitting import Loss, Measurement, cauchy, refine, tukey
from rotrecon.rays.hypotheses import Scene
from rotrecon.rays.limbs import seen_outline
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import RayFit, Sight, predicted, spread
from rotrecon.rays.surfaces import Ball, Surface
from rotrecon.turned.turned import Turned

ROUNDS: tuple[tuple[Loss, int], ...] = ((cauchy, 3000), (tukey, 12000))
"""Loss and most pixels, of all views together: some of them are enough to find the way. Each chooses them anew."""
ITERATIONS = 8
MOVED_PIXELS = 500
"""Enough to tell how far a surface moved."""
SOUGHT_AGAIN_PX = 1.0
"""A surface whose outline moved by more may have been given the wrong edges."""
SHARP_SHARE = 0.3
"""Of the pixels that a fit rests on, how many must have a depth from the pictures to take their place."""
FARTHEST_PX = 4.0
"""Pictures are matched to a fraction of a pixel; a surface that moves by more has lost its way."""


@dataclass(frozen=True, eq=False)
class Refinement:
    """A fit as the pictures have it."""

    fit: RayFit
    """Its pixels are those whose depth the pictures tell, if there are enough."""
    depth_m: Floats
    """(N,) of the patch: what the pictures tell where they do, what was matched elsewhere."""

    def __post_init__(self) -> None:
        freeze(self)


def refined(fit: RayFit, scene: Scene, frame: Frame) -> Refinement | None:
    """A fit to matched depth, refined against the views of the frame that the depth comes from.

    None for a frame of fewer than two views, where neither texture nor outlines hold the surface, and for a general
    surface of revolution.
    """
    if len(frame.views) < 2 or isinstance(fit.surface, Turned):
        return None
    others = tuple(Other(view, carrier_of(view, frame.T_base_camera)) for view in frame.views[1:])
    patch, units = scene.patch, fit.surface.units(scene.length_m)
    surface = sought = fit.surface
    edges = edges_of(surface, scene, others)
    matches = ()
    for loss, most in ROUNDS:
        if _moved_px(sought, surface, patch, others) > SOUGHT_AGAIN_PX:
            sought, edges = surface, edges_of(surface, scene, others)
        matches = matches_of(surface, patch, shown(surface, patch, fit.sigma), others, most)
        measurements: list[Measurement] = [*(match.agreement for match in matches), *edges]
        if not measurements:
            return None
        weighting = [*(match.weighting for match in matches), *((1.0, 1.0) for _ in edges)]
        surface = refine(surface, measurements, weighting, loss, fit.free, units, ITERATIONS).surface
    if not _moved_px(fit.surface, surface, patch, others) < FARTHEST_PX:
        return None
    covariance = covariance_of(surface, matches, edges, fit.free, patch.shape)
    depth_m, known = sharpened(surface, patch, shown(surface, patch, fit.sigma), matches)
    pixels, sight = fit.pixels, fit.sight
    if known.sum() > max(SHARP_SHARE * len(pixels), FEWEST_PIXELS):
        pixels = np.flatnonzero(known).astype(np.int32)
        sight = Sight(guard=float(np.percentile(surface.off_middle(patch.rays[:, pixels]), 95)))
    residual = predicted(replace(patch, depth_m=depth_m), pixels, surface, sight).residual
    better = replace(fit, surface=surface, covariance=covariance, pixels=pixels, sight=sight, residual=residual)
    return Refinement(better, depth_m)


def edges_of(surface: Surface, scene: Scene, others: tuple[Other, ...]) -> list[Measurement]:
    """The outline in all pictures; none of a ball, whose edge is seen too far inside where it is the brighter side."""
    if isinstance(surface, Ball):
        return []
    own = seen_outline(surface, scene.patch, scene.segments, scene.length_m).edges
    points = (scene.patch.rays * surface.trace(scene.patch.rays).depth_m).T[scene.patch.kept]
    low, high = np.percentile(surface.heights(points), [1, 99])
    edges: list[Measurement] = [] if own is None else [own]
    for other in others:
        seen = outline_in(other.view, other.carrier, surface, scene.patch, (float(low), float(high))).edges
        if seen is not None:
            edges.append(CarriedOutline(seen, other.carrier))
    return edges


def _moved_px(before: Surface, after: Surface, patch: Patch, others: tuple[Other, ...]) -> float:
    """How far the points of a surface moved in the other pictures, at most, in the median of the object's pixels."""
    rays = patch.rays[:, spread(np.flatnonzero(patch.kept).astype(np.int32), MOVED_PIXELS)]
    first, second = (surface.trace(rays).depth_m for surface in (before, after))
    moved: list[Floats] = [
        np.linalg.norm(other.carrier.carried(rays, second)[0] - other.carrier.carried(rays, first)[0], axis=0)
        for other in others
    ]
    return float(max(np.nanmedian(one) for one in moved))

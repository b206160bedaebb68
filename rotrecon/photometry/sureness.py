"""How sure a surface is that was fitted to several pictures and to outlines in them."""

from collections.abc import Sequence

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.photometry.agreement import Change
from rotrecon.photometry.matches import Match
from rotrecon.photometry.outlines import Edge
from rotrecon.rays.ball import Ball
from rotrecon.rays.limbs import ARC_POINTS, CIRCLE_ARCS
from rotrecon.rays.losses import TUKEY, tukey
from rotrecon.rays.surfaces import Surface

SYSTEMATIC_PX = 0.005
"""What splines, aliasing and a lens shift one picture against the other by, alike over a part of the object."""
EDGE_PX = 0.03
"""What shading and blur move all edges of an object by, the same way in all pictures."""
UNKNOWN = 0.3
"""Share of its distance by which a surface may be anywhere that no outline tells of."""
OUTLINE_TELLS = 0.02
"""Largest standard error of the radius over the radius that outlines may leave of a plain thing."""
OUTLINES_APART = 0.03
"""Share of the radius by which an outline may lie beside the surface that all outlines of a plain thing agree on best:
more, and one of them is of something else."""
HALF_OF_BALL = CIRCLE_ARCS * ARC_POINTS // 2
"""Points of half an outline."""
PARTS = 4
"""Parts, along each side of the patch, over which that is alike."""


def covariance_of(
    surface: Surface,
    matches: Sequence[tuple[Match, Change]],
    edges: Sequence[Edge],
    free: Bools,
    shape: tuple[int, int],
) -> Floats:
    """Covariance (k, k) H^-1 M H^-1 of errors that are alike (Huber 1967), zero for what is not `free` (k,).

    H is the information that all measurements were weighted with. M is the variance of its gradient: J C J' of the
    pixels, C being the autocorrelation of their residuals; views share the reference picture's noise, so that their
    residuals are alike too; and of a systematic shift of parts of the picture. Edges, whose share is known, have their
    information as variance, and that of a shift of all of them outward. `matches` come with what they have along their
    rays; `shape` is the patch's.
    """
    count = len(free)
    information, variance = np.zeros((count, count)), np.zeros((count, count))
    scaled: list[Floats] = []
    columns: list[Floats] = []
    # a pixel may have been chosen twice
    once = [np.unique(match.pixels, return_index=True) for match, _ in matches]
    for match, change in matches:
        prediction = match.agreement.predict(surface)
        residual, share = prediction.residual / match.sigma, match.likeness.independent_share
        weight = tukey(residual)[1]
        believed = weight > 0
        response = float(_response(residual[believed]).mean())
        own = prediction.columns * believed / match.sigma
        information += share * response * (own @ own.T)
        scaled.append(_placed(weight * residual, match, shape))
        columns.append(share * own)
        shifts = SYSTEMATIC_PX * share * _by_part(own * _texture(change) / match.sigma, match, shape)
        variance += shifts @ shifts.T
    for first, (match, _) in enumerate(matches):
        placed = [match.likeness.smeared(_placed(column, match, shape)) for column in columns[first]]
        smeared = np.stack(placed).reshape(count, -1)
        pixels, _ = once[first]
        pull = scaled[first].ravel()[pixels]
        for (pixels_there, index), there, other in zip(once, columns, scaled, strict=True):
            products = pull * other.ravel()[pixels]
            together = products != 0
            alike = float(products[together].mean()) if together.any() else 0.0
            variance += alike * (there[:, index] @ smeared[:, pixels_there].T)
    outward = np.zeros(count)
    for edge in edges:
        prediction = edge.predict(surface)
        weighted = prediction.columns * tukey(prediction.residual)[1]
        own = weighted @ prediction.columns.T
        information += own
        variance += own
        outward += EDGE_PX * weighted @ (1.0 / edge.sigma_px)
    variance += np.outer(outward, outward)
    covariance = np.zeros((count, count))
    kept = np.ix_(free, free)
    inverse = np.linalg.pinv(information[kept], hermitian=True)
    covariance[kept] = inverse @ ((variance + variance.T) / 2)[kept] @ inverse
    return covariance


def sigma_by_outline(surface: Surface, edges: Sequence[Edge], free: Bools, length_m: float) -> float:
    """Standard error, m, of the radius of a surface so long of which only the outlines in the pictures are known."""
    unit = surface.units(length_m)
    unknown_m = UNKNOWN * float(np.linalg.norm(surface.center_m))
    information = np.diag(1.0 / np.square(unit * unknown_m))
    for edge in edges:
        columns = edge.predict(surface).columns
        information += columns @ columns.T
    held = np.ix_(free, free)
    covariance = np.zeros_like(information)
    covariance[held] = np.linalg.inv(information[held])
    return float(np.sqrt(covariance[surface.size_place, surface.size_place]))


def outlined(surface: Surface, edges: Sequence[Edge], free: Bools, length_m: float) -> bool:
    """Whether outlines alone tell the radius of a surface so long: well enough, alike, and of a ball one of them half.

    What an arc or two of a ball run along may be the border of its light.
    """
    seen = max((len(edge) for edge in edges), default=0)
    if isinstance(surface, Ball) and seen < HALF_OF_BALL:
        return False
    told = sigma_by_outline(surface, edges, free, length_m) < OUTLINE_TELLS * surface.size_m
    return told and off_outline(surface, edges) < OUTLINES_APART


def off_outline(surface: Surface, edges: Sequence[Edge]) -> float:
    """Root mean square distance, over the radius, of the outline that lies farthest from a surface's; 0 for none."""
    half_width_px = surface.size_m / float(surface.center_m[2]) * surface.focal_px
    apart_px = [np.sqrt(np.mean(np.square(edge.predict(surface).residual * edge.sigma_px))) for edge in edges]
    return float(max(apart_px, default=0.0)) / half_width_px


def _texture(change: Change) -> Floats:
    """Change (N,) of the predicted grey values with a shift of the other picture, a pixel."""
    return change.by_depth / np.maximum(change.px_by_depth, 1e-12)


def _by_part(columns: Floats, match: Match, shape: tuple[int, int]) -> Floats:
    """Sums (k, P) over the parts of the patch of columns (k, N)."""
    row, column = np.divmod(match.pixels, shape[1])
    part = row * PARTS // shape[0] * PARTS + column * PARTS // shape[1]
    return np.stack([np.bincount(part, one, PARTS**2).astype(np.float64) for one in columns])


def _placed(values: Floats, match: Match, shape: tuple[int, int]) -> Floats:
    """Values (N,) of the pixels of a match as an image."""
    image = np.zeros(shape)
    image.ravel()[match.pixels] = values
    return image


def _response(residual: Floats) -> Floats:
    """Derivative (N,) of a residual's pull by the residual, both in sigmas (of Tukey's loss)."""
    squared = np.square(residual / TUKEY)
    return (1.0 - squared) * (1.0 - 5.0 * squared)

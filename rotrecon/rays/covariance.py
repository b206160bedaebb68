"""How sure a fit is whose errors are alike."""

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices
from rotrecon.rays.correlation import Likeness
from rotrecon.rays.fitting import Outlines, Prediction
from rotrecon.rays.losses import TUKEY, tukey
from rotrecon.rays.patch import Patch
from rotrecon.rays.surfaces import Surface
from rotrecon.rays.whitening import Whitened

REPEATING = 0.25
"""Likeness of errors above which neighbouring pixels repeat each other."""
ROUGHER = 1.1
"""By how much differences err more than their derivatives say, which at limbs change within an error (measured)."""
TAMED_PX = 0.1
"""Distance from the outline within which depths count as if they were that far inside, where errors are alike."""


def covariance_of_depths(
    depths: Prediction,
    fitted: tuple[Surface, Patch, Indices],
    free: Bools,
    noise: tuple[float, Likeness],
    outlines: Outlines,
) -> Floats:
    """The covariance (k, k) of a surface fitted to depths and outlines; see `_sandwich`.

    `fitted` is the surface with the pixels (N,) of a patch it was fitted to, `noise` the sigma of their residuals and
    how these are alike; `outlines` come each with its independent share.
    """
    (surface, patch, pixels), (sigma, likeness) = fitted, noise
    scaled = depths.residual / sigma
    columns = depths.columns * ((tukey(scaled)[1] > 0) / sigma)
    if likeness.alike > REPEATING:
        columns *= _tamed(surface, patch, pixels, depths.columns)
    product = columns @ _smeared(columns, patch, pixels, likeness).T
    return _sandwich(columns, product, scaled, likeness.independent_share, free, _of_outlines(surface, outlines))


def covariance_of_differences(
    left: Prediction,
    whitened: Whitened,
    fitted: tuple[Surface, Patch, Indices],
    free: Bools,
    noise: tuple[float, Likeness, float],
    outlines: Outlines,
) -> Floats:
    """The same of a surface fitted to what is left of whitened depths; `noise` is of that, with the depths' sigma."""
    (surface, patch, pixels), (sigma, likeness, raw_sigma) = fitted, noise
    scaled = left.residual / sigma
    columns = left.columns * ((tukey(scaled)[1] > 0) / sigma)
    weights = ROUGHER * raw_sigma / sigma * whitened.returned(columns)
    product = weights @ _smeared(weights, patch, pixels, whitened.likeness).T
    return _sandwich(columns, product, scaled, likeness.independent_share, free, _of_outlines(surface, outlines))


def _sandwich(
    columns: Floats, product: Floats, scaled: Floats, share: float, free: Bools, outlines: tuple[Floats, Floats]
) -> Floats:
    """The covariance H^-1 M H^-1 (k, k) of errors that are alike (Huber 1967), zero for what is not `free` (k,).

    H is the information that was weighted with: of the derivatives (k, N) of residuals (N,), both in sigmas, of which
    a share is independent, and of outlines (k, k). M is the variance of its gradient: J C J' of the derivatives, C
    being the autocorrelation of errors, is the product; `outlines` has what they add to H, and to M.
    """
    weight = tukey(scaled)[1]
    believed = weight > 0
    information = share * float(_response(scaled[believed]).mean()) * (columns @ columns.T) + outlines[0]
    spread_of_score = float((weight * scaled) @ (weight * scaled)) / max(float(believed.sum()), 1.0)
    variance = share**2 * spread_of_score * product + outlines[1]
    covariance = np.zeros_like(information)
    kept = np.ix_(free, free)
    inverse = np.linalg.pinv(information[kept], hermitian=True)
    covariance[kept] = inverse @ variance[kept] @ inverse
    return covariance


def _smeared(columns: Floats, patch: Patch, pixels: Indices, likeness: Likeness) -> Floats:
    """Columns (k, N) over some pixels, each convolved with the autocorrelation."""
    smeared = np.empty_like(columns)
    for number, column in enumerate(columns):
        image = np.zeros(patch.shape)
        image.ravel()[pixels] = column
        smeared[number] = likeness.smeared(image).ravel()[pixels]
    return smeared


def _tamed(surface: Surface, patch: Patch, pixels: Indices, columns: Floats) -> Floats:
    """Share (N,) of their derivatives that depths are credited with: next to the outline they grow without limit, and
    errors that are alike in many pixels are not small enough for derivatives to hold."""
    depth_m = patch.depth_m[pixels]
    steepest = np.sqrt(surface.size_m * patch.focal_px / (2 * TAMED_PX * depth_m)) / patch.noise.sigma_m(depth_m)
    by_radius = np.abs(columns[3 if len(columns) == 4 else 4])
    return np.minimum(1.0, steepest / np.maximum(by_radius, 1e-12))


def _response(residual: Floats) -> Floats:
    """Derivative (N,) of a residual's pull by the residual, both in sigmas: less than its weight."""
    squared = np.square(residual / TUKEY)
    return (1.0 - squared) * (1.0 - 5.0 * squared)


def _of_outlines(surface: Surface, outlines: Outlines) -> tuple[Floats, Floats]:
    """What outlines tell (k, k) of a surface, and the variance (k, k) of their pull.

    What a stretch errs by alike pulls as one: it shifts the outline, and hardly turns it.
    """
    count = len(surface.units(1.0))
    information, variance = np.zeros((count, count)), np.zeros((count, count))
    for outline, share in outlines:
        prediction = outline.predict(surface)
        columns, weight = prediction.columns, tukey(prediction.residual)[1]
        own = np.ones(len(outline))
        for edges, alike_px in outline.alike:
            alike = alike_px / outline.sigma_px[edges]
            own[edges] = np.maximum(1.0 - len(edges) * alike**2, 0.0)
            pull = columns[:, edges] @ (weight[edges] * alike)
            variance += share * np.outer(pull, pull)
        information += share * (columns * weight) @ columns.T
        variance += share * (columns * (weight * own)) @ columns.T
    return information, variance

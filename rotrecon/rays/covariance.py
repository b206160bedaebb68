"""How sure a fit is whose errors are alike."""

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices
from rotrecon.rays.correlation import Likeness
from rotrecon.rays.fitting import Outline, Prediction
from rotrecon.rays.losses import TUKEY, tukey
from rotrecon.rays.patch import Patch
from rotrecon.rays.surfaces import Surface

REPEATING = 0.25
"""Likeness of errors above which neighbouring pixels repeat each other."""
TAMED_PX = 0.1
"""Distance from the outline within which depths count as if they were that far inside, where errors are alike."""


def sandwich(
    depths: Prediction,
    fitted: tuple[Surface, Patch, Indices],
    free: Bools,
    noise: tuple[float, Likeness],
    outlines: tuple[tuple[Outline, float], ...],
) -> Floats:
    """The covariance H^-1 M H^-1 (k, k) of errors that are alike (Huber 1967), zero for what is not `free` (k,).

    `fitted` is the surface with the pixels (N,) of a patch it was fitted to, `noise` the sigma of their residuals and
    how these are alike; `outlines` come each with its independent share. H is the information that the depths were
    weighted with, and the outline's; M the variance of its gradient: of the depths J C J' with C their
    autocorrelation, of outlines, whose share is known, their information itself.
    """
    (surface, patch, pixels), (sigma, likeness) = fitted, noise
    scaled, share = depths.residual / sigma, likeness.independent_share
    weight = tukey(scaled)[1]
    by_parameters = depths.columns
    columns = by_parameters * ((weight > 0) / sigma)
    if likeness.alike > REPEATING:
        columns *= _tamed(surface, patch, pixels, by_parameters)
    from_outlines = sum(
        (_information(outline.predict(surface), outline_share) for outline, outline_share in outlines),
        start=np.zeros((len(free), len(free))),
    )
    believed = weight > 0
    information = share * float(_response(scaled[believed]).mean()) * (columns @ columns.T) + from_outlines
    spread_of_score = float((weight * scaled) @ (weight * scaled)) / max(float(believed.sum()), 1.0)
    variance = share**2 * spread_of_score * (columns @ _smeared(columns, patch, pixels, likeness).T) + from_outlines
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


def _information(prediction: Prediction, share: float) -> Floats:
    return share * (prediction.columns * tukey(prediction.residual)[1]) @ prediction.columns.T

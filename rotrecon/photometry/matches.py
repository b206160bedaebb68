"""The pixels of the reference picture that are compared with each other view, and what they err by."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.frame import View
from rotrecon.photometry.agreement import LEAST_SIGMA, Agreement, shades_of
from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.smearing import smeared_apart
from rotrecon.photometry.splines import Spline, smoothed, spline_of, spline_through
from rotrecon.photometry.visible import outward, seen_too
from rotrecon.rays.correlation import Likeness, likeness_of
from rotrecon.rays.limbs import PIXEL_BLUR_PX
from rotrecon.rays.losses import robust_scale
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import INLIER_SIGMA, spread
from rotrecon.rays.surfaces import Surface
from rotrecon.rays.traces import Rays

SMOOTHING_PX = 0.7
"""Standard deviation of the low pass on both pictures: without it noise passes for texture where there is little, and
intervals are half as wide as they should be; with twice as much the limbs reach the inner pixels (both measured)."""
BLUR_PX = float(np.hypot(SMOOTHING_PX, PIXEL_BLUR_PX))
"""With that of a camera's own pixels."""
FEWEST_PIXELS = 100
"""Fewer have no texture to speak of."""


@dataclass(frozen=True, eq=False)
class Other:
    """Another view, and how its camera stands to the reference camera."""

    view: View
    carrier: Carrier


@dataclass(frozen=True, eq=False)
class Own:
    """The reference picture of a patch after the low pass."""

    grey: Floats
    """(N,)"""
    spline: Spline


@dataclass(frozen=True, eq=False)
class Match:
    """Pixels compared with one other view."""

    pixels: Indices
    """(N,) of the patch."""
    agreement: Agreement
    sigma: float
    """Of the residuals, in grey values."""
    likeness: Likeness

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def weighting(self) -> tuple[float, float]:
        """Sigma and independent share."""
        return self.sigma, self.likeness.independent_share


def matches_of(
    surface: Surface, patch: Patch, pixels: Bools, others: tuple[Other, ...], most: int
) -> tuple[Match, ...]:
    """Those of some pixels (N,) of a patch that other views see too, one match a view; none for too few.

    At most `most` pixels are compared, of all views together.
    """
    image, among = smoothed(patch.picture(), SMOOTHING_PX), np.flatnonzero(pixels).astype(np.int32)
    own = Own(image.ravel(), spline_through(image, patch.corner_px))
    rays = np.ascontiguousarray(patch.rays[:, among])
    found = (_match(surface, patch, own, among, rays, other, most // len(others)) for other in others)
    return tuple(match for match in found if match is not None)


def _match(
    surface: Surface, patch: Patch, own: Own, pixels: Indices, rays: Rays, other: Other, most: int
) -> Match | None:
    """Those of some pixels (N,) with rays (3, N) of a patch that another view sees too."""
    seen = seen_too(surface, rays, other.carrier)
    pixels, rays = pixels[seen], np.ascontiguousarray(rays[:, seen])
    if len(pixels) < FEWEST_PIXELS:
        return None
    place_px, _ = other.carrier.carried(rays, surface.meet(rays)[0])
    spline = spline_of(other.view.image, place_px.min(axis=1), place_px.max(axis=1), SMOOTHING_PX)
    pixels = spread(pixels[spline.within(place_px)], most)
    if len(pixels) < FEWEST_PIXELS:
        return None
    rays = np.ascontiguousarray(patch.rays[:, pixels])
    shades = shades_of(outward(surface, rays * surface.meet(rays)[0]))
    # of the reference picture, whose noise is not that of the slopes along which the surface is moved
    place_px, _ = other.carrier.carried(rays, surface.meet(rays)[0])
    rays_there = np.ascontiguousarray(other.view.camera.unproject(place_px.T, np.ones(len(pixels))).T)
    there, back = other.carrier.surface(surface), other.carrier.back(patch.camera)
    brighter = smeared_apart(there, rays_there, other.view.camera, back, own.spline, BLUR_PX)
    agreement = Agreement(rays, own.grey[pixels] + brighter, shades, spline, other.carrier)
    residual = agreement.predict(surface).residual
    sigma = max(robust_scale(residual), LEAST_SIGMA)
    image = np.full(patch.shape, np.nan)
    image.ravel()[pixels] = np.where(np.abs(residual) < INLIER_SIGMA * sigma, residual, np.nan)
    return Match(pixels, agreement, sigma, likeness_of(image))

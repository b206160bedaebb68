"""A surface fitted to all depths of a patch that are compared, and to an outline, each with the weight it has."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.rays.correlation import Likeness, likeness_of
from rotrecon.rays.covariance import REPEATING, covariance_of_depths, covariance_of_differences
from rotrecon.rays.fitting import Depths, MatchedDepths, Measurement, Outlines, Prediction, refine
from rotrecon.rays.losses import TUKEY, robust_scale, tukey
from rotrecon.rays.passing import seen_behind
from rotrecon.rays.patch import Patch
from rotrecon.rays.surfaces import Surface
from rotrecon.rays.whitening import whitened

FINE_ITERATIONS, FINE_ROUNDS = 8, 3
OVERSAMPLED, LEAST_PIXELS = 20.0, 2500
"""Pixels compared for each independent one, and at least: more would only repeat them."""
HASTY_PIXELS = 2500
"""Enough for a first round, evenly; the next takes all that tell something new."""
SETTLED_SIZE = 1e-4
"""A round that changes the radius by less than this share is the last."""
MOST_DIFFERENCES, TILE_PX = 16000, 12
"""Depths that are compared with their neighbours', and the side of the tiles they stand in where there are more."""
PLASTIC = 0.7548776662466927
"""Fractional parts of its multiples and its square's fall evenly in a plane."""
NEAR_PX = 4.0
"""Pixels so far outside the outline still speak for or against it."""
INLIER_SIGMA = 3.0
"""Residuals beyond are not asked how alike they are."""
GOLDEN = 0.6180339887498949
"""Fractional parts of its multiples fall evenly, whatever the picture's own period."""
WHOLE = 1e3
"""A guard that keeps every pixel."""


@dataclass(frozen=True)
class Sight:
    """Which depths are compared, and how they are predicted."""

    window_px: int = 1
    """Side of the matching window that is modelled; 1 for none."""
    guard: float = WHOLE
    """Pixels are left out whose ray passes farther beside the axis than this share of the radius."""
    differences: bool = False
    """Whether depths are compared with their neighbours', so that what these err by too does not count."""
    limited: bool = False
    """Whether rays that see what is far behind limit the size."""

    @property
    def whole(self) -> bool:
        """Whether all depths are taken as they are."""
        return self.window_px == 1 and self.guard >= 1


@dataclass(frozen=True, eq=False)
class RayFit:
    """A surface, and what it rests on."""

    surface: Surface
    sight: Sight
    outlines: Outlines
    """Each with its independent share."""
    free: Bools
    """(k,) parameters that were fitted."""
    pixels: Indices
    """(N,) of the patch, whose depths were compared."""
    residual: Floats
    """(N,) in standard deviations of the noise."""
    sigma: float
    """Of the residuals of those that fit."""
    likeness: Likeness
    own_covariance: Callable[[], Floats]
    """(k, k), zero for what was not fitted; only when asked for, as most fits are merely compared with others."""
    doubt: Floats | float = 0.0
    """(k, k) that is added where other ways to the same parameters differ."""

    def __post_init__(self) -> None:
        freeze(self)

    @cached_property
    def covariance(self) -> Floats:
        """(k, k) of the surface's parameters, zero for what was not fitted."""
        covariance = self.own_covariance() + self.doubt
        covariance.flags.writeable = False
        return covariance

    @property
    def independent(self) -> float:
        """How many of the depths err independently."""
        return len(self.pixels) * self.likeness.independent_share


def fine(
    surface: Surface,
    patch: Patch,
    units: Floats,
    free: Bools,
    sight: Sight,
    outlines: Outlines = (),
) -> RayFit | None:
    """Rounds over the pixels within the outline and close to it; None when there are too few to hold the parameters."""
    share, alike, size_m, judge = 1.0, 0.0, surface.size_m, surface
    pixels: Indices = np.empty(0, dtype=np.int32)
    for round_ in range(FINE_ROUNDS):
        # a guard that followed the surface would let it shrink away from what does not fit
        pixels = near(judge if sight.guard < 1 else surface, patch, patch.drawn & np.isfinite(patch.depth_m), sight)
        if sight.window_px == 1 and alike > REPEATING:
            pixels = spread(pixels, max(int(OVERSAMPLED * share * len(pixels)), LEAST_PIXELS))
        if len(pixels) < 2 * len(units):
            return None
        depths = _measured(patch, pixels, surface, sight)
        sigma, likeness = _noise_of(patch, pixels, depths.predict(surface).residual)
        share, alike = likeness.independent_share, likeness.alike
        hasty = round_ == 0 and len(pixels) > HASTY_PIXELS
        used = spread(np.arange(len(pixels), dtype=np.int32), HASTY_PIXELS) if hasty else None
        others = list[tuple[Measurement, float]](outlines)
        if sight.limited:
            limit, border = seen_behind(surface, patch, sigma)
            others += [(limit, 1.0), (border, 1.0 / max(len(border), 1))]
        measurements = [depths if used is None else depths.chosen(used), *(other for other, _ in others)]
        # those that stand for others have their say
        say = share if used is None else min(share * len(pixels) / len(used), 1.0)
        weighting = [(sigma, say), *((1.0, other_share) for _, other_share in others)]
        surface = refine(surface, measurements, weighting, tukey, free, units, FINE_ITERATIONS).surface
        if abs(surface.size_m - size_m) < SETTLED_SIZE * size_m and not hasty:
            break
        size_m = surface.size_m
    fit = _finished(surface, patch, pixels, free, sight, outlines)
    return by_differences(fit, patch, units, MOST_DIFFERENCES, FINE_ROUNDS) if sight.differences else fit


def by_differences(fit: RayFit, patch: Patch, units: Floats, most: int, rounds: int) -> RayFit:
    """A fit moved to the generalised least squares of about so many of its depths, in so many rounds."""
    surface, own_covariance = fit.surface, fit.own_covariance
    for _ in range(rounds):
        size_m = surface.size_m
        pixels = near(surface, patch, patch.drawn & np.isfinite(patch.depth_m), fit.sight)
        pixels = _tiled(pixels, patch, most)
        if len(pixels) < 2 * len(units):
            break
        raw = depths_of(patch, pixels).predict(surface).residual
        raw_sigma, raw_likeness = _noise_of(patch, pixels, raw)
        pixels = pixels[np.abs(raw) < TUKEY * raw_sigma]
        left = whitened(depths_of(patch, pixels), pixels, patch.shape, raw_likeness)
        sigma, likeness = _noise_of(patch, pixels, left.predict(surface).residual)
        measurements: list[Measurement] = [left, *(outline for outline, _ in fit.outlines)]
        weighting = [(sigma, likeness.independent_share), *((1.0, share) for _, share in fit.outlines)]
        surface = refine(surface, measurements, weighting, tukey, fit.free, units, FINE_ITERATIONS).surface
        told, fitted = left.predict(surface), (surface, patch, pixels)
        noise = (*_noise_of(patch, pixels, told.residual), raw_sigma)
        own_covariance = partial(covariance_of_differences, told, left, fitted, fit.free, noise, fit.outlines)
        if abs(surface.size_m - size_m) < SETTLED_SIZE * size_m:
            break
    residual = predicted(patch, fit.pixels, surface, fit.sight).residual
    return replace(fit, surface=surface, residual=residual, own_covariance=own_covariance)


def _tiled(pixels: Indices, patch: Patch, most: int) -> Indices:
    """About so many of some pixels, in evenly placed tiles (Roberts 2018): most of their neighbours are there too.

    The tiles are the frame's, so that another drawing compares the same pixels.
    """
    share = most / max(len(pixels), 1)
    if share >= 1:
        return pixels
    row, column = np.divmod(patch.frame_pixels(pixels), patch.camera.width)
    place = row // TILE_PX * PLASTIC + column // TILE_PX * PLASTIC**2
    return pixels[place % 1.0 < share]


def _finished(
    surface: Surface,
    patch: Patch,
    pixels: Indices,
    free: Bools,
    sight: Sight,
    outlines: Outlines,
) -> RayFit:
    """A fit that has come to its end."""
    depths = _measured(patch, pixels, surface, sight).predict(surface)
    sigma, likeness = _noise_of(patch, pixels, depths.residual)
    own = partial(covariance_of_depths, depths, (surface, patch, pixels), free, (sigma, likeness), outlines)
    return RayFit(surface, sight, outlines, free, pixels, depths.residual, sigma, likeness, own)


def predicted(patch: Patch, pixels: Indices, surface: Surface, sight: Sight) -> Prediction:
    """What a surface predicts for the depths of some pixels."""
    return _measured(patch, pixels, surface, sight).predict(surface)


def _noise_of(patch: Patch, pixels: Indices, residual: Floats) -> tuple[float, Likeness]:
    """Sigma of those residuals that fit, and how they are alike."""
    sigma = max(robust_scale(residual), 1e-9)
    image = np.full(patch.shape, np.nan)
    image.ravel()[pixels] = np.where(np.abs(residual) < INLIER_SIGMA * sigma, residual, np.nan)
    return sigma, likeness_of(image)


def depths_of(patch: Patch, pixels: Indices) -> Depths:
    """The depths of some pixels."""
    return Depths(patch.rays.take(pixels, axis=1), patch.noise.steps(patch.depth_m[pixels]), patch.noise)


def _measured(patch: Patch, pixels: Indices, surface: Surface, sight: Sight) -> Depths | MatchedDepths:
    """The depths of some pixels, with all pixels of the surface that their windows may reach if those are modelled."""
    if sight.window_px == 1:
        return depths_of(patch, pixels)
    place = near(surface, patch, np.ones(len(patch.area), dtype=np.bool_), Sight(sight.window_px))
    position = np.full(len(patch.area), -1, dtype=np.int32)
    position[place] = np.arange(len(place), dtype=np.int32)
    pixels_there = position[pixels]
    steps = patch.noise.steps(patch.depth_m[pixels])
    return MatchedDepths(
        patch.rays.take(place, axis=1), place, patch.shape, sight.window_px, pixels_there, steps, patch.noise
    )


def near(surface: Surface, patch: Patch, among: Bools, sight: Sight) -> Indices:
    """Pixels within the guard, and within the outline or not farther outside than windows reach and a little more."""
    pixels = np.flatnonzero(among).astype(np.int32)
    if surface.side > 0:
        return pixels
    rays = patch.rays.take(pixels, axis=1)
    if sight.guard < 1:
        return pixels[surface.off_middle(rays) < sight.guard]
    gap_m, depth_m = surface.gap(rays)
    gap_px = gap_m * patch.focal_px / np.maximum(depth_m, 1e-9)
    return pixels[(gap_px < NEAR_PX + sight.window_px / 2) & (depth_m > 0)]


def spread(pixels: Indices, count: int) -> Indices:
    """At most `count` of the pixels, evenly."""
    if len(pixels) <= count:
        return pixels.astype(np.int32)
    return pixels[_spread_places(len(pixels), count)].astype(np.int32)


@lru_cache(maxsize=32)
def _spread_places(many: int, count: int) -> Indices:
    """(count,) in order."""
    places = np.sort((np.arange(count) * GOLDEN % 1.0 * many).astype(np.int32))
    places.flags.writeable = False
    return places

"""Depth where the pictures have texture, finer than a matcher has it: what is left to agree on, pixel by pixel."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.photometry.agreement import Change
from rotrecon.photometry.matches import SMOOTHING_PX, Match
from rotrecon.rays.losses import tukey
from rotrecon.rays.patch import Patch
from rotrecon.rays.surfaces import Surface

WINDOW_PX = 3.0
"""Standard deviation of the window: half as wide as that of a matcher, and smooth."""
TEXTURE_OVER_NOISE = 4.0
"""Least energy of a window's derivatives over that of noise alone: noise that passes for texture pulls depth toward the
surface, by one part in so many."""
BELIEVED = 0.7
"""Least share of a window's weight that the surface and its correction explain; less is something else."""
MOST_PX = 0.75
"""Largest correction: pictures are linear in a shift of less than the width of their texture."""


@dataclass(frozen=True, eq=False)
class Sharpened:
    """Depth of a patch as the pictures have it near a surface."""

    depth_m: Floats
    """(N,) what was matched where they do not have it."""
    known: Bools
    """(N,) where they have it."""
    agreeing: Bools
    """(N,) what agrees with the surface itself, though it may have no texture to tell it from others."""
    textured: float
    """Share of the pixels asked for at which they have it."""
    changes: tuple[Change, ...]
    """What each match has along its rays."""

    def __post_init__(self) -> None:
        freeze(self)


def sharpened(surface: Surface, patch: Patch, among: Bools, matches: tuple[Match, ...]) -> Sharpened:
    """Depth for some pixels (N,) of a patch as the pictures have it near a surface.

    One step of Lucas and Kanade (1981) from the surface's own prediction, over all views at once.
    """
    totals = np.zeros((5, len(patch.drawn)))
    changes = tuple(match.agreement.along_rays(surface) for match in matches)
    for match, change in zip(matches, changes, strict=True):
        scaled, slope = change.residual / match.sigma, change.by_depth / match.sigma
        weight = tukey(scaled)[1]
        # a difference of two pictures has twice the noise of either; for that of its derivative see `SMOOTHING_PX`
        of_noise = weight * np.square(change.px_by_depth / SMOOTHING_PX) / 4.0
        sums = (weight * slope * scaled, weight * slope**2, of_noise, weight, np.ones(len(weight)))
        for image, values in zip(totals, sums, strict=True):
            image[match.pixels] += values
    pull, hold, noise, believed, seen = (_windowed(image.reshape(patch.shape)) for image in totals)
    agree = (believed > BELIEVED * seen) & (noise > 0)
    textured = agree & (hold > TEXTURE_OVER_NOISE * noise)
    noise, hold, believed = (np.where(textured, image, 1.0) for image in (noise, hold, believed))
    step_m = pull / (hold - np.minimum(noise, hold / TEXTURE_OVER_NOISE))
    step_px = np.abs(step_m) * 2.0 * SMOOTHING_PX * np.sqrt(noise / believed)
    known = among & (textured & (step_px < MOST_PX)).ravel()
    depth_m = np.where(known, surface.meet(patch.rays)[0] + step_m.ravel(), patch.depth_m)
    textured = float(known.sum() / max(among.sum(), 1))
    return Sharpened(depth_m, known, among & agree.ravel(), textured, changes)


def _windowed(image: Floats) -> Floats:
    """Means (h, w) over the window of an image (h, w)."""
    rough = image.astype(np.float32)
    return np.asarray(cv2.GaussianBlur(rough, (0, 0), WINDOW_PX, borderType=cv2.BORDER_CONSTANT), dtype=np.float64)

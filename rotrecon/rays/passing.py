"""What lies far behind a surface and is seen beside it: a surface may not be so large that it would hide that."""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.fitting import Outline, Prediction
from rotrecon.rays.losses import tukey
from rotrecon.rays.patch import Patch
from rotrecon.rays.surfaces import Surface
from rotrecon.rays.traces import Rays

BEHIND_SIGMA = 4.0
"""How far behind the object's far side a depth must be, besides."""
AGREEING = 5
"""A depth is believed to be far behind where so many of the 3 x 3 pixels round it are: outliers stand alone."""
EDGE_SIGMA_PX = 1.0
"""How far a pixel's ray may be off what its depth is of; many pixels tell it much better."""
BORDER_SIGMA_PX = 0.5
"""How far all of them together may be."""
REACH_PX = 4.0
"""How far from the outline the border of what lies behind is looked for."""
UNKNOWN_DOUBT = 0.5
"""Standard deviation of where the object ends, over the unknown pixels between it and what lies behind: a limb is too
oblique to be measured more often than what lies behind is, but both are."""
NEIGHBOURS = np.ones((3, 3), dtype=np.uint8)


@dataclass(frozen=True, eq=False)
class Passing:
    """Rays that are seen to pass a surface: a limit of its size, and no measurement of it."""

    rays: Rays
    focal_px: float

    def __post_init__(self) -> None:
        freeze(self)

    def predict(self, surface: Surface) -> Prediction:
        """How far the rays pass inside its outline, in the picture; those that do not ask for nothing."""
        tangency = surface.tangency(self.rays)
        scale = self.focal_px / (tangency.depth_m * EDGE_SIGMA_PX)
        residual = np.maximum(-tangency.gap_m * scale, 0.0)
        return Prediction(tangency.gradient, tangency.scale * scale * (residual > 0), residual)


def seen_behind(surface: Surface, patch: Patch, sigma: float) -> tuple[Passing, Outline]:
    """The rays of a patch's drawn pixels that see what is farther than a surface's far side, and the border of these.

    The border is where the object ends if what is unknown beside it is its limb, which is said vaguely: all of it
    together counts as one measurement. `sigma` is that of the depths' residuals, in standard deviations of the noise.
    """
    gap_m, nearest_m = surface.gap(patch.rays)
    known = np.isfinite(patch.depth_m)
    least_m = nearest_m + surface.size_m + BEHIND_SIGMA * sigma * patch.noise.sigma_m(nearest_m)
    far = known & (patch.depth_m > least_m)
    around = cv2.filter2D(_image(far, patch), -1, NEIGHBOURS, borderType=cv2.BORDER_CONSTANT)
    behind = np.asarray(around).ravel() >= AGREEING
    within = np.asarray(cv2.erode(_image(behind, patch), NEIGHBOURS)).ravel() > 0
    unknown_px = np.asarray(cv2.distanceTransform(1 - _image(known & ~far, patch), cv2.DIST_L2, 3)).ravel() - 1.0
    believed = far & behind & patch.drawn
    # outliers leave holes in what lies behind, whose borders are elsewhere
    border = believed & ~within & (np.abs(gap_m) * patch.focal_px < REACH_PX * nearest_m)
    sigma_px = np.maximum(UNKNOWN_DOUBT * unknown_px[border], BORDER_SIGMA_PX).astype(np.float64)
    return Passing(_rays(believed, patch), patch.focal_px), Outline(_rays(border, patch), sigma_px, patch.focal_px)


def pull_of(surface: Surface, patch: Patch, sigma: float) -> Floats:
    """How what is seen behind a surface pulls at its parameters (k,): the negative gradient of its cost."""
    limit, border = (measured.predict(surface) for measured in seen_behind(surface, patch, sigma))
    of_limit, of_border = (one.columns @ (tukey(one.residual)[1] * one.residual) for one in (limit, border))
    return of_limit + of_border / max(len(border.residual), 1)


def _image(pixels: Bools, patch: Patch) -> np.ndarray[Any, np.dtype[np.uint8]]:
    return pixels.reshape(patch.shape).astype(np.uint8)


def _rays(pixels: Bools, patch: Patch) -> Floats:
    return np.ascontiguousarray(patch.rays[:, pixels])

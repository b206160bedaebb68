"""How far the segmented depths lie off the solid, pixel by pixel, and their colours."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Bytes, Floats, Indices, freeze
from rotrecon.outcome import Fit
from rotrecon.reconstruction import Reconstruction

BEHIND, BETWEEN, BEFORE = (0, 114, 178), (247, 247, 247), (213, 94, 0)
"""Blue, white and vermilion of Okabe and Ito's colours, which the colour-blind tell apart."""
WIDEST_SHARE = 95.0
"""Per cent of the residuals within the scale: outliers would leave no colours for the others."""
STEPS_M = (0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1)
"""Ends that a scale may have: round numbers."""


@dataclass(frozen=True, eq=False)
class Residuals:
    """Of n pixels, positive outside the surface."""

    pixel: Indices
    """(n,) index into the flattened frame."""
    off_m: Floats
    """(n,) orthogonal."""
    scale_m: float
    """Where the colours end."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def colors(self) -> Bytes:
        """(n, 3) RGB: blue inside the surface, white on it, vermilion outside."""
        share = np.clip(self.off_m / self.scale_m, -1, 1)[:, None]
        end = np.where(share < 0, np.array(BEHIND), np.array(BEFORE))
        mixed = (1 - np.abs(share)) * np.array(BETWEEN) + np.abs(share) * end
        return np.rint(mixed).astype(np.uint8)


def residuals_of(result: Reconstruction) -> Residuals | None:
    """The residuals of the pixels in sections; None where nothing was fitted."""
    if not isinstance(result.fit, Fit) or result.sections is None:
        return None
    all_sections: Bools = np.ones(len(result.sections.start) - 1, dtype=np.bool_)
    off_m = result.fit.solid.distance(result.sections.points_of(all_sections).astype(np.float64))
    if len(off_m) == 0:
        return None
    widest_m = float(np.percentile(np.abs(off_m), WIDEST_SHARE))
    scale_m = next((step for step in STEPS_M if step >= widest_m), STEPS_M[-1])
    return Residuals(result.sections.pixel, off_m, scale_m)


def with_residuals(image: Bytes, residuals: Residuals) -> Bytes:
    """The image (H, W, 3) with every pixel of the object in the colour of its residual."""
    drawn = image.copy()
    drawn.reshape(-1, 3)[residuals.pixel] = residuals.colors
    return drawn

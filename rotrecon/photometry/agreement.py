"""How far two views agree in brightness over a surface, pixel by pixel of the reference picture."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.splines import Spline
from rotrecon.rays.fitting import Prediction, robust_scale, tukey
from rotrecon.rays.surfaces import Rays, Surface

BRIGHTNESS_ROUNDS = 2
"""Reweighted rounds for gain and offset: the surface's own rounds go on from there."""
LEAST_SIGMA = 1e-6
"""Grey; of pictures that agree to the last digit."""


@dataclass(frozen=True, eq=False)
class Agreement:
    """Grey values of the reference picture, which the other one has where the surface carries them.

    Gain and offset between the pictures are found anew for every surface, and the derivatives are those at the best
    gain and offset (variable projection, Kaufman 1975).
    """

    rays: Rays
    """(3, N) of the reference camera."""
    grey: Floats
    """(N,) of its picture, there."""
    other: Spline
    """The other view's picture."""
    carrier: Carrier

    def __post_init__(self) -> None:
        freeze(self)

    def __len__(self) -> int:
        return len(self.grey)

    def predict(self, surface: Surface) -> Prediction:
        """Residuals and derivatives in grey values."""
        trace = surface.trace(self.rays)
        place_px, by_depth = self.carrier.carried(self.rays, trace.depth_m)
        seen = self.other.at(place_px)
        columns = trace.columns * (seen.by_u * by_depth[0] + seen.by_v * by_depth[1])
        return self._balanced(seen.grey, np.nan_to_num(columns))

    def _balanced(self, seen: Floats, columns: Floats) -> Prediction:
        """Prediction with gain and offset taken out."""
        terms = np.stack([self.grey - self.grey.mean(), np.ones(len(self.grey))])
        weight = np.ones(len(self.grey))
        weighted, inverse, residual = terms, np.empty((2, 2)), seen
        for _ in range(BRIGHTNESS_ROUNDS + 1):
            weighted = terms * weight
            inverse = np.linalg.pinv(weighted @ terms.T, hermitian=True)
            residual = (inverse @ (weighted @ seen)) @ terms - seen
            weight = tukey(residual / max(robust_scale(residual), LEAST_SIGMA))[1]
        return Prediction(residual, columns - (columns @ weighted.T) @ inverse @ terms)

    def chosen(self, index: Indices | Bools) -> "Agreement":
        """Some of the pixels."""
        return replace(self, rays=self.rays[:, index], grey=self.grey[index])

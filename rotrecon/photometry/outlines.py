"""The outline of a surface in the picture of another camera, tied to it in the reference camera's coordinates."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices
from rotrecon.frame import View
from rotrecon.photometry.carrying import Carrier
from rotrecon.rays.fitting import UNSCALED, Outline, Prediction
from rotrecon.rays.limbs import SeenOutline, edges_at, limbs_of
from rotrecon.rays.patch import Patch
from rotrecon.rays.surfaces import Surface

HEIGHTS = 241
"""Heights at which an outline is looked for: as many as in the reference picture."""


@dataclass(frozen=True, eq=False)
class CarriedOutline:
    """Rays of another camera seen to graze the surface."""

    outline: Outline
    """In that camera's coordinates."""
    carrier: Carrier

    def __len__(self) -> int:
        return len(self.outline)

    @property
    def sigma_px(self) -> Floats:
        """(N,)"""
        return self.outline.sigma_px

    def predict(self, surface: Surface) -> Prediction:
        """As of an outline, for the carried surface."""
        there = self.outline.predict(self.carrier.surface(surface))
        return Prediction(self.carrier.columns(there.columns, surface), UNSCALED, there.residual)

    def chosen(self, index: Indices | Bools) -> "CarriedOutline":
        """Some of the edges."""
        return replace(self, outline=self.outline.chosen(index))


Edge = Outline | CarriedOutline
"""An outline in the reference picture, or in another."""


def outline_in(
    view: View, carrier: Carrier, surface: Surface, patch: Patch, heights_m: tuple[float, float]
) -> SeenOutline:
    """The edges in another picture near the outline of a surface between two heights; none of one seen from inside."""
    there = carrier.surface(surface)
    patch_there = replace(patch, camera=view.camera, image=view.image)
    limbs = limbs_of(there, view.camera, np.linspace(*heights_m, HEIGHTS))
    return edges_at(limbs, there, patch_there)

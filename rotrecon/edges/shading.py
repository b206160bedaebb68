"""How a turned surface's light changes across its outline's inner side."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.compiled import COUNT, CUBE, FLOAT, MATRIX, VECTOR, compiled

BENT_SHARE = 0.5
"""Of an even surface's light, how much changes from its middle to its limb in the root of the distance: about as much
as comes from a lamp beside the camera."""
NOISE = 0.0017
"""Of linear light, of 1: what a mean along the outline errs by, as blur and Lambert's law leave that much."""
LEAST_VARIANCE = 1e-6
"""Of the amount of root that is expected: black things have none."""


@dataclass(frozen=True, eq=False)
class Shading:
    """How a turned surface's light changes toward its limb, the same all along the stretch.

    Light by Lambert's law is linear in the surface's normal, which turns away with the root of the distance from the
    limb: a line and that root are fitted to what is seen between the zone beside the edge and the object's middle.
    """

    across_px: Floats
    """(T,) where it is wanted."""
    zone: int
    """How many of the first of these are where levels are taken."""
    half_width_px: float
    seen_px: Floats
    """(D,) where it was seen."""
    light: Floats
    """(3, D) that was seen there."""
    doubt: Floats
    """(3,) variance of what was seen, over that of the root's amount that is expected."""

    def at(self, place_px: Floats) -> Floats:
        """Light (K, T, 3), linear, over the mean of the zone, with the limb at one of K places."""
        return _at(place_px, self.across_px, self.zone, self.half_width_px, self.seen_px, self.light, self.doubt)


@compiled(FLOAT, VECTOR, FLOAT)
def _bent(place_px: float, across_px: Floats, half_width_px: float) -> Floats:
    """Cosine (D,) of the surface's angle to the picture's plane across the stretch, with the limb at a place."""
    bent = np.empty(len(across_px))
    for i in range(len(across_px)):
        depth = min(max((place_px - across_px[i]) / half_width_px, 0.0), 1.0)
        bent[i] = np.sqrt(depth * (2 - depth))
    return bent


@compiled(VECTOR, VECTOR, COUNT, FLOAT, VECTOR, MATRIX, VECTOR)
def _at(
    place_px: Floats, across_px: Floats, zone: int, half_width_px: float, seen_px: Floats, light: Floats, doubt: Floats
) -> Floats:
    """See `Shading.at`: what of the root is no straight line is fitted to what of the light is none."""
    shape = np.empty((len(place_px), len(across_px), 3))
    off = seen_px - seen_px.mean()
    slopes = off / (off * off).sum()
    for k in range(len(place_px)):
        seen_bent, bent = _bent(place_px[k], seen_px, half_width_px), _bent(place_px[k], across_px, half_width_px)
        bent_slope = (seen_bent * slopes).sum()
        own = seen_bent - seen_bent.mean() - bent_slope * off
        for c in range(3):
            amount = (own * light[c]).sum() / ((own * own).sum() + doubt[c])
            slope = (light[c] * slopes).sum() - bent_slope * amount
            line = bent * amount + across_px * slope
            shape[k, :, c] = line - line[:zone].mean()
    return shape


@compiled(CUBE)
def _medians(values: Floats) -> Floats:
    """Medians (3, D) of values (3, D, N)."""
    found = np.empty(values.shape[:2])
    for i in range(values.shape[0]):
        for j in range(values.shape[1]):
            found[i, j] = np.median(values[i, j])
    return found


def shading_of(
    across_px: Floats, zone: int, half_width_px: float, seen_px: Floats, seen: Floats, independent: float
) -> Shading:
    """From light (3, D, N) at distances (D,), the last of which are the zone's; so many of the N are independent."""
    light = _medians(seen)
    expected = BENT_SHARE * np.abs(light).mean(axis=1)
    variance = (seen - light[..., None]).var(axis=(1, 2)) / independent + NOISE**2
    # on what is too narrow to be seen farther inside, blur would pass for shading
    told = len(seen_px) > zone
    doubt = variance / np.maximum(expected**2, LEAST_VARIANCE) if told else np.full(3, np.inf)
    return Shading(across_px, zone, half_width_px, seen_px, light, doubt)

"""How a turned surface's light changes across its outline's inner side."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats

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
    zone: Bools
    """(T,) where levels are taken."""
    half_width_px: float
    seen_px: Floats
    """(D,) where it was seen."""
    light: Floats
    """(D, 3) that was seen there."""
    doubt: Floats
    """(3,) variance of what was seen, over that of the root's amount that is expected."""

    def at(self, place_px: Floats) -> Floats:
        """Light (K, T, 3), linear, over the mean of the zone, with the limb at one of K places."""
        line = np.stack([np.ones(len(self.seen_px)), self.seen_px], axis=1)
        fit = np.linalg.pinv(line)
        bent = self._bent(place_px, self.seen_px)
        own = bent - bent @ fit.T @ line.T
        amount = (own @ self.light) / ((own**2).sum(axis=1)[:, None] + self.doubt)
        slope = fit[1] @ self.light - (bent @ fit[1])[:, None] * amount
        shape = self._bent(place_px, self.across_px)[..., None] * amount[:, None]
        shape = shape + self.across_px[:, None] * slope[:, None]
        return shape - shape[:, self.zone].mean(axis=1, keepdims=True)

    def _bent(self, place_px: Floats, across_px: Floats) -> Floats:
        """Cosine (K, D) of the surface's angle to the picture's plane across the stretch."""
        depth = ((place_px[:, None] - across_px) / self.half_width_px).clip(0, 1)
        return np.sqrt(depth * (2 - depth))


def shading_of(
    across_px: Floats, zone: Bools, half_width_px: float, seen_px: Floats, seen: Floats, independent: float
) -> Shading:
    """From light (N, D, 3) at distances (D,), the last of which are the zone's; so many of the N are independent."""
    light = np.median(seen, axis=0)
    expected = BENT_SHARE * np.abs(light).mean(axis=0)
    variance = (seen - light).var(axis=(0, 1)) / independent + NOISE**2
    # on what is too narrow to be seen farther inside, blur would pass for shading
    told = len(seen_px) > np.count_nonzero(zone)
    doubt = variance / np.maximum(expected**2, LEAST_VARIANCE) if told else np.full(3, np.inf)
    return Shading(across_px, zone, half_width_px, seen_px, light, doubt)

"""Where rays from the camera meet surfaces, and how that depends on the surfaces' parameters."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.compiled import FLOAT, compiled

GRAZING_PX = 0.02
"""Rays that pass nearer to an outline go on along their tangent: at the outline itself the depth grows with the root of
the distance, and its derivative without limit. A larger value biases sizes, by 0.2 % of a leg at a quarter."""

FLANK = 1e-9
"""Least leading coefficient of the quadratic of a ray."""
SMALLEST = 1e-12
"""Least discriminant that is told from zero, m^2."""

Range = tuple[float, float]
Rays = Floats
"""(3, N) x, y and 1: directions in camera coordinates, with z = 1, so that the parameter along them is depth."""


@dataclass(frozen=True, eq=False)
class Derivatives:
    """Of N numbers by the k parameters of a surface, in two factors, for most uses need not multiply them out."""

    gradient: Floats
    """(k, N)"""
    scale: Floats
    """(N,) or (), of all k alike."""

    @property
    def columns(self) -> Floats:
        """(k, N) the derivatives."""
        return self.gradient * self.scale


@dataclass(frozen=True, eq=False)
class Trace(Derivatives):
    """Where rays meet a surface, in which a ray that misses is continued smoothly beyond the outline.

    The derivatives are those of the depth.
    """

    depth_m: Floats
    """(N,) along z."""
    hit: Bools
    """(N,) which rays truly meet it."""


@dataclass(frozen=True, eq=False)
class Tangency(Derivatives):
    """How far rays pass outside a surface, negative for those that meet it; the derivatives are those of the gap."""

    gap_m: Floats
    """(N,)"""
    depth_m: Floats
    """(N,) along z, of the point of the ray that is nearest to the surface."""


@compiled(FLOAT, FLOAT, FLOAT, FLOAT, FLOAT)
def root_of(a: float, b: float, c: float, side: float, grazing_disc: float) -> tuple[float, float, bool]:
    """The near (-1) or far (+1) root z of a z^2 + 2 b z + c, the root of its discriminant, and whether it has one.

    Below the grazing value of the discriminant z goes on along its tangent, so that a ray that misses still pulls.
    """
    disc, least = b * b - a * c, max(grazing_disc, SMALLEST)
    root = np.sqrt(max(disc, least))
    reach = side * root
    if disc < least:
        reach += side * (disc - least) / (2 * root)
    return (reach - b) / a, root, disc > 0


def limited(value: float, limits: Range | None) -> float:
    """The value, or the limit that it lies beyond."""
    return value if limits is None else min(max(value, limits[0]), limits[1])

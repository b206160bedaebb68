"""Rays in the coordinates of a surface of revolution, and where they stand to cones about its axis."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Floats, Indices
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.traces import Rays

FLANK = 1e-9
"""Least magnitude of the leading coefficient of a ray's quadratic: a ray along a cone's flank has none."""


@dataclass(frozen=True, eq=False)
class Lines:
    """Rays in the surface's own coordinates: origin + depth * turned."""

    origin: Floats
    """(3,)"""
    turned: Floats
    """(3, N)"""
    square: Floats
    """(N,) of the turned rays' distance from the axis per depth."""
    mixed: Floats
    """(N,)"""

    @staticmethod
    def of(surface: Lateral, rays: Rays) -> "Lines":
        """Rays (3, N) in the coordinates of a surface."""
        turned, origin = surface.turn @ rays, -surface.turn @ surface.center_m
        square = turned[0] * turned[0] + turned[1] * turned[1]
        return Lines(origin, turned, square, origin[0] * turned[0] + origin[1] * turned[1])

    def chosen(self, index: Indices) -> "Lines":
        """Some of the rays."""
        return Lines(self.origin, self.turned[:, index], self.square[index], self.mixed[index])

    def height(self, depth: Floats) -> Floats:
        """Heights (N,) along the axis at depths (N,)."""
        return self.origin[2] + depth * self.turned[2]

    def aside(self, depth: Floats) -> tuple[Floats, Floats]:
        """Offsets (N,) from the axis, across and toward the camera, at depths (N,)."""
        return self.origin[0] + depth * self.turned[0], self.origin[1] + depth * self.turned[1]

    def quadratic(self, height: Floats, radius: Floats, slope: Floats) -> tuple[Floats, Floats, Floats]:
        """a, b, c of a z^2 + 2 b z + c for every ray with its own cone, of a radius and a slope at a height."""
        at_origin = radius + slope * (self.origin[2] - height)
        growth = slope * self.turned[2]
        a = self.square - growth * growth
        a = np.where(np.abs(a) < FLANK, FLANK, a)
        return a, self.mixed - at_origin * growth, self.origin[0] ** 2 + self.origin[1] ** 2 - at_origin * at_origin

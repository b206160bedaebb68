"""Spheres that can be fitted."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.ball_rays import crossings, nearest
from rotrecon.rays.traces import GRAZING_PX, Range, Rays, Tangency, Trace, limited


@dataclass(frozen=True, eq=False)
class Ball:
    """A sphere."""

    center_m: Floats
    """(3,)"""
    radius_m: float
    focal_px: float
    side: Literal[-1, 1] = -1
    limits_m: Range | None = None
    """Of the radius, which no step leaves."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def size_place(self) -> int:
        """Which of the parameters the radius is."""
        return 3

    @property
    def size_m(self) -> float:
        """The radius."""
        return self.radius_m

    def units(self, length_m: float) -> Floats:
        """(4,) ones: every parameter is a length."""
        return np.ones(4)

    def trace(self, rays: Rays) -> Trace:
        """Where rays meet it; parameters: the centre's three coordinates and the radius."""
        points, depth, root, hit = self._crossings(rays)
        return Trace(self._gradient(points), -self.side / root, depth, hit)

    def meet(self, rays: Rays) -> tuple[Floats, Bools]:
        """See `Lateral.meet`."""
        _, depth, _, hit = self._crossings(rays)
        return depth, hit

    def _crossings(self, rays: Rays) -> tuple[Floats, Floats, Floats, Bools]:
        rays, grazing = np.ascontiguousarray(rays), 2 * GRAZING_PX / self.focal_px
        return crossings(rays, self.center_m, self.radius_m, self.side, grazing)

    def gap(self, rays: Rays) -> tuple[Floats, Floats]:
        """See `Lateral.gap`."""
        _, squared, depth = nearest(np.ascontiguousarray(rays), self.center_m)
        return (squared - self.radius_m**2) / (2 * self.radius_m), depth

    def tangency(self, rays: Rays) -> Tangency:
        """How far rays pass outside it."""
        points, squared, depth = nearest(np.ascontiguousarray(rays), self.center_m)
        gap = (squared - self.radius_m**2) / (2 * self.radius_m)
        return Tangency(self._gradient(points), np.array(1.0 / self.radius_m), gap, depth)

    def off_middle(self, rays: Rays) -> Floats:
        """How far beside the centre rays (3, N) pass, over the radius: 1 at the outline."""
        return np.sqrt(nearest(np.ascontiguousarray(rays), self.center_m)[1]) / self.radius_m

    def _gradient(self, points: Floats) -> Floats:
        """Derivatives (4, N) of half the square of the distance from the centre, less the radius', at points (3, N)."""
        return np.concatenate([-points, np.full((1, points.shape[1]), -self.radius_m)])

    def stepped(self, step: Floats) -> "Ball":
        """The surface after a step (4,) of its parameters."""
        radius_m = limited(self.radius_m + float(step[3]), self.limits_m)
        return replace(self, center_m=self.center_m + step[:3], radius_m=radius_m)

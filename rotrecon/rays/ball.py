"""Spheres that can be fitted."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.ball_rays import grazed, met, traced
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
        return Trace(*traced(np.ascontiguousarray(rays), self.center_m, self.radius_m, self.side, self._grazing))

    def meet(self, rays: Rays) -> tuple[Floats, Bools]:
        """See `Lateral.meet`."""
        return met(np.ascontiguousarray(rays), self.center_m, self.radius_m, self.side, self._grazing)

    def gap(self, rays: Rays) -> tuple[Floats, Floats]:
        """See `Lateral.gap`."""
        return self._grazed(rays)[1:]

    def tangency(self, rays: Rays) -> Tangency:
        """How far rays pass outside it."""
        columns, gap, depth = self._grazed(rays)
        return Tangency(columns, np.array(1.0 / self.radius_m), gap, depth)

    def off_middle(self, rays: Rays) -> Floats:
        """How far beside the centre rays (3, N) pass, over the radius: 1 at the outline."""
        x, y, z, _ = self._grazed(rays)[0]
        return np.sqrt(x * x + y * y + z * z) / self.radius_m

    @property
    def _grazing(self) -> float:
        return 2 * GRAZING_PX / self.focal_px

    def _grazed(self, rays: Rays) -> tuple[Floats, Floats, Floats]:
        return grazed(np.ascontiguousarray(rays), self.center_m, self.radius_m)

    def stepped(self, step: Floats) -> "Ball":
        """The surface after a step (4,) of its parameters."""
        radius_m = limited(self.radius_m + float(step[3]), self.limits_m)
        return replace(self, center_m=self.center_m + step[:3], radius_m=radius_m)

"""Cylinders and cones that can be fitted."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.lateral_rays import asides, grazed, met, passed, tilted, traced
from rotrecon.rays.traces import GRAZING_PX, Range, Rays, Tangency, Trace, limited


@dataclass(frozen=True, eq=False)
class Lateral:
    """An infinite cylinder or cone: radius + slope h at height h along the axis."""

    center_m: Floats
    """(3,) point on the axis."""
    turn: Floats
    """(3, 3) rows: two across, at the start the second toward the camera, and the axis' direction; a rotation."""
    radius_m: float
    """At `center_m`."""
    slope: float
    focal_px: float
    tapers: bool
    """Whether the slope is a parameter."""
    side: Literal[-1, 1] = -1
    """-1 seen from outside, 1 from inside."""
    limits_m: Range | None = None
    """Of the radius, which no step leaves."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def direction(self) -> Floats:
        """(3,) unit."""
        return self.turn[2]

    @property
    def size_place(self) -> int:
        """Which of the parameters the radius is."""
        return 4

    @property
    def size_m(self) -> float:
        """The radius at the middle."""
        return self.radius_m

    def units(self, length_m: float) -> Floats:
        """(k,) steps of the parameters that move a surface of this length by about a metre."""
        unit = [1.0, 1.0, 1.0 / length_m, 1.0 / length_m, 1.0]
        return np.array([*unit, 1.0 / length_m] if self.tapers else unit)

    def meet(self, rays: Rays) -> tuple[Floats, Bools]:
        """Depth (N,) and hits (N,) of rays, as `trace` has them."""
        return met(np.ascontiguousarray(rays), *self._pose, self.side, self._grazing)

    def trace(self, rays: Rays) -> Trace:
        """Where rays meet it; parameters: shift across, shift toward the camera, turn by each, radius, slope."""
        return Trace(*traced(np.ascontiguousarray(rays), *self._pose, self.side, self._grazing, self._parameters))

    def gap(self, rays: Rays) -> tuple[Floats, Floats]:
        """How far rays pass outside it, and the depth of their nearest points, both (N,); as `tangency` has them."""
        return passed(np.ascontiguousarray(rays), *self._pose)

    def tangency(self, rays: Rays) -> Tangency:
        """How far rays pass outside it."""
        return Tangency(*grazed(np.ascontiguousarray(rays), *self._pose, self._parameters))

    def off_middle(self, rays: Rays) -> Floats:
        """How far beside the axis rays (3, N) pass, over the radius there: 1 at the outline."""
        return asides(np.ascontiguousarray(rays), *self._pose)

    @cached_property
    def _pose(self) -> tuple[Floats, Floats, float, float]:
        """Its turn, the camera (3,) in its own coordinates, its radius and its slope."""
        return self.turn, -self.turn @ self.center_m, self.radius_m, self.slope

    @property
    def _grazing(self) -> float:
        return 2 * GRAZING_PX / self.focal_px

    @property
    def _parameters(self) -> int:
        return 6 if self.tapers else 5

    def heights(self, points_m: Floats) -> Floats:
        """Heights (N,) along the axis, from the centre, of points (N, 3)."""
        return (points_m - self.center_m) @ self.direction

    def stepped(self, step: Floats) -> "Lateral":
        """The surface after a step (k,) of its parameters."""
        across, toward, _ = self.turn
        return Lateral(
            self.center_m + step[0] * across + step[1] * toward,
            tilted(self.turn, float(step[2]), float(step[3])),
            limited(self.radius_m + float(step[4]), self.limits_m),
            self.slope + float(step[5]) if self.tapers else self.slope,
            self.focal_px,
            self.tapers,
            self.side,
            self.limits_m,
        )

"""Spheres that can be fitted."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.traces import GRAZING_PX, Range, Rays, Roots, Tangency, Trace, limited


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
    def size_m(self) -> float:
        """The radius."""
        return self.radius_m

    def units(self, length_m: float) -> Floats:
        """(4,) ones: every parameter is a length."""
        return np.ones(4)

    def _quadratic(self, rays: Rays) -> Roots:
        a = np.einsum("in,in->n", rays, rays)
        b = -self.center_m @ rays
        return Roots(a, b, float(self.center_m @ self.center_m - self.radius_m**2))

    def trace(self, rays: Rays) -> Trace:
        """Where rays meet it; parameters: the centre's three coordinates and the radius."""
        depth, root, hit = self._met(rays)
        gradient = np.empty((4, len(depth)))
        np.multiply(rays, -depth, out=gradient[:3])
        gradient[:3] += self.center_m[:, None]
        gradient[3] = -self.radius_m
        return Trace(gradient, -self.side / root, depth, hit)

    def meet(self, rays: Rays) -> tuple[Floats, Bools]:
        """See `Lateral.meet`."""
        depth, _, hit = self._met(rays)
        return depth, hit

    def _met(self, rays: Rays) -> tuple[Floats, Floats, Bools]:
        """Depths, roots and hits."""
        roots = self._quadratic(rays)
        return roots.depth(self.side, (2 * GRAZING_PX / self.focal_px * self.radius_m) * np.abs(roots.b))

    def gap(self, rays: Rays) -> tuple[Floats, Floats]:
        """See `Lateral.gap`."""
        tangency = self.tangency(rays)
        return tangency.gap_m, tangency.depth_m

    def tangency(self, rays: Rays) -> Tangency:
        """How far rays pass outside it."""
        depth = self._quadratic(rays).nearest_m
        offset = depth * rays - self.center_m[:, None]
        gap = ((offset**2).sum(axis=0) - self.radius_m**2) / (2 * self.radius_m)
        gradient = np.concatenate([-offset, np.full((1, len(depth)), -self.radius_m)])
        return Tangency(gradient, np.array(1.0 / self.radius_m), gap, depth)

    def off_middle(self, rays: Rays) -> Floats:
        """How far beside the centre rays (3, N) pass, over the radius: 1 at the outline."""
        depth = self._quadratic(rays).nearest_m
        return np.linalg.norm(depth * rays - self.center_m[:, None], axis=0) / self.radius_m

    def stepped(self, step: Floats) -> "Ball":
        """The surface after a step (4,) of its parameters."""
        radius_m = limited(self.radius_m + float(step[3]), self.limits_m)
        return replace(self, center_m=self.center_m + step[:3], radius_m=radius_m)

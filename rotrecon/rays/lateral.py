"""Cylinders and cones that can be fitted."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.traces import FLANK, GRAZING_PX, Range, Rays, Roots, Tangency, Trace, limited


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
    def size_m(self) -> float:
        """The radius at the middle."""
        return self.radius_m

    def units(self, length_m: float) -> Floats:
        """(k,) steps of the parameters that move a surface of this length by about a metre."""
        unit = [1.0, 1.0, 1.0 / length_m, 1.0 / length_m, 1.0]
        return np.array([*unit, 1.0 / length_m] if self.tapers else unit)

    def _quadratic(self, rays: Rays) -> tuple[Floats, Floats, Roots]:
        """Directions (3, N) and the camera (3,) in the surface's own coordinates, and the quadratics."""
        origin = -self.turn @ self.center_m
        radius = self.radius_m + self.slope * origin[2]
        halved = origin[0] * self.turn[0] + origin[1] * self.turn[1] - radius * self.slope * self.turn[2]
        turned = np.concatenate([self.turn, halved[None]]) @ rays
        x, y, h, b = turned
        a = x * x
        a += y * y
        if self.slope != 0:
            growth = self.slope * h
            a -= growth * growth
        # a ray along a cone's flank meets it at infinity, one steeper than that from the other side
        a[np.abs(a) < FLANK] = FLANK
        return turned[:3], origin, Roots(a, b, float(origin[0] ** 2 + origin[1] ** 2 - radius**2))

    def meet(self, rays: Rays) -> tuple[Floats, Bools]:
        """Depth (N,) and hits (N,) of rays, as `trace` has them."""
        _, _, depth, _, hit = self._met(rays)
        return depth, hit

    def trace(self, rays: Rays) -> Trace:
        """Where rays meet it; parameters: shift across, shift toward the camera, turn by each, radius, slope."""
        turned, origin, depth, root, hit = self._met(rays)
        return Trace(self._gradient(*self._point(turned, origin, depth)), -self.side / root, depth, hit)

    def _met(self, rays: Rays) -> tuple[Floats, Floats, Floats, Floats, Bools]:
        """Directions and origin in the surface's own coordinates; depths, roots and hits."""
        turned, origin, roots = self._quadratic(rays)
        grazing = np.abs(roots.b)
        grazing *= 2 * GRAZING_PX / self.focal_px
        grazing *= np.abs(self._radius_at(origin[2] + roots.nearest_m * turned[2])) if self.slope else self.radius_m
        return turned, origin, *roots.depth(self.side, grazing)

    def gap(self, rays: Rays) -> tuple[Floats, Floats]:
        """How far rays pass outside it, and the depth of their nearest points, both (N,); as `tangency` has them."""
        (x, y, _), radius, depth = self._nearest_to(rays)
        return (x * x + y * y - radius * radius) / (2 * radius), depth

    def tangency(self, rays: Rays) -> Tangency:
        """How far rays pass outside it."""
        (x, y, h), radius, depth = self._nearest_to(rays)
        gap = (x * x + y * y - radius * radius) / (2 * radius)
        return Tangency(self._gradient(x, y, h), 1.0 / radius, gap, depth)

    def off_middle(self, rays: Rays) -> Floats:
        """How far beside the axis rays (3, N) pass, over the radius there: 1 at the outline."""
        (x, y, _), radius, _ = self._nearest_to(rays)
        return np.sqrt(x * x + y * y) / np.maximum(radius, 1e-9)

    def _nearest_to(self, rays: Rays) -> tuple[Floats, Floats, Floats]:
        """Points (3, N) of rays nearest to the surface in its own coordinates, its radius there, and their depth."""
        turned, origin, roots = self._quadratic(rays)
        depth = roots.nearest_m
        points = self._point(turned, origin, depth)
        return points, self._radius_at(points[2]), depth

    def _point(self, turned: Floats, origin: Floats, depth: Floats) -> Floats:
        """Points (3, N) of rays in the surface's own coordinates."""
        points = turned * depth
        points += origin[:, None]
        return points

    def _radius_at(self, h: Floats) -> Floats:
        return self.radius_m + self.slope * h

    def _gradient(self, x: Floats, y: Floats, h: Floats) -> Floats:
        """Derivatives (k, N) of (x^2 + y^2 - radius^2) / 2 at points of the surface's own coordinates."""
        radius = self._radius_at(h) if self.slope else self.radius_m
        lever = h + self.slope * radius if self.slope else h
        gradient = np.empty((6 if self.tapers else 5, len(x)))
        np.negative(x, out=gradient[0])
        np.negative(y, out=gradient[1])
        np.multiply(gradient[:2], lever, out=gradient[2:4])
        gradient[4] = -radius
        if self.tapers:
            np.multiply(gradient[4], h, out=gradient[5])
        return gradient

    def heights(self, points_m: Floats) -> Floats:
        """Heights (N,) along the axis, from the centre, of points (N, 3)."""
        return (points_m - self.center_m) @ self.direction

    def stepped(self, step: Floats) -> "Lateral":
        """The surface after a step (k,) of its parameters."""
        across, toward, axis = self.turn
        direction = axis + step[2] * across + step[3] * toward
        direction /= np.sqrt(direction @ direction)
        turned = across - (across @ direction) * direction
        turned /= np.sqrt(turned @ turned)
        return Lateral(
            self.center_m + step[0] * across + step[1] * toward,
            np.array([turned, _cross(direction, turned), direction]),
            limited(self.radius_m + float(step[4]), self.limits_m),
            self.slope + float(step[5]) if self.tapers else self.slope,
            self.focal_px,
            self.tapers,
            self.side,
            self.limits_m,
        )


def _cross(first: Floats, second: Floats) -> Floats:
    """Cross product (3,) of vectors (3,); numpy's takes ten times as long for so little."""
    (a, b, c), (x, y, z) = first, second
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])

"""Surfaces that can be fitted: where rays from the camera first meet them, and how that depends on their parameters."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.primitives import basis_across

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


@dataclass(frozen=True, eq=False)
class _Roots:
    """The quadratic a z^2 + 2 b z + c of every ray."""

    a: Floats
    b: Floats
    c: float

    @property
    def nearest_m(self) -> Floats:
        """Depth of the point of the ray nearest to the surface."""
        return -self.b / self.a

    def depth(self, side: int, grazing_disc: Floats) -> tuple[Floats, Floats, Bools]:
        """Depth of the near (-1) or far (+1) root, the root of the discriminant, at least grazing, and what hits."""
        disc = self.b * self.b
        disc -= self.a * self.c
        np.maximum(grazing_disc, SMALLEST, out=grazing_disc)
        root = np.sqrt(np.maximum(disc, grazing_disc))
        reach = side * root
        # below the grazing value the root goes on along its tangent, so that a ray that misses still pulls
        low = np.flatnonzero(disc < grazing_disc)
        reach[low] += side * (disc[low] - grazing_disc[low]) / (2 * root[low])
        reach -= self.b
        reach /= self.a
        return reach, root, disc > 0


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

    def _quadratic(self, rays: Rays) -> tuple[Floats, Floats, _Roots]:
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
        return turned[:3], origin, _Roots(a, b, float(origin[0] ** 2 + origin[1] ** 2 - radius**2))

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

    def _quadratic(self, rays: Rays) -> _Roots:
        a = np.einsum("in,in->n", rays, rays)
        b = -self.center_m @ rays
        return _Roots(a, b, float(self.center_m @ self.center_m - self.radius_m**2))

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


Surface = Lateral | Ball


def radius_seen_m(surface: Surface, rays: Rays) -> float:
    """The radius where some rays (3, N) meet a surface, in the median: that of a cone at its centre may be far off."""
    if isinstance(surface, Ball) or surface.slope == 0:
        return surface.radius_m
    heights_m = surface.heights((rays * surface.meet(rays)[0]).T)
    return surface.radius_m + surface.slope * float(np.median(heights_m))


def limited(value: float, limits: Range | None) -> float:
    """The value, or the limit that it lies beyond."""
    return value if limits is None else min(max(value, limits[0]), limits[1])


def _cross(first: Floats, second: Floats) -> Floats:
    """Cross product (3,) of vectors (3,); numpy's takes ten times as long for so little."""
    (a, b, c), (x, y, z) = first, second
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def turn_of(direction: Floats, toward: Floats) -> Floats:
    """(3, 3) rows: a unit vector across, one toward `toward`, and `direction`; a rotation."""
    return np.stack([*basis_across(direction, toward), direction])

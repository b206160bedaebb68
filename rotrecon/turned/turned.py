"""A surface of revolution whose radius is a smooth curve along its axis."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.lines import Lines
from rotrecon.rays.surfaces import turn_of
from rotrecon.rays.traces import GRAZING_PX, Rays, Tangency, Trace

TO_POWERS = np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6.0
"""Coefficients of 1, u, u^2, u^3 on an interval, from those of the four B-splines that reach it (de Boor 1978)."""
AXIS_PARAMETERS = 4
"""Come before the coefficients of the curve."""
MEETINGS = 8
"""Tangent cones of the profile that a ray is met with in turn, at most: as with Newton's method each doubles the digits
wherever the profile is smooth."""
MET_M = 1e-5
"""Heights that change by less from one cone to the next are at most a nanometre off after it, by the same law."""
SMALLEST_M = 1e-5
"""Least radius: a profile that closes has an end there, and no surface beyond."""
LEAST_DISC = 1e-12
"""Least discriminant (m^2) of a ray's quadratic that is told from zero."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Turned(Lateral):
    """A lateral surface with a curve of radii instead of a line: a uniform cubic spline, straight beyond its ends.

    As a `Lateral` it is the straight line through the curve.
    """

    coefficients_m: Floats
    """(K,) of the B-splines, K >= 4."""
    low_m: float
    """Heights between which the curve bends."""
    high_m: float

    @property
    def size_m(self) -> float:
        """The radius in the middle of the curve."""
        return float(self.curve(np.array([(self.low_m + self.high_m) / 2]))[0][0])

    @property
    def pitch_m(self) -> float:
        """Distance of the knots."""
        return (self.high_m - self.low_m) / (len(self.coefficients_m) - 3)

    def units(self, length_m: float) -> Floats:
        """(4 + K,) steps of the parameters that move a surface of this length by about a metre."""
        return np.array([1.0, 1.0, 1.0 / length_m, 1.0 / length_m, *np.ones(len(self.coefficients_m))])

    def curve(self, height_m: Floats) -> tuple[Floats, Floats]:
        """Radius and slope (N,) at heights (N,)."""
        coefficients = self.coefficients_m
        interval, u, beyond_m = self._place(height_m)
        powers = TO_POWERS @ np.stack([coefficients[m : len(coefficients) - 3 + m] for m in range(4)])
        c0, c1, c2, c3 = (power[interval] for power in powers)
        slope = (c1 + u * (2 * c2 + u * 3 * c3)) / self.pitch_m
        radius = c0 + u * (c1 + u * (c2 + u * c3)) + slope * beyond_m
        closed = radius < SMALLEST_M
        return np.where(closed, SMALLEST_M, radius), np.where(closed, 0.0, slope)

    def basis(self, height_m: Floats) -> Floats:
        """(K, N) derivatives of the radius at heights (N,) by the coefficients."""
        interval, u, beyond_m = self._place(height_m)
        powers = np.stack([np.ones_like(u), u, u * u, u**3])
        slopes = np.stack([np.zeros_like(u), np.ones_like(u), 2 * u, 3 * u * u]) * (beyond_m / self.pitch_m)
        four = TO_POWERS.T @ (powers + slopes)
        result = np.zeros((len(self.coefficients_m), len(u)))
        np.put_along_axis(result, interval + np.arange(4)[:, None], four, axis=0)
        return result

    def _place(self, height_m: Floats) -> tuple[Indices, Floats, Floats]:
        """Interval of each height, place in it from 0 to 1, and how far beyond the curve's ends it is."""
        within = np.clip(height_m, self.low_m, self.high_m)
        place = (within - self.low_m) / self.pitch_m
        interval = np.minimum(place.astype(np.int32), len(self.coefficients_m) - 4)
        return interval, place - interval, height_m - within

    def trace(self, rays: Rays) -> Trace:
        """Where rays meet it; parameters: shift across, shift toward the camera, turn by each, and the coefficients.

        At the meeting point the surface and its tangent cone agree in place and in normal, and so in all derivatives.
        """
        lines = Lines.of(self, rays)
        depth, root, hit = self._met_lines(lines)
        return Trace(self._by_parameters(lines, depth), -self.side / root, depth, hit)

    def meet(self, rays: Rays) -> tuple[Floats, Bools]:
        """See `Lateral.meet`."""
        depth, _, hit = self._met_lines(Lines.of(self, rays))
        return depth, hit

    def _met_lines(self, lines: Lines) -> tuple[Floats, Floats, Bools]:
        """Depths, roots and hits (N,)."""
        depth, root, hit = self._settled(lines, self._first_guess(lines))
        for end_m in (self.low_m, self.high_m):
            # past a narrow part a ray may meet a wider one
            missed = np.flatnonzero(~hit).astype(np.int32)
            if len(missed) == 0:
                break
            again = lines.chosen(missed)
            others = self._settled(again, np.full(len(missed), end_m))
            met = again.height(others[0])
            better = others[2] & (met >= self.low_m) & (met <= self.high_m)
            for values, other in zip((depth, root, hit), others, strict=True):
                values[missed[better]] = other[better]
        self._continue(lines, depth, root, hit)
        return depth, root, hit

    def _continue(self, lines: Lines, depth: Floats, root: Floats, hit: Bools) -> None:
        """Depths and roots of rays that miss and were led far away, as if they missed the nearest cylinder."""
        height = lines.height(depth)
        reach_m = self.size_m
        lost = np.flatnonzero(~hit & ~((height > self.low_m - reach_m) & (height < self.high_m + reach_m)))
        if len(lost) == 0:
            return
        passing = lines.chosen(lost.astype(np.int32))
        nearest = np.clip(passing.height(-passing.mixed / passing.square), self.low_m, self.high_m)
        radius = self.curve(nearest)[0]
        depth[lost], root[lost], _ = self.meet_cone(passing, nearest, radius, np.zeros_like(radius))

    def _settled(self, lines: Lines, height: Floats) -> tuple[Floats, Floats, Bools]:
        """Depth, root of the discriminant and hits of rays, from cone to cone from a first guess of the heights."""
        depth, root, hit = self.meet_cone(lines, height, *self.curve(height))
        before = np.zeros_like(height)
        for _ in range(MEETINGS):
            step = lines.height(depth) - height
            # near a limb the heights may swing about the right one
            step = np.where(step * before < 0, step / 2, step)
            height, before = height + step, step
            depth, root, hit = self.meet_cone(lines, height, *self.curve(height))
            if np.abs(step)[hit].max(initial=0.0) < MET_M:
                break
        return depth, root, hit

    def _first_guess(self, lines: Lines) -> Floats:
        """Heights (N,) at which rays meet the cone of the straight line."""
        at_zero = np.zeros_like(lines.square)
        depth, _, _ = self.meet_cone(lines, at_zero, at_zero + self.radius_m, at_zero + self.slope)
        return np.clip(lines.height(depth), self.low_m, self.high_m)

    def meet_cone(self, lines: Lines, height: Floats, radius: Floats, slope: Floats) -> tuple[Floats, Floats, Bools]:
        """Depth, root of the discriminant, and hits of rays with cones of these radii and slopes at these heights.

        Rays that miss are continued as those of `Lateral`.
        """
        a, b, c = lines.quadratic(height, radius, slope)
        disc = b * b - a * c
        nearest = radius + slope * (lines.height(-b / a) - height)
        grazing = np.maximum(2 * GRAZING_PX / self.focal_px * np.abs(nearest * b), LEAST_DISC)
        root = np.sqrt(np.maximum(disc, grazing))
        reach = root + np.minimum(disc - grazing, 0.0) / (2 * np.sqrt(grazing))
        return (-b + self.side * reach) / a, root, disc > 0

    def _by_parameters(self, lines: Lines, depth: Floats) -> Floats:
        """(4 + K, N) derivatives of half of x^2 + y^2 - r(h)^2 by the parameters."""
        (x, y), height = lines.aside(depth), lines.height(depth)
        radius, slope = self.curve(height)
        lever = height + slope * radius
        columns = np.empty((AXIS_PARAMETERS + len(self.coefficients_m), len(height)))
        columns[:AXIS_PARAMETERS] = -x, -y, -x * lever, -y * lever
        np.multiply(self.basis(height), -radius, out=columns[AXIS_PARAMETERS:])
        return columns

    def gap(self, rays: Rays) -> tuple[Floats, Floats]:
        """See `Lateral.gap`."""
        return self._passing(*self._nearest(rays))[:2]

    def tangency(self, rays: Rays) -> Tangency:
        """How far rays pass outside it."""
        lines, depth = self._nearest(rays)
        gap, _, radius = self._passing(lines, depth)
        return Tangency(self._by_parameters(lines, depth), 1.0 / radius, gap, depth)

    def _passing(self, lines: Lines, depth: Floats) -> tuple[Floats, Floats, Floats]:
        """Gap, depth and radius (N,) where rays are nearest to the surface."""
        x, y = lines.aside(depth)
        radius = self.curve(lines.height(depth))[0]
        return (x**2 + y**2 - radius**2) / (2 * radius), depth, radius

    def off_middle(self, rays: Rays) -> Floats:
        """How far beside the axis rays (3, N) pass, over the radius there: 1 at the outline."""
        lines, depth = self._nearest(rays)
        return np.hypot(*lines.aside(depth)) / self.curve(lines.height(depth))[0]

    def _nearest(self, rays: Rays) -> tuple[Lines, Floats]:
        """The depths (N,) at which rays are nearest to the surface."""
        lines = Lines.of(self, rays)
        height = self._first_guess(lines)
        depth = np.zeros_like(height)
        for _ in range(MEETINGS):
            a, b, _ = lines.quadratic(height, *self.curve(height))
            depth = -b / a
            met = lines.height(depth)
            moved_m = np.abs(met - height).max(initial=0.0)
            height = met
            if moved_m < MET_M:
                break
        return lines, depth

    def stepped(self, step: Floats) -> "Turned":
        """The surface after a step (4 + K,) of its parameters."""
        across, toward, axis = self.turn
        direction = axis + step[2] * across + step[3] * toward
        direction = direction / np.linalg.norm(direction)
        center = self.center_m + step[0] * across + step[1] * toward
        coefficients = self.coefficients_m + step[AXIS_PARAMETERS:]
        radius, slope = _line(coefficients, self.low_m, self.high_m)
        return replace(
            self,
            center_m=center,
            turn=turn_of(direction, -center),
            coefficients_m=coefficients,
            radius_m=radius,
            slope=slope,
        )


def radius_at(surface: Lateral, height_m: Floats) -> Floats:
    """Radius (N,) at heights (N,) of a cylinder, a cone or a turned surface."""
    return surface.curve(height_m)[0] if isinstance(surface, Turned) else surface.radius_m + surface.slope * height_m


def _line(coefficients_m: Floats, low_m: float, high_m: float) -> tuple[float, float]:
    """Radius at height 0 and slope of the straight line through a curve of these coefficients."""
    count = len(coefficients_m)
    # a B-spline's coefficients belong to the middles of the splines, a pitch before the first knot on
    pitch_m = (high_m - low_m) / (count - 3)
    offset = (np.arange(count) - (count - 1) / 2) * pitch_m
    slope = float(offset @ coefficients_m / (offset @ offset))
    return float(coefficients_m.mean()) - slope * (low_m + high_m) / 2, slope


def turned_from(surface: Lateral, height_m: Floats, radius_m: Floats, knots: int) -> Turned:
    """A turned surface about the axis of another one, through radii (n,) at rising heights (n,), of K = `knots`."""
    low, high = float(height_m[0]), float(height_m[-1])
    empty = Turned(
        center_m=surface.center_m,
        turn=surface.turn,
        radius_m=surface.radius_m,
        slope=surface.slope,
        focal_px=surface.focal_px,
        tapers=False,
        side=surface.side,
        coefficients_m=np.zeros(knots),
        low_m=low,
        high_m=high,
    )
    at = np.linspace(low, high, 4 * knots)
    basis = empty.basis(at)
    solved = np.linalg.solve(basis @ basis.T, basis @ np.interp(at, height_m, radius_m))
    coefficients = np.asarray(solved, dtype=np.float64)
    radius, slope = _line(coefficients, low, high)
    return replace(empty, coefficients_m=coefficients, radius_m=radius, slope=slope)

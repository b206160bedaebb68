"""Solids from the section radii along the axis: cylinder, cone and the two spheres (paper 3.4, 3.5)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.primitives import Kind
from rotrecon.settings import Settings

Shape = Literal["cylinder", "cone", "sphere"]
SHAPES: tuple[Shape, ...] = ("cylinder", "cone", "sphere")
SHAPE_OF_KIND: dict[Kind, Shape] = {
    "cylinder": "cylinder",
    "rod": "cylinder",
    "cone": "cone",
    "sphere": "sphere",
}
PARAMETERS = {"cylinder": 1, "cone": 2, "sphere": 2}
"""Numbers each curve through the radii is free to choose."""


@dataclass(frozen=True, eq=False)
class RadiusFit:
    """A curve through the radii of S sections against their position along the axis."""

    shape: Shape
    radius_m: float
    """Of the cylinder or the sphere; of the cone at position 0."""
    slope: float
    """Growth of the cone's radius with position: the tangent of its half angle."""
    center_m: float
    """Position of the sphere's centre."""
    kept: Bools
    """(S,) sections whose radius deviates from the curve by no more than the mean deviation, paper (14)."""
    deviation_m: float
    """Mean deviation of all radii from the curve, before the rejection."""

    def __post_init__(self) -> None:
        freeze(self)

    def radius_at_middle(self, along_m: Floats) -> float:
        """The radius a person would quote: of a cone, at the middle of the kept ones of positions (S,)."""
        kept = along_m[self.kept]
        return self.radius_m + self.slope * float(kept.min() + kept.max()) / 2


def fit_radii(shape: Shape, along_m: Floats, radius_m: Floats, used: Bools, settings: Settings) -> RadiusFit | None:
    """Least squares of one curve through the radii (S,) at positions (S,) of the used sections.

    Constant is a cylinder, equations (13) to (15); linear a cone, circular a sphere, in the same spirit: fit, drop what
    deviates by more than the mean deviation (14), fit again. None where no such curve exists.
    """
    first = _solve(shape, along_m[used], radius_m[used])
    if first is None:
        return None
    deviation = np.abs(radius_m - _curve(shape, first, along_m))
    mean_deviation = float(deviation[used].mean())
    kept = used & (deviation <= max(mean_deviation, settings.distance_floor_m))
    second = _solve(shape, along_m[kept], radius_m[kept])
    return None if second is None else RadiusFit(shape, *second, kept=kept, deviation_m=mean_deviation)


def axis_length_radius(center_m: Floats) -> float:
    """The paper's second sphere, equation (16): half the distance between the first and the last centre (n, 3)."""
    return float(np.linalg.norm(center_m[-1] - center_m[0])) / 2


def _solve(shape: Shape, along: Floats, radius: Floats) -> tuple[float, float, float] | None:
    """Radius, slope and centre of the curve with the least squared deviation."""
    if shape == "cylinder":
        return float(radius.mean()), 0.0, 0.0
    if shape == "cone":
        slope, at_zero = _line(along, radius)
        return at_zero, slope, 0.0
    # r^2 + (h - h0)^2 = R^2 is linear in h0 and R^2 - h0^2
    slope, intercept = _line(along, along**2 + radius**2)
    center = slope / 2
    squared = intercept + center**2
    return (float(np.sqrt(squared)), 0.0, center) if squared > 0 else None


def _line(x: Floats, y: Floats) -> tuple[float, float]:
    """Slope and intercept of the least squares line; slope 0 where x does not vary."""
    x_middle, y_middle = x.mean(), y.mean()
    variance = ((x - x_middle) ** 2).mean()
    slope = ((x - x_middle) * (y - y_middle)).mean() / variance if variance > 0 else 0.0
    return float(slope), float(y_middle - slope * x_middle)


def _curve(shape: Shape, solution: tuple[float, float, float], along: Floats) -> Floats:
    """Radius of the curve at positions along the axis."""
    radius, slope, center = solution
    if shape == "sphere":
        return np.sqrt(np.maximum(radius**2 - (along - center) ** 2, 0.0))
    return radius + slope * along


@dataclass(frozen=True)
class RankedCurve:
    """A curve through the radii and the share of belief it gets, from 0 to 1; the shares add up to 1."""

    radii: RadiusFit
    radius_m: float
    """At the middle of the sections."""
    score: float


def rank(curves: list[RadiusFit], along_m: Floats, used: Bools, settings: Settings) -> tuple[RankedCurve, ...]:
    """The curves that a person would call by their name, the most credible first.

    The score is the weight of the Bayesian information criterion (Schwarz 1978) for deviations with Laplace's
    distribution, n ln(mean deviation) + k ln(n) / 2, with n the sections that err independently of each other.
    """
    span_m = float(np.ptp(along_m[used]))
    plausible = [curve for curve in curves if _deserves_its_name(curve, span_m, settings)]
    independent = max(float(used.sum()) / settings.correlated_sections, 2.0)
    cost = np.array(
        [
            independent * np.log(max(curve.deviation_m, settings.distance_floor_m))
            + PARAMETERS[curve.shape] * np.log(independent) / 2
            for curve in plausible
        ]
    )
    weight = np.exp(cost.min() - cost)
    shares = (weight / weight.sum()).tolist()
    ranked = [RankedCurve(c, c.radius_at_middle(along_m), share) for c, share in zip(plausible, shares, strict=True)]
    return tuple(sorted(ranked, key=lambda curve: -curve.score))


def choose(candidates: tuple[RankedCurve, ...], kind: Kind | None, settings: Settings) -> RankedCurve | None:
    """The most credible candidate, or that of the kind asked for; None when the sections speak against that kind."""
    if kind is None:
        return candidates[0]
    limit_m = settings.kind_deviation * max(candidates[0].radii.deviation_m, settings.distance_floor_m)
    asked = (c for c in candidates if c.radii.shape == SHAPE_OF_KIND[kind] and c.radii.deviation_m <= limit_m)
    return next(asked, None)


def _deserves_its_name(curve: RadiusFit, span_m: float, settings: Settings) -> bool:
    """Whether the difference from a cylinder is one that a person would see."""
    if curve.shape == "cone":
        return bool(abs(np.arctan(curve.slope)) >= settings.cone_half_angle_rad)
    if curve.shape == "sphere":
        return span_m >= settings.sphere_span * 2 * curve.radius_m
    return True

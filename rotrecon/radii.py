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

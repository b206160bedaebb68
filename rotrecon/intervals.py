"""95 % intervals of the numbers of a solid that was fitted along the rays."""

import numpy as np
from scipy.special import stdtrit  # pyright: ignore[reportMissingTypeStubs, reportUnknownVariableType]

from rotrecon.arrays import Floats
from rotrecon.outcome import Intervals, Range
from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.ray_fit import RayFit
from rotrecon.turned.turned import AXIS_PARAMETERS, Turned

PLANE_95, SPACE_95 = 2.448, 2.796
"""Radius of the circle and the ball that hold 95 % of a normal distribution, in its standard deviations."""
FEWEST_FREEDOMS = 3.0
"""Degrees of freedom below which the quantile of Student's distribution would say nothing any more."""


def quantile_95(fit: RayFit) -> float:
    """Half width of a 95 % interval in standard deviations, the noise being estimated from so many residuals."""
    outline = sum(share * len(edges) for edges, share in fit.outlines)
    freedoms = max(fit.independent + outline - float(fit.free.sum()), FEWEST_FREEDOMS)
    return float(stdtrit(freedoms, 0.975))


def lateral_intervals(fit: RayFit, surface: Lateral, middle_m: float, length_m: Range | None) -> Intervals:
    """Of a cylinder or a cone, its diameter at a height of `middle_m` from the surface's centre."""
    covariance, quantile = fit.covariance, quantile_95(fit)
    radius = surface.radius_m + surface.slope * middle_m
    across = _at_height(covariance, middle_m)
    spread = quantile / 1.96
    angle: Range | None = None
    if surface.tapers:
        reach = quantile * np.sqrt(covariance[5, 5]) / (1 + surface.slope**2)
        angle = (float(np.arctan(surface.slope) - reach), float(np.arctan(surface.slope) + reach))
    return Intervals(
        diameter_m=_interval(2 * radius, 2 * quantile * _radius_sigma(covariance, middle_m)),
        center_m=spread * PLANE_95 * _widest(across),
        direction_rad=spread * PLANE_95 * _widest(covariance[2:4, 2:4]),
        half_angle_rad=angle,
        length_m=length_m,
    )


def turned_intervals(fit: RayFit, surface: Turned, middle_m: float, length_m: Range | None) -> Intervals:
    """Of a general surface of revolution, its diameter at a height of `middle_m` from the surface's centre."""
    quantile = quantile_95(fit)
    at_middle = surface.basis(np.array([middle_m]))[:, 0]
    own = fit.covariance[AXIS_PARAMETERS:, AXIS_PARAMETERS:]
    sigma_m = float(np.sqrt(max(at_middle @ own @ at_middle, 0.0)))
    spread = quantile / 1.96
    return Intervals(
        diameter_m=_interval(2 * float(surface.curve(np.array([middle_m]))[0][0]), 2 * quantile * sigma_m),
        center_m=spread * PLANE_95 * _widest(_at_height(fit.covariance, middle_m)),
        direction_rad=spread * PLANE_95 * _widest(fit.covariance[2:4, 2:4]),
        length_m=length_m,
    )


def ball_intervals(fit: RayFit, ball: Ball) -> Intervals:
    """Of a sphere."""
    quantile = quantile_95(fit)
    return Intervals(
        diameter_m=_interval(2 * ball.radius_m, 2 * quantile * float(np.sqrt(fit.covariance[3, 3]))),
        center_m=quantile / 1.96 * SPACE_95 * _widest(fit.covariance[:3, :3]),
    )


def radius_sigma(fit: RayFit) -> float:
    """Standard error of the radius at the surface's centre."""
    if isinstance(fit.surface, Turned):
        low, high = turned_intervals(fit, fit.surface, (fit.surface.low_m + fit.surface.high_m) / 2, None).diameter_m
        return (high - low) / 2 / 2 / quantile_95(fit)
    return _radius_sigma(fit.covariance, 0.0) if len(fit.free) > 4 else float(np.sqrt(fit.covariance[3, 3]))


def _radius_sigma(covariance: Floats, height_m: float) -> float:
    """Standard deviation of radius + slope h."""
    variance = covariance[4, 4]
    if len(covariance) > 5:
        variance += 2 * height_m * covariance[4, 5] + height_m**2 * covariance[5, 5]
    return float(np.sqrt(max(variance, 0.0)))


def _at_height(covariance: Floats, height_m: float) -> Floats:
    """Covariance (2, 2) of the axis' place across it, at a height: shift + turn h."""
    lever = np.concatenate([np.eye(2), height_m * np.eye(2)], axis=1)
    return lever @ covariance[:4, :4] @ lever.T


def _widest(covariance: Floats) -> float:
    return float(np.sqrt(max(np.linalg.eigvalsh(covariance)[-1], 0.0)))


def _interval(value: float, reach: float) -> Range:
    return (max(value - reach, 0.0), value + reach)

"""The curve of a turned surface through radii that were seen, and the prior that keeps it smooth as the data ask."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.fitting import UNSCALED, Prediction
from rotrecon.rays.surfaces import Surface
from rotrecon.turned.turned import AXIS_PARAMETERS, Turned

UNBENT = (100.0, 100.0**2)
"""Sigma and independent share of the prior for the robust loop: no loss bends residuals that small, and their cost
stays that of their square."""
LEAST_SCALE_M = 1e-5
"""A bend that nothing could measure."""


@dataclass(frozen=True, eq=False)
class Smoothness:
    """The prior that second differences of a turned surface's coefficients are small (P-splines, Eilers, Marx 1996)."""

    scale_m: float
    """Standard deviation of a second difference."""

    def predict(self, surface: Surface) -> Prediction:
        """Second differences; what is seen is none. Raises TypeError for a surface that has no coefficients."""
        if not isinstance(surface, Turned):
            raise TypeError("only a turned surface has a profile to be smooth")
        differences = second_differences(len(surface.coefficients_m)) / self.scale_m
        axis = np.zeros((AXIS_PARAMETERS, len(differences)))
        return Prediction(np.concatenate([axis, differences.T]), UNSCALED, -differences @ surface.coefficients_m)


@dataclass(frozen=True, eq=False)
class Radii:
    """Radii seen at n heights about the axis of a turned surface, whose own errors move them with it."""

    height_m: Floats
    radius_m: Floats
    sigma_m: Floats
    """(n,) each by itself."""
    lever: Floats
    """(4, n) how much less each is for a step of the axis' parameters."""

    def __post_init__(self) -> None:
        freeze(self)

    def predict(self, surface: Surface) -> Prediction:
        """The surface's radii there. Raises TypeError for a surface that is not turned."""
        if not isinstance(surface, Turned):
            raise TypeError("only a turned surface has a profile")
        gradient = np.concatenate([self.lever, surface.basis(self.height_m)])
        return Prediction(
            gradient, 1.0 / self.sigma_m, (self.radius_m - surface.curve(self.height_m)[0]) / self.sigma_m
        )


def second_differences(count: int) -> Floats:
    """(count - 2, count) matrix."""
    return np.diff(np.eye(count), 2, axis=0)


def next_scale(surface: Turned, information: Floats, scale_m: float, free: Bools) -> float:
    """The prior's scale at which its bends are as large as it expects them (Wood and Fasiolo 2017, Fellner-Schall).

    tau^2 = |D c|^2 / (rank - tr(H^-1 S)), with S = D'D / tau^2 that part of the information H that is the prior's.
    """
    differences = second_differences(len(surface.coefficients_m))
    prior = np.zeros_like(information)
    prior[AXIS_PARAMETERS:, AXIS_PARAMETERS:] = differences.T @ differences / scale_m**2
    kept = np.ix_(free, free)
    held = float(np.trace(np.linalg.pinv(information[kept], hermitian=True) @ prior[kept]))
    bends = float(np.square(differences @ surface.coefficients_m).sum())
    return max(float(np.sqrt(bends / max(len(differences) - held, 1e-6))), LEAST_SCALE_M)

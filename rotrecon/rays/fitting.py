"""The one robust loop: a surface moved until the depths, and the outline, it predicts along the rays are those seen."""

from dataclasses import dataclass, replace
from typing import Any, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.compiled import FLOAT, MATRIX, VECTOR, compiled
from rotrecon.noise import RayNoise
from rotrecon.rays.losses import Loss
from rotrecon.rays.surfaces import Surface
from rotrecon.rays.traces import Derivatives, Rays

FIRST_DAMPING, MOST_DAMPING = 1e-3, 1e6
LARGEST_M = 100.0
"""A radius beyond this is that of nothing an arm could hold."""
SETTLED = 1e-4
"""A step that changes the cost by less than this share is the last."""
UNSCALED = np.array(1.0)
"""Scale of derivatives that are multiplied out."""


@dataclass(frozen=True, eq=False)
class Prediction(Derivatives):
    """What a surface predicts for one kind of measurement, with its derivatives by the surface's parameters."""

    residual: Floats
    """(N,) seen less predicted, in standard deviations."""


class Measurement(Protocol):
    """One kind of measurement of a surface, N numbers of it."""

    def predict(self, surface: Surface) -> Prediction:
        """What the surface predicts for it."""
        ...


@dataclass(frozen=True, eq=False)
class Depths:
    """Depths seen along rays."""

    rays: Rays
    steps: Floats
    """(N,) depth in standard deviations of its noise; see `RayNoise.steps`."""
    noise: RayNoise

    def __len__(self) -> int:
        return len(self.steps)

    def predict(self, surface: Surface) -> Prediction:
        """Residuals along the rays."""
        trace = surface.trace(self.rays)
        scale = trace.scale / self.noise.sigma_m(trace.depth_m)
        return Prediction(trace.gradient, scale, self.steps - self.noise.steps(trace.depth_m))

    def chosen(self, index: Indices | Bools) -> "Depths":
        """Some of the rays."""
        rays = np.ascontiguousarray(self.rays[:, index])
        return replace(self, rays=rays, steps=self.steps[index])


@dataclass(frozen=True, eq=False)
class MatchedDepths:
    """Depths as a matcher gives them: means of disparity over those of a window's pixels that show the object.

    Pixels beyond the outline have a prediction too, where a window reaches the object.
    """

    rays: Rays
    """(3, M) of all pixels that the windows may reach."""
    place: Indices
    """(M,) of these in a flattened rectangle."""
    shape: tuple[int, int]
    """Height and width of the rectangle, px."""
    window_px: int
    """Odd."""
    index: Indices
    """(N,) which of the M pixels were measured."""
    steps: Floats
    """(N,)"""
    noise: RayNoise

    def __post_init__(self) -> None:
        freeze(self)

    def __len__(self) -> int:
        return len(self.steps)

    def predict(self, surface: Surface) -> Prediction:
        """Residuals along the rays."""
        trace = surface.trace(self.rays)
        predicted = self.noise.steps(trace.depth_m)
        columns = trace.columns / self.noise.sigma_m(trace.depth_m)
        share = self._summed(np.ones(len(self.place)), trace.hit)
        reached, seen = share > 0.5, np.maximum(share, 1.0)

        def mean(values: Floats) -> Floats:
            return np.where(reached, self._summed(values, trace.hit) / seen, values[self.index])

        return Prediction(np.stack([mean(column) for column in columns]), UNSCALED, self.steps - mean(predicted))

    def _summed(self, values: Floats, hit: Bools) -> Floats:
        """Sums (N,) over the windows round the measured pixels, of values (M,) of those that hit."""
        image = np.zeros(self.shape)
        image.ravel()[self.place[hit]] = values[hit]
        side = (self.window_px, self.window_px)
        summed = cv2.boxFilter(image, -1, side, normalize=False, borderType=cv2.BORDER_CONSTANT)
        summed = np.asarray(summed, dtype=np.float64)
        return summed.ravel()[self.place[self.index]]

    def chosen(self, index: Indices | Bools) -> "MatchedDepths":
        """Some of the pixels."""
        return replace(self, index=self.index[index], steps=self.steps[index])


@dataclass(frozen=True, eq=False)
class Outline:
    """Rays seen to graze the surface: edges in the picture."""

    rays: Rays
    sigma_px: Floats
    """(N,) so large that edges taken as independent have what they err by alike together."""
    focal_px: float
    alike: tuple[tuple[Indices, float], ...] = ()
    """Edges of one stretch, and the standard deviation, px, of what all of them err by alike."""

    def __post_init__(self) -> None:
        freeze(self)

    def __len__(self) -> int:
        return len(self.sigma_px)

    def predict(self, surface: Surface) -> Prediction:
        """How far the rays pass outside the surface, in the picture; seen is that they do not."""
        tangency = surface.tangency(self.rays)
        scale = self.focal_px / (tangency.depth_m * self.sigma_px)
        return Prediction(tangency.gradient, tangency.scale * scale, -tangency.gap_m * scale)

    def chosen(self, index: Indices | Bools) -> "Outline":
        """Some of the edges."""
        rays = np.ascontiguousarray(self.rays[:, index])
        return Outline(rays, self.sigma_px[index], self.focal_px)

    def offsets_px(self, surface: Surface) -> Floats:
        """(S,) how far each stretch passes inside a surface, on average."""
        residual, weight = self.predict(surface).residual, 1 / self.sigma_px
        return np.array(
            [float(residual[one] @ weight[one]) / float(weight[one] @ weight[one]) for one, _ in self.alike]
        )

    def less_sure(self, by_px: Floats) -> "Outline":
        """The same, where all edges of a stretch err alike by so much more, px (S,)."""
        sigma_px, alike = self.sigma_px.copy(), list[tuple[Indices, float]]()
        for (stretch, alike_px), more_px in zip(self.alike, by_px.tolist(), strict=True):
            sigma_px[stretch] = np.sqrt(sigma_px[stretch] ** 2 + len(stretch) * more_px**2)
            alike.append((stretch, float(np.hypot(alike_px, more_px))))
        return replace(self, sigma_px=sigma_px, alike=tuple(alike))


Outlines = tuple[tuple[Outline, float], ...]
"""Each with the share of its edges that is independent."""


@dataclass(frozen=True, eq=False)
class Refined:
    """Where the loop ended."""

    surface: Surface
    cost: float
    information: Floats
    """(k, k) weighted normal matrix, 1 / sigma^2."""
    converged: bool


def refine(
    surface: Surface,
    measurements: list[Measurement],
    weighting: list[tuple[float, float]],
    loss: Loss,
    free: Bools,
    units: Floats,
    iterations: int,
) -> Refined:
    """Iteratively reweighted Levenberg-Marquardt over the `free` (k,) parameters (Nocedal and Wright 2006, 10.3).

    `weighting` holds for each measurement the sigma of its residuals, and the share of them that are independent.
    `units` (k,) make the damping the same for all parameters.
    """
    damping, kept = FIRST_DAMPING, np.ix_(free, free)
    cost, gradient, information = _normal_equations(surface, measurements, weighting, loss, units)
    converged = False
    for _ in range(iterations):
        step = np.zeros(len(units))
        step[free] = _step(gradient[free], information[kept], damping)
        step *= units
        trial = surface.stepped(step)
        trial_cost, trial_gradient, trial_information = _normal_equations(trial, measurements, weighting, loss, units)
        if 0 < trial.size_m < LARGEST_M and trial_cost <= cost:
            converged = cost - trial_cost <= SETTLED * max(cost, 1e-300)
            surface, cost, gradient, information = trial, trial_cost, trial_gradient, trial_information
            damping /= 10.0
        else:
            damping *= 10.0
        if converged or damping > MOST_DAMPING:
            break
    return Refined(surface, cost, information / np.outer(units, units), converged)


def _step(gradient: Floats, information: Floats, damping: float) -> Floats:
    """Solution (k,) of the damped normal equations; zero where they have none."""
    try:
        return np.asarray(_solved(gradient, information, damping), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.zeros(len(gradient))


@compiled(VECTOR, MATRIX, FLOAT)
def _solved(gradient: Floats, information: Floats, damping: float) -> NDArray[np.floating[Any]]:
    damped = information.copy()
    for i in range(len(gradient)):
        damped[i, i] += damping * max(information[i, i], 1e-300)
    return np.linalg.solve(damped, gradient)


def _normal_equations(
    surface: Surface, measurements: list[Measurement], weighting: list[tuple[float, float]], loss: Loss, units: Floats
) -> tuple[float, Floats, Floats]:
    """Cost, gradient (k,) and information (k, k) in the parameters' units."""
    count = len(units)
    cost, gradient, information = 0.0, np.zeros(count), np.zeros((count, count))
    for measurement, (sigma, share) in zip(measurements, weighting, strict=True):
        prediction = measurement.predict(surface)
        residual = prediction.residual / sigma
        costs, weights = loss(residual)
        scale = prediction.scale * (1.0 / sigma)
        weights *= scale
        cost += share * float(costs.sum())
        gradient += share * (prediction.gradient @ (weights * residual))
        weights *= scale
        information += share * ((prediction.gradient * weights) @ prediction.gradient.T)
    return cost, gradient * units, information * np.outer(units, units)

"""Which kind of solid the sections speak for (paper table 1)."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.primitives import Kind
from rotrecon.radii import SHAPE_OF_KIND, RadiusFit
from rotrecon.settings import Settings

PARAMETERS = {"cylinder": 1, "cone": 2, "sphere": 2}
"""Numbers each curve through the radii is free to choose."""


@dataclass(frozen=True)
class Candidate:
    """A curve through the radii and the share of belief it gets, from 0 to 1; the shares add up to 1."""

    radii: RadiusFit
    radius_m: float
    """At the middle of the sections."""
    score: float


def rank(curves: list[RadiusFit], along_m: Floats, used: Bools, settings: Settings) -> tuple[Candidate, ...]:
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
    candidates = [Candidate(c, c.radius_at_middle(along_m), share) for c, share in zip(plausible, shares, strict=True)]
    return tuple(sorted(candidates, key=lambda candidate: -candidate.score))


def choose(candidates: tuple[Candidate, ...], kind: Kind | None, settings: Settings) -> Candidate | None:
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

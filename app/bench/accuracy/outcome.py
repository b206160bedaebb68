"""How far one measurement is from the truth, and how sure it said it was."""

from dataclasses import dataclass

import numpy as np

from app.bench.accuracy.clouds import Cloud
from rotrecon.answer import answer
from rotrecon.arrays import Floats
from rotrecon.drawing import Drawing
from rotrecon.outcome import Fit, Range
from rotrecon.primitives import Primitive, Simple, Sphere
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Method, Settings

TRUE_KINDS = {"wire": "rod", "leg": "cylinder", "pipe": "cylinder", "ball": "sphere", "cone": "cone"}


@dataclass(frozen=True)
class Outcome:
    """Errors relative to the true values; NaN where there is no such number."""

    radius: float = np.nan
    """At the cloud's place."""
    stated: float = np.nan
    """Where the measured solid has its middle: of the diameter that is told."""
    half_angle: float = np.nan
    """Of a cone; that of any other kind counts as 0."""
    radius_interval: Range = (np.nan, np.nan)
    """95 % interval of the diameter that is told, less the truth: it covers the truth where it holds 0."""
    half_angle_interval: Range = (np.nan, np.nan)
    kind: str | None = None
    """None where it was refused."""
    certain: bool = False
    reason: str = ""
    """Of a refusal."""

    @property
    def refused(self) -> bool:
        """Whether there is no size."""
        return bool(np.isnan(self.radius))


def by_program(cloud: Cloud, method: Method, drawing: Drawing | None = None) -> Outcome:
    """What `reconstruct` makes of a cloud, as drawn or with another drawing."""
    result = reconstruct(cloud.frame, drawing or cloud.drawing, Settings(method=method))
    return judged(result, cloud.truth, cloud.place_m)


def judged(result: Reconstruction, truth: Simple, place_m: Floats) -> Outcome:
    """A reconstruction beside the truth, in camera coordinates; radii are compared at the height of a place (3,)."""
    if not isinstance(result.fit, Fit):
        return Outcome(reason=result.fit.reason)
    solid, said = result.fit.solid, answer(result)
    true_radius = radius_at(truth, solid.center_m)
    angle = true_half_angle(truth)
    intervals = result.fit.intervals
    along = float(np.sign(solid.direction @ truth.direction))
    return Outcome(
        radius=radius_at(solid, place_m) / radius_at(truth, place_m) - 1,
        stated=radius_at(solid, solid.center_m) / true_radius - 1,
        half_angle=along * getattr(solid, "half_angle_rad", 0.0) / angle - 1,
        radius_interval=_relative(intervals and intervals.diameter_m, 2 * true_radius),
        half_angle_interval=_relative(intervals and intervals.half_angle_rad, along * angle),
        kind=said["kind"],
        certain=said["certain"],
    )


def radius_at(solid: Primitive, point_m: Floats) -> float:
    """The radius at the height of a point (3,) along the axis, or the ball's."""
    if isinstance(solid, Sphere):
        return solid.radius_m
    return float(solid.radius_at((point_m - solid.center_m) @ solid.direction))


def true_half_angle(truth: Simple) -> float:
    """NaN but for a cone."""
    return truth.half_angle_rad if truth.kind == "cone" and not isinstance(truth, Sphere) else np.nan


def _relative(interval: Range | None, truth: float) -> Range:
    if interval is None:
        return (np.nan, np.nan)
    low, high = sorted((interval[0] / truth - 1, interval[1] / truth - 1))
    return low, high

"""Every variation of the paper's method on every pose: the numbers behind the document."""

from dataclasses import dataclass, replace

import numpy as np

from app.bench.composition import Radii, Steps, compose
from app.bench.poses import KINDS, Pose, poses
from app.bench.variations import EXACT, NOISY, VARIATIONS, Variation
from rotrecon.arrays import Floats
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.outcome import Fit
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings

SETTINGS = Settings(method="paper")


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one object's diameter in N poses, percent; NaN where nothing was measured."""

    first_cut: Floats
    """(N,)"""
    second_cut: Floats
    """(N,)"""
    axis_length: Floats
    """(N,) equation (16), of a ball."""


@dataclass(frozen=True, eq=False)
class Measured:
    """What was measured of one object."""

    object_name: str
    tilt_deg: Floats
    """(N,) of the axis out of the picture's plane."""
    errors: dict[str, Errors]
    """By name of the variation."""
    recognised: dict[str, list[bool]]
    """By name of the variation: whether the program called the object by its kind when it was not told."""


def measure(object_name: str, count: int) -> Measured:
    """All variations on `count` poses of an object."""
    radii: dict[str, list[tuple[float, float, float]]] = {variation.name: [] for variation in VARIATIONS}
    recognised: dict[str, list[bool]] = {EXACT.name: [], NOISY.name: []}
    tilts: list[float] = []
    for pose in poses(object_name, count):
        tilts.append(pose.tilt_deg)
        frames = {errors: pose.frame(errors) for errors in {variation.errors for variation in VARIATIONS}}
        for variation in VARIATIONS:
            found = _radii(frames[variation.errors], pose, variation)
            relative = np.array([found.first_cut_m, found.second_cut_m, found.axis_length_m]) / pose.radius_m
            radii[variation.name].append(tuple(100 * (relative - 1)))
        for variation in (EXACT, NOISY):
            recognised[variation.name].append(_recognised(frames[variation.errors], pose))
    errors = {name: Errors(*np.array(values).T) for name, values in radii.items()}
    return Measured(object_name, np.array(tilts), errors, recognised)


def by_program(frame: Frame, drawing: Drawing) -> Radii:
    """The radii as `reconstruct` gives them by the paper's method."""
    result = reconstruct(frame, drawing, SETTINGS)
    if not isinstance(result.fit, Fit):
        return Radii()
    first, length = result.first_cut_radius_m, result.fit.axis_length_radius_m
    return Radii(
        np.nan if first is None else first,
        result.fit.solid.radius_m,
        np.nan if length is None else length,
    )


def _radii(frame: Frame, pose: Pose, variation: Variation) -> Radii:
    steps = variation.steps(pose)
    if steps == Steps():
        return by_program(frame, pose.drawing)
    return compose(frame, pose.drawing, SETTINGS, steps)


def _recognised(frame: Frame, pose: Pose) -> bool:
    solid = reconstruct(frame, replace(pose.drawing, kind=None), SETTINGS).solid
    return solid is not None and solid.kind == KINDS[pose.simulated.object_name]

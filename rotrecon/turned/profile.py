"""The radius at every height along a fitted axis, with its own interval."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.correlation import Likeness
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import RayFit
from rotrecon.turned.height_radii import height_radii, with_outline
from rotrecon.turned.looks import grazes_at, looks_at
from rotrecon.turned.turned import AXIS_PARAMETERS, Turned

NORMAL_95 = 1.96


@dataclass(frozen=True, eq=False)
class Profile:
    """Radii along an axis: n heights, rising, each with the limits that hold the true one in 95 % of cases."""

    height_m: Floats
    """(n,) from the surface's centre."""
    radius_m: Floats
    """(n,) NaN where too little is seen, or where the depths agree on no one radius."""
    low_m: Floats
    high_m: Floats
    own_m: Floats
    """(n,) standard deviation by the depths of that height alone: the rest is the axis', and moves all together."""
    lean: float
    """Standard deviation of the slope of all radii together, by that of the axis."""
    alike_m: float
    """Length along the axis over which the own errors are alike; 0 if they are independent."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def known(self) -> Bools:
        """(n,) where there is a radius."""
        return np.isfinite(self.radius_m)


def profile_of(fit: RayFit, patch: Patch, heights_m: Floats) -> Profile:
    """Radii at rising heights (n,) about the axis of a fitted cylinder, cone or turned surface.

    The axis is held, and the radius of each height found from its own depths alone, along the rays, whatever the
    surface is there. Their errors and the axis', which is given by the fit's covariance, make the interval.
    Raises TypeError for a ball.
    """
    if not isinstance(fit.surface, Lateral):
        raise TypeError("a ball has no axis along which it has a profile")
    looks = looks_at(fit.surface, patch, heights_m, fit.sight.guard)
    pitch_m = _pitch(looks.surface, patch, heights_m)
    rows = float(np.median(np.diff(heights_m))) / pitch_m
    together = _alike(fit.likeness, rows, len(looks.pixels) / len(heights_m) / rows)
    found = with_outline(height_radii(looks), 1.0 / together, grazes_at(looks.surface, fit.outlines, heights_m))
    info = np.where(found.sound, found.sums.own, np.nan)
    lever = found.sums.mixed / info
    axis = fit.covariance[:AXIS_PARAMETERS, :AXIS_PARAMETERS]
    reach = NORMAL_95 * np.sqrt(1.0 / info + np.einsum("pn,pq,qn->n", lever, axis, lever))
    radius = np.where(found.sound, looks.surface.curve(heights_m)[0] + found.change_m, np.nan)
    length_m = fit.likeness.alike * float(np.sqrt(np.pi)) * fit.likeness.length_px * pitch_m
    lean = _lean(heights_m, lever, axis, found.sound)
    return Profile(heights_m, radius, radius - reach, radius + reach, 1.0 / np.sqrt(info), lean, length_m)


def _alike(likeness: Likeness, rows: float, width: float) -> float:
    """How many times larger the variance of the mean of a strip of pixels is than if they erred independently."""
    together = _together(rows, likeness.length_px) * _together(width, likeness.length_px)
    return 1.0 + likeness.alike * max(together - 1.0, 0.0)


def _together(count: float, length_px: float) -> float:
    """Sum of exp(-(lag / length)^2) over the lags in a row of `count` pixels, seen from its mean pixel."""
    if length_px == 0.0:
        return 1.0
    lag = np.arange(1, int(np.ceil(2.5 * length_px)) + 1)
    share = np.maximum(1.0 - lag / max(count, 1.0), 0.0)
    return 1.0 + 2.0 * float((share * np.exp(-np.square(lag / length_px))).sum())


def _pitch(surface: Turned, patch: Patch, heights_m: Floats) -> float:
    """Height along the axis that a pixel covers in the middle of the profile."""
    around = float(np.median(heights_m)) + np.array([-0.5, 0.5]) * surface.size_m * 0.02
    ridge = -surface.side * surface.curve(around)[0][:, None] * surface.turn[1]
    place_px = patch.camera.project(surface.center_m + around[:, None] * surface.direction + ridge)
    return float(np.ptp(around) / np.linalg.norm(place_px[1] - place_px[0]))


def _lean(heights_m: Floats, lever: Floats, axis: Floats, known: Bools) -> float:
    """Standard deviation of the slope over the heights of what the axis' errors add to the radii."""
    if known.sum() < 2:
        return 0.0
    offset = heights_m[known] - heights_m[known].mean()
    slopes = lever[:, known] @ offset / (offset @ offset)
    return float(np.sqrt(max(slopes @ axis @ slopes, 0.0)))

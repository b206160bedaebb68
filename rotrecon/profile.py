"""The radius at every height along a fitted axis, with its own interval."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.correlation import Likeness
from rotrecon.fitting import tukey
from rotrecon.height_radii import height_radii, looks_at
from rotrecon.patch import Patch
from rotrecon.ray_fit import RayFit
from rotrecon.surfaces import Lateral
from rotrecon.turned import AXIS_PARAMETERS, Turned

EFFICIENCY = 0.95
"""Of the redescending loss (Beaton and Tukey 1974)."""
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
    found = height_radii(looks)
    weight = tukey(found.residual / found.sigma)[1]
    own = found.columns[-1] / found.sigma
    info = np.bincount(looks.place, weight * own**2, looks.count)
    inliers = np.bincount(looks.place, weight > 0, looks.count)
    known = found.sound
    radius = np.where(known, looks.surface.curve(heights_m)[0] + found.change_m, np.nan)
    pitch_m = _pitch(looks.surface, patch, heights_m)
    rows = np.gradient(heights_m) / pitch_m
    alike = _alike(fit.likeness, rows, inliers / np.maximum(rows, 1e-9))
    believed = EFFICIENCY * np.bincount(looks.place, np.where(weight > 0, own**2, 0.0), looks.count)
    own_m = np.where(known, np.sqrt(alike / np.maximum(believed, 1e-300)), np.nan)
    levers = [
        np.bincount(looks.place, weight * own * column / found.sigma, looks.count) for column in found.columns[:-1]
    ]
    lever = np.where(known, np.stack(levers) / np.maximum(info, 1e-300), np.nan)
    axis = fit.covariance[:AXIS_PARAMETERS, :AXIS_PARAMETERS]
    reach = NORMAL_95 * np.sqrt(own_m**2 + np.einsum("pn,pq,qn->n", lever, axis, lever))
    length_m = fit.likeness.alike * np.sqrt(np.pi) * fit.likeness.length_px * pitch_m
    lean = _lean(heights_m, lever, axis, known)
    return Profile(heights_m, radius, radius - reach, radius + reach, own_m, lean, length_m)


def _alike(likeness: Likeness, rows: Floats, width: Floats) -> Floats:
    """How many times larger the variance of the mean of strips of pixels (n,) is than if they erred independently."""
    together = _together(rows, likeness.length_px) * _together(width, likeness.length_px)
    return 1.0 + likeness.alike * np.maximum(together - 1.0, 0.0)


def _together(count: Floats, length_px: float) -> Floats:
    """Sum of exp(-(lag / length)^2) over the lags in a row of `count` pixels (n,), seen from its mean pixel."""
    if length_px == 0.0:
        return np.ones_like(count)
    lag = np.arange(1, int(np.ceil(2.5 * length_px)) + 1)
    share = np.maximum(1.0 - lag / np.maximum(count, 1.0)[:, None], 0.0)
    return 1.0 + 2.0 * (share * np.exp(-np.square(lag / length_px))).sum(axis=1)


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

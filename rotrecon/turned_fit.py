"""A turned surface fitted to a patch: its axis with every height's radius free, then the smooth curve through them."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.correlation import Likeness, likeness_of
from rotrecon.extent import Extent
from rotrecon.fitting import Measurement, refine, tukey
from rotrecon.height_radii import HeightRadii, Looks, height_radii, looks_at
from rotrecon.patch import Patch
from rotrecon.ray_fit import INLIER_SIGMA, OVERSAMPLED, WHOLE, RayFit, Sight, depths_of, near, spread
from rotrecon.smoothness import UNBENT, Smoothness, next_scale
from rotrecon.starts import Ridge
from rotrecon.surfaces import Lateral
from rotrecon.turned import AXIS_PARAMETERS, Turned, turned_from
from rotrecon.turned_start import turned_start

KNOTS = 16
"""Of the curve, enough for a bottle's shoulder; the prior keeps them from bending more than the data ask for."""
HEIGHTS = 60
"""Whose radii are free while the axis is looked for: an edge between two of them costs no more than itself."""
FEWEST_HEIGHTS = 8
"""With fewer known there is no profile."""
SCOUTS, LEAST_PIXELS = 3000, 4000
"""Depths for the search, and at least for the curve."""
ROUNDS = 6
"""Of Gauss and Newton from the start to the axis, the last over all depths."""
MATCHED = 0.25
"""Errors less alike than this are not those of matching windows."""
WINDOW_REACH = 1.0
"""Of a window over the limb, over the length at which errors are alike."""
LEAST_GUARD = 0.65
"""Within this share of the radius depth is taken as it is."""
SMOOTHINGS, ITERATIONS = 4, 3
FIRST_SHARE = 0.02
"""The prior's first scale over the radius."""


@dataclass(frozen=True, eq=False)
class _Axis:
    """An axis found together with the radii of all heights."""

    surface: Turned
    guard: float
    """Share of the radius beside it within which depths were asked."""
    sigma: float
    """Of their residuals."""
    likeness: Likeness
    covariance: Floats
    """(4, 4) of the axis' parameters, whatever the radii are."""

    def __post_init__(self) -> None:
        freeze(self)


def fit_turned(patch: Patch, edge: Ridge, start: RayFit | None = None, extent: Extent | None = None) -> RayFit | None:
    """A turned surface through the depths in the area, as far as the object is segmented, or over an extent.

    `start` is the fit of a cylinder or a cone, which says what of the axis is held, from which side it is seen and
    where an extent is measured from; without it the ridge of the segmented object is enough. None when there are too
    few depths. Raises ValueError for an extent without a start, and TypeError for one that is not lateral. Matching
    windows are not modelled: depths that they may have carried over the limbs are left out.
    """
    if start is None and extent is not None:
        raise ValueError("an extent is measured along an axis; give the fit it belongs to")
    lateral = None if start is None else start.surface
    if lateral is not None and not isinstance(lateral, Lateral):
        raise TypeError("a profile needs an axis; start from a cylinder or a cone")
    free = np.ones(AXIS_PARAMETERS, dtype=np.bool_) if start is None else start.free[:AXIS_PARAMETERS]
    surface = turned_start(patch, edge, lateral, ~free[2:], extent, KNOTS)
    if surface is None:
        return None
    axis = _round(surface, patch, WHOLE, free, SCOUTS)
    for number in range(1, ROUNDS):
        if axis is None:
            return None
        axis = _round(axis.surface, patch, _guard(axis, patch), free, SCOUTS if number < ROUNDS - 1 else None)
    return None if axis is None else _smoothed(axis, patch, free)


def _guard(axis: _Axis, patch: Patch) -> float:
    """Share of the radius within which no matching window reaches over the limbs."""
    if axis.likeness.alike < MATCHED:
        return WHOLE
    surface = axis.surface
    radius_px = surface.size_m * patch.focal_px / float(surface.center_m[2])
    return max(1.0 - WINDOW_REACH * axis.likeness.length_px / radius_px, LEAST_GUARD)


def _round(surface: Turned, patch: Patch, guard: float, free: Bools, most: int | None) -> _Axis | None:
    """A step of Gauss and Newton for the axis and all radii together; None when there are too few depths."""
    heights = np.linspace(surface.low_m, surface.high_m, HEIGHTS)
    looks = looks_at(surface, patch, heights, guard, most)
    found = height_radii(looks)
    known = found.sound
    if known.sum() < FEWEST_HEIGHTS:
        return None
    radius = (looks.surface.curve(heights)[0] + found.change_m)[known]
    gradient, information = _normal_equations(looks, found)
    likeness = _likeness(looks, found, patch)
    share = min(likeness.independent_share / looks.share, 1.0)
    kept = np.ix_(free, free)
    covariance = np.zeros((AXIS_PARAMETERS, AXIS_PARAMETERS))
    covariance[kept] = np.linalg.pinv(information[kept], hermitian=True)
    step = np.concatenate([covariance @ gradient, np.zeros(KNOTS)])
    through = turned_from(surface, heights[known], radius, KNOTS)
    return _Axis(through.stepped(step), guard, found.sigma, likeness, covariance / share)


def _normal_equations(looks: Looks, found: HeightRadii) -> tuple[Floats, Floats]:
    """Gradient (4,) and information (4, 4) of the axis' parameters, with the radii eliminated (Schur complement)."""
    weight = tukey(found.residual / found.sigma)[1] * found.sound[looks.place]
    columns, own = found.columns[:-1] / found.sigma, found.columns[-1] / found.sigma
    weighted = columns * weight
    info = np.maximum(np.bincount(looks.place, weight * own**2, looks.count), 1e-300)
    mixed = np.stack([np.bincount(looks.place, column * own, looks.count) for column in weighted])
    residual = found.residual / found.sigma
    pull = np.bincount(looks.place, weight * own * residual, looks.count)
    return weighted @ residual - mixed @ (pull / info), weighted @ columns.T - (mixed / info) @ mixed.T


def _likeness(looks: Looks, found: HeightRadii, patch: Patch) -> Likeness:
    """How the residuals of those that fit are alike."""
    image = np.full(patch.shape, np.nan)
    image.ravel()[looks.pixels] = np.where(np.abs(found.residual) < INLIER_SIGMA * found.sigma, found.residual, np.nan)
    return likeness_of(image)


def _smoothed(axis: _Axis, patch: Patch, axis_free: Bools) -> RayFit | None:
    """The curve that the depths and the prior want about an axis, and what is known of both together.

    The prior's part of the information makes the intervals of the curve those of Nychka (1988), which hold the truth
    as often as they say on the mean over heights.
    """
    surface, likeness, sight = axis.surface, axis.likeness, Sight(guard=axis.guard)
    pixels = _along(surface, patch, sight)
    every = len(pixels)
    pixels = spread(pixels, max(int(OVERSAMPLED * likeness.independent_share * every), LEAST_PIXELS))
    if len(pixels) < 2 * KNOTS:
        return None
    depths = depths_of(patch, pixels)
    share = min(likeness.independent_share * every / len(pixels), 1.0)
    units = surface.units(surface.high_m - surface.low_m)
    free = np.arange(len(units)) >= AXIS_PARAMETERS
    scale_m, information = FIRST_SHARE * surface.size_m, np.eye(len(units))
    for _ in range(SMOOTHINGS):
        measurements: list[Measurement] = [depths, Smoothness.of(surface, scale_m)]
        refined = refine(surface, measurements, [(axis.sigma, share), UNBENT], tukey, free, units, ITERATIONS)
        assert isinstance(refined.surface, Turned)
        surface, information = refined.surface, refined.information
        scale_m = next_scale(surface, information, scale_m, free)
    residual = depths.predict(surface).residual
    covariance = _joint(axis.covariance, information)
    free = np.concatenate([axis_free, free[AXIS_PARAMETERS:]])
    return RayFit(surface, sight, (), free, pixels, residual, axis.sigma, likeness, covariance)


def _along(surface: Turned, patch: Patch, sight: Sight) -> Indices:
    """Pixels beside the stroke that look at the profile, or closely past it."""
    pixels = near(surface, patch, patch.drawn & np.isfinite(patch.depth_m), sight)
    height = surface.heights((patch.rays[:, pixels] * patch.depth_m[pixels]).T)
    return pixels[(height > surface.low_m) & (height < surface.high_m)]


def _joint(axis: Floats, information: Floats) -> Floats:
    """Covariance (4 + K, 4 + K) of an axis of a known one and of a curve that follows it as the information says."""
    mixed, own = information[AXIS_PARAMETERS:, :AXIS_PARAMETERS], information[AXIS_PARAMETERS:, AXIS_PARAMETERS:]
    curve = np.linalg.pinv(own, hermitian=True)
    follows = -curve @ mixed
    return np.block([[axis, axis @ follows.T], [follows @ axis, curve + follows @ axis @ follows.T]])

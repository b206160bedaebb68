"""A turned surface fitted to a patch: its axis with every height's radius free, then the smooth curve through them."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.extent import Extent
from rotrecon.rays.correlation import Likeness, likeness_of
from rotrecon.rays.fitting import Measurement, Outlines, refine
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.losses import tukey
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import INLIER_SIGMA, OVERSAMPLED, WHOLE, RayFit, Sight, depths_of, spread
from rotrecon.rays.starts import Ridge
from rotrecon.turned.height_radii import HeightRadii, height_radii, with_outline
from rotrecon.turned.looks import Looks, grazes_at, looks_at
from rotrecon.turned.smoothness import UNBENT, Radii, Smoothness, next_scale
from rotrecon.turned.turned import AXIS_PARAMETERS, Turned, turned_from
from rotrecon.turned.turned_start import turned_start

KNOTS = 16
"""Of the curve, enough for a bottle's shoulder; the prior keeps them from bending more than the data ask for."""
HEIGHTS = 60
"""Whose radii are free while the axis is looked for: an edge between two of them costs no more than itself."""
FEWEST_HEIGHTS = 8
"""With fewer known there is no profile."""
SCOUTS, LEAST_PIXELS = 2500, 4000
"""Depths for the search, and at least for the curve."""
ROUNDS = 3
"""Of Gauss and Newton between the first and the last, which is over all depths."""
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
class _Task:
    """What stays the same from round to round."""

    patch: Patch
    free: Bools
    """(4,) which of the axis' parameters are."""
    outlines: Outlines

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class _Axis:
    """An axis found together with the radii of all heights."""

    surface: Turned
    radii: Radii
    guard: float
    """Share of the radius beside it within which depths were asked."""
    pixels: Indices
    sigma: float
    """Of their residuals."""
    likeness: Likeness
    covariance: Floats
    """(4, 4) of the axis' parameters, whatever the radii are."""

    def __post_init__(self) -> None:
        freeze(self)


def fit_turned(patch: Patch, edge: Ridge, start: RayFit | None = None, extent: Extent | None = None) -> RayFit | None:
    """A turned surface through the depths in the area, as far as the object is segmented, or over an extent.

    `start` is the fit of a cylinder or a cone, which says what of the axis is held, from which side it is seen, where
    an extent is measured from, and what is known of the outline; without it the ridge of the segmented object is
    enough. None when there are too few depths. Raises ValueError for an extent without a start, and TypeError for a
    start that is not lateral. Matching windows are not modelled: depths that they may have carried over the limbs are
    left out.
    """
    if start is None and extent is not None:
        raise ValueError("an extent is measured along an axis; give the fit it belongs to")
    lateral = None if start is None else start.surface
    if lateral is not None and not isinstance(lateral, Lateral):
        raise TypeError("a profile needs an axis; start from a cylinder or a cone")
    free = np.ones(AXIS_PARAMETERS, dtype=np.bool_) if start is None else start.free[:AXIS_PARAMETERS]
    task = _Task(patch, free, () if start is None else start.outlines)
    surface = turned_start(patch, edge, lateral, ~free[2:], extent, task.outlines, KNOTS)
    axis = None if surface is None else _round(surface, task, WHOLE, SCOUTS)
    for most in (*[SCOUTS] * ROUNDS, None):
        if axis is None:
            return None
        axis = _round(axis.surface, task, _guard(axis, patch), most)
    return None if axis is None else _smoothed(axis, task)


def _guard(axis: _Axis, patch: Patch) -> float:
    """Share of the radius within which no matching window reaches over the limbs."""
    if axis.likeness.alike < MATCHED:
        return WHOLE
    surface = axis.surface
    radius_px = surface.size_m * patch.focal_px / float(surface.center_m[2])
    return max(1.0 - WINDOW_REACH * axis.likeness.length_px / radius_px, LEAST_GUARD)


def _round(surface: Turned, task: _Task, guard: float, most: int | None) -> _Axis | None:
    """A step of Gauss and Newton for the axis and all radii together; None when there are too few depths."""
    heights = np.linspace(surface.low_m, surface.high_m, HEIGHTS)
    looks = looks_at(surface, task.patch, heights, guard, most)
    found = height_radii(looks)
    likeness = _likeness(looks, found, task.patch)
    independent = min(likeness.independent_share / looks.share, 1.0)
    found = with_outline(found, independent, grazes_at(surface, task.outlines, heights))
    known = found.sound
    if known.sum() < FEWEST_HEIGHTS:
        return None
    gradient, information = found.sums.of_axis()
    kept = np.ix_(task.free, task.free)
    covariance = np.zeros((AXIS_PARAMETERS, AXIS_PARAMETERS))
    covariance[kept] = np.linalg.pinv(information[kept], hermitian=True)
    step = covariance @ gradient
    own = np.maximum(found.sums.own[known], 1e-300)
    lever = found.sums.mixed[:, known] / own
    # each radius belongs to the axis it was found about, and follows the step
    radius = (surface.curve(heights)[0] + found.change_m)[known] - step @ lever
    through = turned_from(surface, heights[known], radius, KNOTS)
    radii = Radii(heights[known], radius, 1.0 / np.sqrt(own), lever)
    stepped = through.stepped(np.concatenate([step, np.zeros(KNOTS)]))
    return _Axis(stepped, radii, guard, looks.pixels, found.sigma, likeness, covariance)


def _likeness(looks: Looks, found: HeightRadii, patch: Patch) -> Likeness:
    """How the residuals of those that fit are alike."""
    image = np.full(patch.shape, np.nan)
    image.ravel()[looks.pixels] = np.where(np.abs(found.residual) < INLIER_SIGMA * found.sigma, found.residual, np.nan)
    return likeness_of(image)


def _smoothed(axis: _Axis, task: _Task) -> RayFit:
    """The curve that the radii and the prior want about an axis, and what is known of both together.

    The prior's part of the information makes the intervals of the curve those of Nychka (1988), which hold the truth
    as often as they say on the mean over heights.
    """
    surface, patch = axis.surface, task.patch
    units = surface.units(surface.high_m - surface.low_m)
    curve = np.arange(len(units)) >= AXIS_PARAMETERS
    scale_m, information = FIRST_SHARE * surface.size_m, np.eye(len(units))
    for _ in range(SMOOTHINGS):
        measurements: list[Measurement] = [axis.radii, Smoothness(scale_m)]
        refined = refine(surface, measurements, [(1.0, 1.0), UNBENT], tukey, curve, units, ITERATIONS)
        assert isinstance(refined.surface, Turned)
        surface, information = refined.surface, refined.information
        scale_m = next_scale(surface, information, scale_m, curve)
    covariance = _joint(axis.covariance, information)
    pixels = spread(
        axis.pixels, max(int(OVERSAMPLED * axis.likeness.independent_share * len(axis.pixels)), LEAST_PIXELS)
    )
    residual = depths_of(patch, pixels).predict(surface).residual
    free = np.concatenate([task.free, curve[AXIS_PARAMETERS:]])
    sight = Sight(guard=axis.guard)
    return RayFit(surface, sight, task.outlines, free, pixels, residual, axis.sigma, axis.likeness, lambda: covariance)


def _joint(axis: Floats, information: Floats) -> Floats:
    """Covariance (4 + K, 4 + K) of an axis of a known one and of a curve that follows it as the information says."""
    mixed, own = information[AXIS_PARAMETERS:, :AXIS_PARAMETERS], information[AXIS_PARAMETERS:, AXIS_PARAMETERS:]
    curve = np.linalg.pinv(own, hermitian=True)
    follows = -curve @ mixed
    return np.block([[axis, axis @ follows.T], [follows @ axis, curve + follows @ axis @ follows.T]])

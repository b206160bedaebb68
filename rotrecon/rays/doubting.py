"""How much less sure a fit is of its size where another way to it ends elsewhere; measured on simulated stereo."""

from dataclasses import replace

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.ray_fit import RayFit
from rotrecon.rays.surfaces import Surface

CORRECTION_DOUBT = 0.25
"""Standard deviation of what one way to a size changes, over the change: neither way is without error."""
CONE_DOUBT, BALL_DOUBT = 0.1, 1.1
"""The same of a cone, whose depths hold it by more than its size, and of a ball, whose panels and shadows run along its
outline."""
ONE_SIDED_DOUBT, TAPERED_DOUBT, TWO_SIDED_DOUBT = 1.25, 0.1, 0.016
"""That of what an outline changes, over the geometric mean of the change and the fit's own standard deviation: where it
is seen on one side only, which alone says no width; on both of a cone; and on both of a cylinder half of which is one
matching window wide."""
MOST_WINDOWS = 6.0
"""Beyond so many, depths tell no more of a width."""


def sizes_of(surface: Surface) -> Floats:
    """Radius, and slope where it is a parameter."""
    if isinstance(surface, Lateral) and surface.tapers:
        return np.array([surface.radius_m, surface.slope])
    return np.array([surface.radius_m])


def doubting(fit: RayFit, other: RayFit, share: float | None = None) -> RayFit:
    """A fit that is less sure of its size by a share of its difference from another, which believes other things.

    The share is by default that of its kind of surface.
    """
    return _less_sure(fit, (_share(fit.surface) if share is None else share) * _apart(fit, other))


def doubting_outline(both: RayFit, depths: RayFit, windows: float) -> RayFit:
    """A fit to depths and an outline that is less sure of its radius by some of what the outline changes.

    What depths alone are off by says less, the more of the fit's own standard deviations it is: an outline seen on both
    sides is as wide as the object, whatever they are worth, and converges as the object does. They are worth the more,
    the more matching `windows` half of the object is wide.
    """
    if isinstance(both.surface, Ball):
        return doubting(both, depths)
    sides = max(len(outline.alike) for outline, _ in both.outlines)
    own = float(np.sqrt(both.covariance[both.surface.size_place, both.surface.size_place]))
    radius_only = np.arange(len(sizes_of(both.surface))) == 0
    apart = np.sqrt(own * np.abs(_apart(both, depths))) * radius_only
    if sides == 1:
        return _less_sure(both, ONE_SIDED_DOUBT * apart)
    tapers = len(radius_only) > 1
    return _less_sure(both, (TAPERED_DOUBT if tapers else TWO_SIDED_DOUBT * min(windows, MOST_WINDOWS) ** 2) * apart)


def _apart(fit: RayFit, other: RayFit) -> Floats:
    return sizes_of(fit.surface) - sizes_of(other.surface)


def _less_sure(fit: RayFit, by: Floats) -> RayFit:
    """A fit whose sizes have a common error of a standard deviation more."""
    error = np.zeros(len(fit.free))
    error[fit.surface.size_place :] = by
    return replace(fit, doubt=fit.doubt + np.outer(error, error))


def _share(surface: Surface) -> float:
    if isinstance(surface, Ball):
        return BALL_DOUBT
    return CONE_DOUBT if surface.tapers else CORRECTION_DOUBT

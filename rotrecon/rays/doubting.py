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
CONE_DOUBT, BALL_DOUBT = 0.1, 0.9
"""The same of a cone, whose depths hold it by more than its size, and of a ball, whose panels and shadows run along its
outline."""
ONE_SIDED_DOUBT = 0.75
"""The same where an outline is seen on one side only, which alone says no width."""
TWO_SIDED_DOUBT = 0.3
"""Where both sides are seen: that of the geometric mean of the change and the fit's own standard deviation."""


def sizes_of(surface: Surface) -> Floats:
    """Radius, and slope where it is a parameter."""
    if isinstance(surface, Lateral) and surface.tapers:
        return np.array([surface.radius_m, surface.slope])
    return np.array([surface.radius_m])


def doubting(fit: RayFit, other: RayFit) -> RayFit:
    """A fit that is less sure of its size by a share of its difference from another, which believes other things."""
    return _less_sure(fit, _share(fit.surface) * _apart(fit, other))


def doubting_outline(both: RayFit, depths: RayFit) -> RayFit:
    """A fit to depths and an outline that is less sure by some of what the outline changes.

    Between its two sides an outline is as wide as the object, whatever the depths are worth: what they are off by says
    less, the more of its own standard deviations it is, and nothing of how the sides converge.
    """
    apart = _apart(both, depths)
    if isinstance(both.surface, Ball):
        return doubting(both, depths)
    if max(len(outline.alike) for outline, _ in both.outlines) < 2:
        return _less_sure(both, ONE_SIDED_DOUBT * apart)
    own = float(np.sqrt(both.covariance[both.surface.size_place, both.surface.size_place]))
    return _less_sure(both, TWO_SIDED_DOUBT * np.sqrt(own * np.abs(apart)) * (np.arange(len(apart)) == 0))


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

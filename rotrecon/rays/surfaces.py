"""Surfaces that can be fitted."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.primitives import basis_across
from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.traces import Rays

Surface = Lateral | Ball


def radius_seen_m(surface: Surface, rays: Rays) -> float:
    """The radius where some rays (3, N) meet a surface, in the median: that of a cone at its centre may be far off."""
    if isinstance(surface, Ball) or surface.slope == 0:
        return surface.radius_m
    heights_m = surface.heights((rays * surface.meet(rays)[0]).T)
    return surface.radius_m + surface.slope * float(np.median(heights_m))


def turn_of(direction: Floats, toward: Floats) -> Floats:
    """(3, 3) rows: a unit vector across, one toward `toward`, and `direction`; a rotation."""
    return np.stack([*basis_across(direction, toward), direction])

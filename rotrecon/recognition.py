"""Which kind of solid the depths speak for, and which others they leave possible (paper table 1)."""

import numpy as np

from rotrecon.intervals import ball_intervals, lateral_intervals, turned_intervals
from rotrecon.outcome import Candidate, Intervals, Range
from rotrecon.primitives import Frustum, Kind, Primitive, Revolution, Sphere
from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.robust import Ranked
from rotrecon.sections.radii import SHAPE_OF_KIND
from rotrecon.settings import Settings
from rotrecon.turned.turned import Turned

PROFILE_POINTS = 65
"""Heights at which a smooth profile is told: an odd number, one of them the middle."""


def chosen_of(ranked: tuple[Ranked, ...], kind: Kind | None, settings: Settings) -> Ranked | None:
    """The most credible shape, or that of the kind asked for; None when the depths speak against that kind.

    A cone that hardly tapers is a cylinder unless the depths insist: of many cylinders some look like such a cone. One
    that cannot taper much is a cylinder whatever they say, if there is one of its size.
    """
    fitted = [one for one in ranked if one.fit is not None]
    if kind is not None:
        asked = [one for one in fitted if one.shape == SHAPE_OF_KIND[kind] and one.cost <= settings.asked_cost]
        return asked[0] if asked else None
    best = fitted[0]
    if best.shape == "cone" and abs(half_angle_rad(best)) < settings.cone_half_angle_rad:
        low_m, high_m = intervals_of(best, 0.0, None).diameter_m
        for one in fitted:
            as_wide = low_m <= 2 * one.surface.size_m <= high_m and is_straight(best, settings)
            if one.shape == "cylinder" and (one.cost <= settings.tapers_cost or as_wide):
                return one
    return best


def half_angle_rad(one: Ranked) -> float:
    """Of a shape; 0 for all but cones."""
    return float(np.arctan(one.surface.slope)) if one.shape == "cone" and isinstance(one.surface, Lateral) else 0.0


def is_possible(one: Ranked, chosen: Ranked, settings: Settings) -> bool:
    """Whether the object may be of a shape other than the chosen one, in a way that makes a difference."""
    if one is chosen:
        return True
    if one.fit is None or chosen.shape == "revolution" or one.cost - chosen.cost > settings.excluded_cost:
        return False
    if one.shape == "cone" and chosen.shape == "cylinder":
        # a cone holds every cylinder: it is another kind only as far as it may taper
        return not is_straight(one, settings)
    return True


def is_straight(one: Ranked, settings: Settings) -> bool:
    """Whether a cone tapers so little, at any angle it may have, that it is as good as a cylinder."""
    assert one.fit is not None
    assert isinstance(one.surface, Lateral)
    low, high = intervals_of(one, 0.0, None).half_angle_rad or (0.0, 0.0)
    return max(abs(low), abs(high)) < settings.cone_half_angle_rad


def intervals_of(one: Ranked, middle_m: float, length_m: Range | None) -> Intervals:
    """Of a fitted shape, a lateral one's diameter at a height of `middle_m` from its surface's centre."""
    assert one.fit is not None
    if isinstance(one.surface, Ball):
        return ball_intervals(one.fit, one.surface)
    if isinstance(one.surface, Turned):
        return turned_intervals(one.fit, one.surface, middle_m, length_m)
    return lateral_intervals(one.fit, one.surface, middle_m, length_m)


def candidates_of(
    ranked: tuple[Ranked, ...], chosen: Ranked, middle_m: float, settings: Settings
) -> tuple[Candidate, ...]:
    """All shapes as candidates, the chosen one first; scores are the weights of the information criterion."""
    order = [chosen, *(one for one in ranked if one is not chosen)]
    weight = np.exp([-one.cost for one in order])
    return tuple(
        Candidate(
            kind=one.shape,
            radius_m=_radius_at(one, middle_m),
            score=float(share),
            half_angle_rad=half_angle_rad(one),
            diameter_m=None if one.fit is None else intervals_of(one, middle_m, None).diameter_m,
            possible=is_possible(one, chosen, settings),
        )
        for one, share in zip(order, weight / weight.sum(), strict=True)
    )


def _radius_at(one: Ranked, middle_m: float) -> float:
    surface = one.surface
    if isinstance(surface, Turned):
        return float(surface.curve(np.array([middle_m]))[0][0])
    return surface.radius_m + surface.slope * middle_m if isinstance(surface, Lateral) else surface.radius_m


def solid_of(one: Ranked, kind: Kind | None, ends_m: Range, direction: np.ndarray, settings: Settings) -> Primitive:
    """A shape as a solid, a lateral one between two heights from its surface's centre; `direction` is a ball's."""
    surface = one.surface
    if isinstance(surface, Ball):
        return Sphere(surface.center_m, direction, surface.radius_m)
    if isinstance(surface, Turned):
        return _turned_solid(surface, ends_m)
    length_m, middle_m = ends_m[1] - ends_m[0], (ends_m[0] + ends_m[1]) / 2
    radius_m = surface.radius_m + surface.slope * middle_m
    thin = 2 * radius_m <= settings.rod_diameter_m and length_m >= 2 * settings.rod_length_over_diameter * radius_m
    is_rod = kind == "rod" or (kind is None and thin)
    return Frustum(
        kind="cone" if one.shape == "cone" else "rod" if is_rod else "cylinder",
        center_m=surface.center_m + middle_m * surface.direction,
        direction=surface.direction,
        length_m=length_m,
        radius_m=radius_m,
        half_angle_rad=half_angle_rad(one),
    )


def _turned_solid(surface: Turned, ends_m: Range) -> Revolution:
    """A turned surface between two heights from its centre."""
    middle_m = (ends_m[0] + ends_m[1]) / 2
    along_m = np.linspace(ends_m[0], ends_m[1], PROFILE_POINTS)
    return Revolution(
        center_m=surface.center_m + middle_m * surface.direction,
        direction=surface.direction,
        along_m=along_m - middle_m,
        radii_m=surface.curve(along_m)[0],
    )

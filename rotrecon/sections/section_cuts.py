"""Cuts through the object: the circles of its sections and the axis through their centres (paper 3.3, 3.4)."""

from dataclasses import replace

from rotrecon.arrays import Cloud, Floats, Indices
from rotrecon.axis import FittedAxis, SpaceSections, cut_in_space, fit_axis, span_along
from rotrecon.circles import SectionCircles, SectionState, circumcircles
from rotrecon.reconstruction import Cut
from rotrecon.settings import Settings


def cut(points_m: Floats, count: Indices, settings: Settings) -> Cut:
    """Circles through the base points (S, 3, 3) of sections, and their axis."""
    circles = circumcircles(points_m, count, settings)
    return Cut(circles, fit_axis(circles, settings))


def cut_until_settled(
    cloud_m: Cloud, pixel: Indices, first: SectionCircles, axis: FittedAxis, settings: Settings
) -> tuple[SpaceSections, Cut]:
    """Pixels (M,) of a cloud (H, W, 3) cut across an axis in space, and again while the axis so found still turns.

    As many sections as the `first` cut has, over the length that its circles cover. A cut tilted by t gives radii
    wrong by about t^2 / 2.
    """
    circles, cuts_left = first, settings.cuts_in_space
    while True:
        sections = cut_in_space(cloud_m, pixel, axis, span_along(axis, circles), len(first.state))
        latest, cuts_left = cut(*sections.base_points(), settings), cuts_left - 1
        if latest.axis is None or cuts_left == 0 or axis.turn_to(latest.axis) < settings.axis_settled_rad:
            return sections, latest
        axis, circles = latest.axis, latest.circles


def without(whole: Cut, excluded: frozenset[int], settings: Settings) -> Cut:
    """A cut less the sections that the operator took out: last, so that they keep the numbers he knows them by."""
    state = whole.circles.state.copy()
    numbers = [section for section in excluded if 0 <= section < len(state)]
    if not numbers:
        return whole
    state[numbers] = SectionState.EXCLUDED
    circles = replace(whole.circles, state=state)
    return Cut(circles, fit_axis(circles, settings))

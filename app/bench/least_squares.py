"""A circle through all points of a section by least squares, in place of three of its points."""

from dataclasses import replace

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.axis import SpaceSections
from rotrecon.circles import SectionCircles


def least_squares_circles(circles: SectionCircles, sections: SpaceSections) -> SectionCircles:
    """The circles of all sections through all of their points; sections without a circle stay without.

    In a section's plane x^2 + y^2 = 2 a x + 2 b y + c is linear in the centre (a, b) and in c (Kasa 1976).
    """
    used = circles.used
    section = np.repeat(np.arange(len(used)), np.diff(sections.start))
    points_m = sections.points_of(np.ones(len(used), dtype=np.bool_))
    across, toward = sections.across, sections.toward_camera
    terms = np.concatenate([2 * sections.in_plane(points_m).T, np.ones((1, len(points_m)))])
    squared = (terms[0] ** 2 + terms[1] ** 2) / 4

    def summed(values: Floats) -> Floats:
        return np.bincount(section, weights=values, minlength=len(used))[used].astype(np.float64)

    normal = np.array([[summed(row * column) for column in terms] for row in terms])
    right = np.array([summed(row * squared) for row in terms])
    a, b, c = np.linalg.solve(np.moveaxis(normal, -1, 0), right.T[..., None])[..., 0].T
    center_m, radius_m = circles.center_m.copy(), circles.radius_m.copy()
    height = sections.axis.along(center_m[used])[:, None] * sections.axis.direction
    center_m[used] = sections.axis.point_m + height + a[:, None] * across + b[:, None] * toward
    radius_m[used] = np.sqrt(c + a**2 + b**2)
    return replace(circles, center_m=center_m, radius_m=radius_m)

"""A surface beside the area and the stroke that were drawn."""

from dataclasses import replace

import numpy as np
import pytest

from rotrecon.drawing import CrossSegments, cut_sections
from rotrecon.photometry.drawn import as_wide_as_drawn, may_be_ball
from rotrecon.primitives import Frustum, Sphere
from rotrecon.rays.surfaces import turn_of
from rotrecon.simulation.ideal_drawing import ideal_drawing
from tests.pairs import BALL, CAMERA, CONE, LEG, surface_of


def segments_of(solid: Frustum | Sphere) -> CrossSegments:
    drawing = ideal_drawing(solid, CAMERA)
    return cut_sections(drawing.area, drawing.stroke, (CAMERA.width, CAMERA.height))


@pytest.mark.parametrize("tilt", [-0.9, 0.0, 0.9])
@pytest.mark.parametrize("shape", [LEG, CONE, BALL], ids=["leg", "cone", "ball"])
def test_the_true_size_is_as_wide_as_it_is_drawn_however_it_lies_and_a_fifth_more_is_not(shape, tilt):
    place = np.eye(4)
    place[:3, 3] = 0.0, 0.0, 0.4
    axis = np.array([0.3, np.cos(tilt), np.sin(tilt)])
    place[:3, :3] = turn_of(axis / np.linalg.norm(axis), -place[:3, 3]).T
    solid = shape.moved(place)
    segments = segments_of(solid)
    surface = surface_of(solid)
    assert as_wide_as_drawn(surface, CAMERA, segments, 0.15, 1.0)
    wider = replace(surface, radius_m=1.25 * surface.radius_m)
    assert not as_wide_as_drawn(wider, CAMERA, segments, 0.15, 1.0)
    assert as_wide_as_drawn(wider, CAMERA, segments, 0.15, 3.0)


@pytest.mark.parametrize(("shape", "may"), [(BALL, True), (LEG, False)], ids=["ball", "leg"])
def test_what_is_drawn_much_longer_than_wide_is_no_ball(shape, may):
    place = np.eye(4)
    place[:3, 3] = 0.0, 0.0, 0.4
    place[:3, :3] = turn_of(np.array([0.6, 0.8, 0.0]), -place[:3, 3]).T
    assert may_be_ball(segments_of(shape.moved(place))) == may

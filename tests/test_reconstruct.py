"""Laws of the whole method: what moves, turns, mirrors or scales the scene does the same to the result."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rotrecon.drawing import AreaOfInterest, Drawing, DrawingError, ObjectAxis
from rotrecon.fitting import FailureReason, Fit, FitFailure
from rotrecon.frame import Frame
from rotrecon.primitives import Frustum, Sphere
from rotrecon.reconstruct import Reconstruction, reconstruct
from rotrecon.settings import Settings
from rotrecon.workspace import Workspace
from tests.exact import CAMERA, cone, cylinder, drawing_along, exact_frame

PAPER = Settings()
slow = settings(max_examples=25, deadline=None)


def measured(result: Reconstruction) -> Fit:
    assert isinstance(result.fit, Fit), result.fit
    return result.fit


def direction_of(tilt_deg: float, roll_deg: float) -> np.ndarray:
    tilt, roll = np.deg2rad([tilt_deg, roll_deg])
    return np.array([np.cos(tilt) * np.cos(roll), np.cos(tilt) * np.sin(roll), np.sin(tilt)])


@slow
@given(st.floats(-60, 60), st.floats(0, 360), st.floats(0.02, 0.1), st.floats(0.6, 1.2))
def test_exact_cylinder_has_its_radius_after_the_second_cut(tilt, roll, diameter, distance):
    solid = cylinder(np.array([0.02, -0.03, distance]), direction_of(tilt, roll), diameter)
    result = reconstruct(exact_frame(solid), drawing_along(solid, 0.7, kind="cylinder"), PAPER)
    fit = measured(result)
    assert fit.solid.radius_m == pytest.approx(diameter / 2, rel=1e-3)
    assert fit.solid.direction @ solid.direction > np.cos(np.deg2rad(0.3))


@pytest.mark.parametrize(
    ("center", "direction"),
    [([0, 0, 0.8], [1, 0, 0]), ([0, 0, 0.8], [0, 1, 0]), ([0.02, 0.16, 0.7], [0, 0, -1]), ([-0.2, 0, 0.8], [0, 0, 1])],
)
def test_axis_along_each_coordinate_axis(center, direction):
    solid = cylinder(np.array(center), np.array(direction), 0.08)
    fit = measured(reconstruct(exact_frame(solid), drawing_along(solid, 0.7, kind="cylinder"), PAPER))
    assert fit.solid.radius_m == pytest.approx(0.04, rel=1e-3)
    assert fit.solid.direction @ solid.direction > 0.9999

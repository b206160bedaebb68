import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotrecon.circles import SectionState, base_points, circumcircles
from rotrecon.settings import Settings

PAPER = Settings(method="paper")
coordinates = st.floats(-2, 2)


def arc(center, x, y, radius, half_arc):
    return np.array([center + radius * (np.sin(a) * x + np.cos(a) * y) for a in (-half_arc, 0.3 * half_arc, half_arc)])


@given(
    st.tuples(coordinates, coordinates, st.floats(1, 3)),
    st.integers(0, 2**31),
    st.floats(0.01, 0.5),
    st.floats(0.2, 2.8),
)
def test_circle_through_three_of_its_points(center, seed, radius, half_arc):
    x, y, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0].T
    points = arc(np.array(center), x, y, radius, half_arc)[None]
    circles = circumcircles(points, np.array([50], dtype=np.int32), PAPER)
    assert circles.radius_m[0] == pytest.approx(radius, rel=1e-6)
    assert circles.center_m[0] == pytest.approx(np.array(center), abs=1e-6)


@pytest.mark.parametrize("half_arc_deg", [20, 60, 85, 100, 150])
def test_visible_arc_and_side(half_arc_deg):
    toward_camera = np.array([0, 0, -1.0])
    points = arc(np.array([0, 0, 1.0]), np.array([1.0, 0, 0]), toward_camera, 0.1, np.deg2rad(half_arc_deg))
    circles = circumcircles(points[None], np.array([9], dtype=np.int32), PAPER)
    assert np.degrees(circles.arc_rad[0]) == pytest.approx(2 * half_arc_deg)
    assert not circles.concave[0]
    inside = arc(np.array([0, 0, 1.0]), np.array([1.0, 0, 0]), -toward_camera, 0.1, np.deg2rad(half_arc_deg))
    assert circumcircles(inside[None], np.array([9], dtype=np.int32), PAPER).concave[0]


def test_sections_without_a_circle_say_why():
    line = np.array([[0, 0, 1], [0.05, 0, 1], [0.1, 0, 1.0]])
    points = np.stack([line, line, np.full((3, 3), np.nan)])
    circles = circumcircles(points, np.array([50, 2, 0], dtype=np.int32), PAPER)
    assert circles.state.tolist() == [SectionState.COLLINEAR, SectionState.TOO_FEW_PIXELS, SectionState.EMPTY]
    assert np.isnan(circles.radius_m).all()


def test_base_points_are_the_first_the_middle_and_the_last_that_were_kept():
    points = np.arange(2 * 10 * 3, dtype=np.float32).reshape(2, 10, 3)
    pixel = np.arange(20, dtype=np.int32).reshape(2, 10)
    kept = np.zeros((2, 10), dtype=bool)
    kept[0, [1, 2, 4, 7, 9]] = True
    base, count = base_points(points, pixel, kept)
    assert count.tolist() == [5, 0]
    assert np.array_equal(base[0], points[0, [1, 4, 9]])
    assert np.isnan(base[1]).all()

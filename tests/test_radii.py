import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotrecon.sections.radii import axis_length_radius, fit_radii
from rotrecon.settings import Settings

PAPER = Settings(method="paper")
ALONG = np.linspace(-0.05, 0.06, 40)
ALL = np.ones(40, dtype=bool)


@given(st.floats(0.01, 0.5))
def test_constant_radii_are_a_cylinder(radius):
    fit = fit_radii("cylinder", ALONG, np.full(40, radius), ALL, PAPER)
    assert fit is not None
    assert fit.radius_m == pytest.approx(radius)
    assert fit.kept.all()


@given(st.floats(0.1, 0.5), st.floats(-0.8, 0.8))
def test_linear_radii_are_a_cone(radius, slope):
    fit = fit_radii("cone", ALONG, radius + slope * ALONG, ALL, PAPER)
    assert fit is not None
    assert (fit.radius_m, fit.slope) == pytest.approx((radius, slope), abs=1e-9)
    assert fit.radius_at_middle(ALONG) == pytest.approx(radius + slope * 0.005)


@given(st.floats(0.08, 0.5), st.floats(-0.01, 0.01))
def test_circular_radii_are_a_sphere(radius, center):
    fit = fit_radii("sphere", ALONG, np.sqrt(radius**2 - (ALONG - center) ** 2), ALL, PAPER)
    assert fit is not None
    assert (fit.radius_m, fit.center_m) == pytest.approx((radius, center), abs=1e-9)


def test_radii_that_deviate_by_more_than_the_mean_deviation_are_dropped():
    radii = np.full(40, 0.05)
    radii[7] = 0.09
    fit = fit_radii("cylinder", ALONG, radii, ALL, PAPER)
    assert fit is not None
    assert np.flatnonzero(~fit.kept).tolist() == [7]
    assert fit.radius_m == pytest.approx(0.05)
    assert fit.deviation_m == pytest.approx(2 * 39 / 40 * 0.001, rel=1e-6)


def test_radii_of_no_sphere_are_none():
    hyperbola = np.sqrt(0.01 + 30 * (ALONG + 0.3) ** 2)
    fit = fit_radii("sphere", ALONG, hyperbola, ALL, PAPER)
    assert fit is None or fit.radius_m > 0


def test_half_the_way_from_the_first_to_the_last_centre():
    assert axis_length_radius(np.array([[0, 0, 1.0], [5, 5, 5], [0, 0.2, 1]])) == pytest.approx(0.1)

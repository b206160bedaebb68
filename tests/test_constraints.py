"""What the operator knows beforehand is obeyed, or refused with a reason."""

from dataclasses import replace

import numpy as np
import pytest

from rotrecon.drawing import Constraints
from rotrecon.outcome import FailureReason, FitFailure
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from tests.exact import cylinder, drawing_along, exact_frame, measured, noisy

BODY = cylinder(np.array([0.02, 0, 0.8]), np.array([0.1, 1.0, 0.3]), 0.08)
FRAME = noisy(exact_frame(BODY), seed=1)


def fit_with(constraints: Constraints):
    return reconstruct(FRAME, replace(drawing_along(BODY), constraints=constraints), Settings()).fit


def test_known_radius_is_kept_and_has_no_interval():
    fit = fit_with(Constraints(radius_m=(0.0403, 0.0403)))
    assert fit.solid.radius_m == pytest.approx(0.0403, abs=1e-12)
    assert fit.intervals.diameter_m == pytest.approx((0.0806, 0.0806), abs=1e-9)


def test_range_that_holds_the_radius_changes_nothing():
    free, limited = fit_with(Constraints()), fit_with(Constraints(radius_m=(0.038, 0.042)))
    assert limited.solid.radius_m == pytest.approx(free.solid.radius_m, rel=1e-3)


@pytest.mark.parametrize(("limits", "word"), [((0.05, 0.06), "smaller"), ((0.02, 0.03), "larger")])
def test_range_beside_the_radius_is_refused(limits, word):
    fit = fit_with(Constraints(radius_m=limits))
    assert isinstance(fit, FitFailure)
    assert fit.reason == FailureReason.CONSTRAINED
    assert word in fit.advice


def test_direction_along_the_stroke_is_held():
    result = reconstruct(FRAME, replace(drawing_along(BODY), constraints=Constraints(direction="drawn")), Settings())
    assert np.degrees(np.arccos(abs(measured(result).solid.direction @ BODY.direction))) < 2.0

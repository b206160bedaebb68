"""The chart of radii: every section is on it, with a radius or without, whatever came of the fit."""

from dataclasses import replace

import numpy as np
import pytest

from app.charts import NO_CHART, RADIUS_SERIES, radius_chart, radius_scales
from rotrecon.circles import SectionCircles, SectionState
from rotrecon.outcome import FailureReason, Fit, FitFailure
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Cut, Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate

ALONG, HIGH, LOW, FITTED, USED, ODD, EXCLUDED, NO_RADIUS, LIT = range(len(RADIUS_SERIES))
MICROMETRE = 1e-3
"""What answers are rounded to, mm."""
REFUSAL = FitFailure(FailureReason.NOT_ROUND, "draw anew")


@pytest.fixture(scope="module", params=["robust", "paper"])
def fitted(request: pytest.FixtureRequest) -> Reconstruction:
    scene = simulate("pipe", 0, noise=None)
    return reconstruct(scene.frame, scene.drawing, Settings(method=request.param))


def without_radii(result: Reconstruction, sections: list[int], points: bool) -> Reconstruction:
    """A refusal, some of whose sections have no radius, and perhaps no points either."""
    cut = result.second_cut
    assert cut is not None
    circles = cut.circles
    state, radius_m, center_m = circles.state.copy(), circles.radius_m.copy(), circles.center_m.copy()
    points_m = circles.points_m.copy()
    state[sections] = SectionState.COLLINEAR if points else SectionState.EMPTY
    radius_m[sections] = np.nan
    center_m[sections] = np.nan
    if not points:
        points_m[sections] = np.nan
    circles = SectionCircles(state, center_m, radius_m, points_m, circles.arc_rad, circles.concave)
    return replace(result, fit=REFUSAL, second_cut=Cut(circles, cut.axis))


def test_a_refusal_shows_the_radii_it_has_and_no_fitted_line(fitted: Reconstruction) -> None:
    with_fit, refused = radius_chart(fitted, 3), radius_chart(replace(fitted, fit=REFUSAL), 3)
    assert isinstance(fitted.fit, Fit)
    assert np.isfinite(with_fit[FITTED]).all()
    assert np.isnan(refused[FITTED]).all()
    assert np.isfinite(refused[USED]).sum() >= np.isfinite(with_fit[USED]).sum() > 0
    assert np.ptp(refused[ALONG] - with_fit[ALONG]) < 3, "they lie where they did, from another origin"
    assert np.isfinite(refused[LIT]).sum() == 1


@pytest.mark.parametrize("points", [True, False])
def test_sections_without_a_radius_stand_at_the_bottom_where_they_belong(fitted: Reconstruction, points: bool) -> None:
    missing = [20, 25, 26]
    whole, chart = (radius_chart(without_radii(fitted, sections, points), 25) for sections in ([], missing))
    marked = np.flatnonzero(np.isfinite(chart[NO_RADIUS]) & np.isnan(whole[NO_RADIUS]))
    assert marked.tolist() == missing
    assert np.allclose(chart[ALONG], whole[ALONG], atol=1)
    assert np.isnan(chart[USED][missing]).all()
    low, high = radius_scales(chart)["y"]["range"]
    assert (chart[NO_RADIUS][missing] < low + 0.1 * (high - low)).all()
    assert (chart[NO_RADIUS][missing] > low).all()
    assert chart[LIT][25] == chart[NO_RADIUS][25]


def test_without_a_single_radius_every_section_is_still_marked(fitted: Reconstruction) -> None:
    count = len(fitted.second_cut.circles.state) if fitted.second_cut else 0
    chart = radius_chart(without_radii(fitted, list(range(count)), points=True), 0)
    assert np.isfinite(chart[NO_RADIUS]).all()
    assert radius_chart(without_radii(fitted, list(range(count)), points=False), 0) is NO_CHART


def test_an_interval_is_drawn_round_the_sections_where_one_is_known(fitted: Reconstruction) -> None:
    chart = radius_chart(fitted, 3)
    if fitted.settings.method == "paper":
        assert np.isnan(chart[HIGH]).all()
    else:
        shown = np.isfinite(chart[USED])
        assert (chart[LOW][shown] <= chart[USED][shown] + MICROMETRE).all()
        assert (chart[USED][shown] <= chart[HIGH][shown] + MICROMETRE).all()


def test_the_ranges_hold_every_section(fitted: Reconstruction) -> None:
    for result in (fitted, replace(fitted, fit=REFUSAL)):
        chart = radius_chart(result, 0)
        low, high = radius_scales(chart)["x"]["range"]
        assert low < chart[ALONG].min() < chart[ALONG].max() < high
        assert high - low < 1.1 * np.ptp(chart[ALONG])


def test_there_is_no_chart_without_a_second_cut(fitted: Reconstruction) -> None:
    assert radius_chart(None, 0) is NO_CHART
    assert radius_chart(replace(fitted, fit=REFUSAL, sections=None, second_cut=None), 0) is NO_CHART

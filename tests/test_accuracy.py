"""How large errors are on a part of the accuracy set, with fixed seeds."""

from dataclasses import replace
from itertools import product

import pytest

from app.bench.accuracy.belief_tables import NOISES
from app.bench.accuracy.clouds import CORRELATED, FULL_MODEL, WHITE, Cell
from app.bench.accuracy.outcome import TRUE_KINDS
from app.bench.accuracy.size_tables import CORRELATED_RMS, bound_of, quantities, rms_of
from app.bench.accuracy.statistics import radius_coverage, refused_share
from app.bench.accuracy.trials import METHOD, Found, Plan, trials

POSES, FULL_POSES = 10, 5
OUTLIERS = WHITE[3]
"""0.25 px, 5 % outliers, 120 degrees."""
WHITE_RATIO = 1.5
"""RMS over its bound: 1.25 is asked of 200 poses, and 10 scatter by a fifth."""
CORRELATED_FACTOR = 1.25
"""On the limits of the issue, for the same reason."""
COVERED = 0.8


@pytest.fixture(scope="module")
def found() -> Found:
    plan = Plan(poses=POSES, draws=1, matched_draws=1, cells=(OUTLIERS, *CORRELATED), compared=False)
    full = replace(plan, poses=FULL_POSES, cells=(FULL_MODEL,), supersampling=1)
    return Found([*trials(plan), *trials(full)])


def cases(*cells: Cell) -> list:
    """Every object in some cells."""
    return list(product(TRUE_KINDS, cells))


@pytest.mark.parametrize(("name", "cell"), cases(OUTLIERS))
def test_white_noise_costs_little_more_than_the_bound(found, name, cell):
    part = found.of(name, cell, METHOD)
    assert refused_share([trial.outcome for trial in part]) == 0
    for quantity in quantities(name):
        assert rms_of(part, quantity) <= WHITE_RATIO * bound_of(part, quantity)


@pytest.mark.parametrize(("name", "cell"), cases(*CORRELATED))
def test_correlated_noise_stays_within_its_limit(found, name, cell):
    part = found.of(name, cell, METHOD)
    assert refused_share([trial.outcome for trial in part]) == 0
    assert rms_of(part, quantities(name)[-1]) <= CORRELATED_FACTOR * CORRELATED_RMS[name]


def test_intervals_hold_the_truth(found):
    pooled = [
        trial.outcome
        for name in TRUE_KINDS
        for noise in NOISES.values()
        for trial in found.of_noise(name, noise, METHOD)
    ]
    assert radius_coverage(pooled).count == sum(not outcome.refused for outcome in pooled)
    assert radius_coverage(pooled).covered >= COVERED


@pytest.mark.parametrize(("name", "cell"), cases(OUTLIERS, *CORRELATED, FULL_MODEL))
def test_no_wrong_kind_is_stated_with_certainty(found, name, cell):
    outcomes = [trial.outcome for trial in found.of(name, cell, METHOD)]
    assert {outcome.kind for outcome in outcomes if outcome.certain} <= {TRUE_KINDS[name]}

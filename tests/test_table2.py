"""The paper's experiment from rendered pictures: some of it each time, and the document that holds all of it."""

import numpy as np
import pytest

from app.bench.accuracy.outcome import TRUE_KINDS, Outcome
from app.bench.table2 import document
from app.bench.table2.document import MOST_RMS, table2_document
from app.bench.table2.trials import PLAIN_OBJECTS, Plan, Trial, trials

SEED = 4000
CHANCE = 2.5
"""Times the root mean square: what a single scene may be off."""


@pytest.mark.parametrize("name", list(TRUE_KINDS))
def test_two_pictures_give_the_size(name: str) -> None:
    plan = Plan(1, SEED, (name,), ("fine",), (2,), ("robust",))
    (trial,) = trials(plan, processes=1)
    outcome = trial.outcome
    off = outcome.half_angle if name == "cone" else outcome.radius
    interval = outcome.half_angle_interval if name == "cone" else outcome.radius_interval
    assert outcome.kind == TRUE_KINDS[name]
    assert 100 * abs(off) < CHANCE * MOST_RMS[name]
    assert interval[0] < off < interval[1]
    assert interval[0] < 0 < interval[1]


def made_up(plan: Plan, _processes: int | None) -> list[Trial]:
    """A tenth of a percent off, half of the plain ones refused."""
    found: list[Trial] = []
    for name in plan.objects:
        for texture in plan.textures:
            for views in plan.view_counts:
                for method in plan.methods:
                    good = Outcome(0.001, 0.001, 0.001, (-0.01, 0.01), (-0.01, 0.01), TRUE_KINDS[name], True)
                    refused = texture == "plain" and name == "leg"
                    outcome = Outcome(reason="untextured") if refused else good
                    found.append(Trial(name, texture, 1, views, method, outcome))
    return found


def test_the_document_stands_the_published_table_beside_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(document, "trials", made_up)
    text = table2_document()
    leg = next(line for line in text.splitlines() if line.startswith("| leg") and "32 (-11 %)" in line)
    assert leg.count("36.0 (+0.1 %)") == 4
    assert any(line.startswith("| leg") and "untextured" in line for line in text.splitlines())
    assert "NOT REACHED" in text, "intervals that always hold the truth are too wide"
    assert all(f"| {name}" in text for name in PLAIN_OBJECTS)


def test_nothing_measured_is_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    refused = Outcome(reason="flat")
    monkeypatch.setattr(
        document, "trials", lambda plan, _: [Trial("leg", "fine", 1, 2, "robust", refused)] * plan.poses
    )
    text = table2_document(Plan(1, objects=("leg",), view_counts=(2,)))
    assert "nan" not in text.lower().replace("not", "")
    assert np.isnan(refused.radius)

"""docs/table2.md: the paper's table 2 beside what two and four rendered pictures give."""

from itertools import product

import numpy as np

from app.bench.accuracy.goals import Goal, goal_table, mark, number, share
from app.bench.accuracy.outcome import TRUE_KINDS, Outcome
from app.bench.accuracy.statistics import (
    Coverage,
    errors,
    half_angle_coverage,
    half_angles,
    radii,
    radius_coverage,
    refused_share,
)
from app.bench.table import NONE, table, wrapped
from app.bench.table2.trials import (
    AROUND_PX,
    BASELINES_M,
    PLAIN,
    PLAIN_OBJECTS,
    PLAIN_POSES,
    TEXTURED,
    Plan,
    Trial,
    chosen,
    trials,
)
from rotrecon.arrays import Floats
from rotrecon.settings import Method
from rotrecon.simulation.flaws import Flaws
from rotrecon.simulation.simulate import DISTANCE_M
from rotrecon.simulation.stereo import VIEWS_CAMERA

PAPER_MM = {"leg": (36, 32, 11), "ball": (216, 192, 11), "wire": (25, 22, 12)}
"""Actual and measured diameter, and error in percent, as printed."""
MOST_RMS = {"wire": 2.0, "leg": 1.0, "ball": 0.5, "pipe": 0.5, "cone": 0.7}
"""Percent, from two views; of a cone its half angle."""
MOST_MEDIAN = 1.0
"""Percent, of the absolute error, from two views."""
FOUR_OVER_TWO = 0.6
MOST_REFUSED = 0.03
COVERED = (0.90, 0.98)
PLAIN_PERCENT = 3.0
"""Off at most, of one-coloured objects, or refused, or not certain."""


def table2_document(plan: Plan | None = None, processes: int | None = None) -> str:
    """The document; a quarter of an hour of work on two cores unless a smaller plan is named."""
    plan = plan or Plan()
    found = trials(plan, processes)
    sizes, goals = _sizes(found, plan)
    plain, plain_goals = _plain(found, plan)
    goals += [*_intervals(found), *plain_goals]
    parts = [_summary(goals), _experiment(found, plan), _introduction(plan), sizes, plain, _refusals(found)]
    return wrapped("\n\n".join(parts)) + "\n"


def _summary(goals: list[Goal]) -> str:
    missed = [goal.what for goal in goals if not goal.met]
    count = f"{len(goals) - len(missed)} of {len(goals)} figures are reached"
    return f"""# The paper's table 2, again

Written by `rotrecon bench --table2 docs/table2.md`; edit `app/bench/table2/`, not this file.
{count}{". Not reached: " + "; ".join(missed) if missed else ""}.

{goal_table(goals)}"""


def _experiment(found: list[Trial], plan: Plan) -> str:
    rows: list[tuple[str, ...]] = []
    for name, (true_mm, paper_mm, paper_percent) in PAPER_MM.items():
        row = [name, f"{true_mm}", f"{paper_mm} ({-paper_percent} %)"]
        for method, views in _columns(plan):
            known = radii(chosen(found, name, TEXTURED, views, method))
            known = known[np.isfinite(known)]
            row.append(_median_mm(true_mm, known))
        rows.append(tuple(row))
    header = (
        "object",
        "actual, mm",
        "as published",
        *(f"`{method}`, {views} views" for method, views in _columns(plan)),
    )
    return f"""## The table

Diameters in mm, with their errors: the published ones, and the medians of {plan.poses} poses with each of
{len(TEXTURED)} textures.

{table(header, rows)}"""


def _columns(plan: Plan) -> list[tuple[Method, int]]:
    return [(method, views) for method in reversed(plan.methods) for views in plan.view_counts]


def _median_mm(true_mm: float, relative: Floats) -> str:
    if len(relative) == 0:
        return NONE
    median = float(np.median(relative))
    return f"{true_mm * (1 + median):.1f} ({100 * median:+.1f} %)"


def _introduction(plan: Plan) -> str:
    camera = VIEWS_CAMERA
    return f"""## How it was measured

- **Pictures**: {camera.width} x {camera.height} px, focal length {camera.focal_px:.0f} px, 16 rays a pixel where
  anything ends or is textured, noise of {Flaws().noise_levels:g} grey levels. Views stand side by side at
  x = {", ".join(f"{x:g}" for x in BASELINES_M)} m; two of them are the first two. Only what lies within
  {AROUND_PX:g} px of the object is rendered.
- **Scenes**: {plan.poses} poses of each object with each texture, seeds {plan.first_seed} to
  {plan.first_seed + plan.poses - 1}, on which nothing was tuned but when a fit or a second measurement is not believed;
  {DISTANCE_M[0]} to {DISTANCE_M[1]} m away, in front of a wall. Textures are fine, coarse and weak;
  {min(PLAIN_POSES, plan.poses)} poses are plain: one colour, only shading and an edge.
- **The whole path**: the pictures and the poses are all that is given. The area is drawn with every corner and both
  ends of the stroke moved by 3 px at random, the kind is not told. Every method measures the same matched depth;
  `robust` then goes back to the pictures.
- **Errors** are percent of the true diameter in the middle; of a cone, of its half angle."""


def _values(name: str, outcomes: list[Outcome]) -> tuple[Floats, Coverage]:
    if name == "cone":
        return half_angles(outcomes), half_angle_coverage(outcomes)
    return radii(outcomes), radius_coverage(outcomes)


def _sizes(found: list[Trial], plan: Plan) -> tuple[str, list[Goal]]:
    rows: list[tuple[str, ...]] = []
    goals: list[Goal] = []
    for name, method, views in product(plan.objects, plan.methods, plan.view_counts):
        outcomes = chosen(found, name, TEXTURED, views, method)
        values, covered = _values(name, outcomes)
        size, median = (
            errors(values),
            100 * float(np.nanmedian(np.abs(values))) if np.isfinite(values).any() else np.nan,
        )
        right = sum(outcome.kind == TRUE_KINDS[name] for outcome in outcomes) / max(len(outcomes), 1)
        met = ""
        if method == "robust":
            factor = 1.0 if views == 2 else FOUR_OVER_TWO
            most, middle = factor * MOST_RMS[name], factor * MOST_MEDIAN
            met = mark(size.rms <= most and median <= middle)
            goals.append(Goal(f"{name}, {views} views, RMS", number(size.rms), f"{most:g} %", size.rms <= most))
            goals.append(Goal(f"{name}, {views} views, median", number(median), f"{middle:g} %", median <= middle))
        rows.append(
            (
                *(name, method, f"{views}", f"{len(outcomes)}", number(size.bias, sign=True), number(median)),
                *(number(size.rms), share(covered.covered), number(covered.half_width)),
                *(share(refused_share(outcomes)), share(right), met),
            )
        )
    header = (
        *("object", "method", "views", "n", "bias", "median", "RMS", "covered", "half width", "refused", "kind"),
        "reached",
    )
    return f"## Sizes\n\n{table(header, rows)}", goals


def _intervals(found: list[Trial]) -> list[Goal]:
    """Coverage and refusals, pooled over all textured objects."""
    goals: list[Goal] = []
    every = [trial.outcome for trial in found if trial.method == "robust" and trial.texture in TEXTURED]
    covered = radius_coverage(every)
    low, high = COVERED
    honest = low <= covered.covered <= high
    what = f"diameters' intervals, {covered.count} pooled"
    goals.append(Goal(what, share(covered.covered), f"{100 * low:.0f} to {100 * high:.0f} %", honest))
    refused = refused_share(every)
    goals.append(Goal("refused, textured", share(refused), f"{100 * MOST_REFUSED:.0f} %", refused <= MOST_REFUSED))
    return goals


def _plain(found: list[Trial], plan: Plan) -> tuple[str, list[Goal]]:
    rows: list[tuple[str, ...]] = []
    wrong = 0
    for name, views in product([name for name in PLAIN_OBJECTS if name in plan.objects], plan.view_counts):
        outcomes = chosen(found, name, PLAIN, views, "robust")
        values, covered = _values(name, outcomes)
        off = int((np.abs(values) > PLAIN_PERCENT / 100).sum())
        certain = sum(outcome.certain and abs(outcome.radius) > PLAIN_PERCENT / 100 for outcome in outcomes)
        wrong += certain
        cells = (number(errors(values).rms), share(covered.covered), share(refused_share(outcomes)))
        rows.append((name, f"{views}", f"{len(outcomes)}", *cells, f"{off}", f"{certain}"))
    header = ("object", "views", "n", "RMS", "covered", "refused", f"> {PLAIN_PERCENT:g} % off", "of these certain")
    text = f"""## One-coloured objects

There is nothing to match on them but an edge and shading; the outline alone has to tell their size.

{table(header, rows)}"""
    return text, [Goal("one-coloured, wrong and certain", f"{wrong}", "0", wrong == 0)]


def _refusals(found: list[Trial]) -> str:
    refused = [trial for trial in found if trial.outcome.refused and trial.method == "robust"]
    rows = [
        (trial.object_name, trial.texture, f"{trial.seed}", f"{trial.views}", trial.outcome.reason) for trial in refused
    ]
    if not rows:
        return "## Refusals\n\nNone by `robust`."
    return f"## Refusals\n\nBy `robust`:\n\n{table(('object', 'texture', 'seed', 'views', 'reason'), rows)}"

"""The tables of what the program says of its own answers: intervals, kinds, and how a bad drawing moves them."""

from collections.abc import Sequence

import numpy as np

from app.bench.accuracy.clouds import NoiseKind
from app.bench.accuracy.goals import Goal, mark, number, share
from app.bench.accuracy.misdrawn import CELLS, MISTAKES, Movement
from app.bench.accuracy.outcome import TRUE_KINDS, Outcome
from app.bench.accuracy.statistics import Coverage, half_angle_coverage, radius_coverage, refused_share
from app.bench.accuracy.trials import Found, Plan
from app.bench.table import table

COVERED = (0.90, 0.98)
REFUSED = 0.02
WIDE = 1.5
CERTAIN = 0.9
NOISES: dict[str, tuple[NoiseKind, ...]] = {
    "white": ("white",),
    "correlated": ("length", "box"),
    "matched": ("matched",),
}
"""Kinds of noise that are pooled."""


def coverage_table(found: Found, plan: Plan) -> tuple[str, list[Goal]]:
    """How often intervals hold the truth, pooled per object and kind of noise."""
    rows: list[tuple[str, ...]] = []
    goals: list[Goal] = []
    for noise, kinds in NOISES.items():
        met: list[str] = []
        for name in plan.objects:
            outcomes = [trial.outcome for trial in found.of_noise(name, kinds, plan.method)]
            pooled = [("diameter", radius_coverage(outcomes))]
            if name == "cone":
                pooled.append(("half angle", half_angle_coverage(outcomes)))
            for label, values in pooled:
                row, good = _coverage_row(values, refused_share(outcomes))
                rows.append((noise, name, label, *row))
                met += [] if good else [f"{name} ({label})"]
        what = f"intervals, {noise} noise: coverage, refusals and width"
        asked = f"{100 * COVERED[0]:.0f} to {100 * COVERED[1]:.0f} %, <= {100 * REFUSED:.0f} %, <= {WIDE}"
        goals.append(Goal(what, f"missed by {', '.join(met)}" if met else "by all objects", asked, not met))
    header = ("noise", "object", "of", "n", "covered", "refused", "half width", "95 % of errors", "ratio", "reached")
    return table(header, rows), goals


def recognition_table(found: Found, plan: Plan) -> tuple[str, list[Goal]]:
    """What kinds were stated, and how many of those that were certain are wrong."""
    rows: list[tuple[str, ...]] = []
    totals: dict[str, list[Outcome]] = {noise: [] for noise in NOISES}
    wrong = dict.fromkeys(NOISES, 0)
    sure = dict.fromkeys(NOISES, 0)
    for noise, kinds in NOISES.items():
        for name in plan.objects:
            outcomes = [trial.outcome for trial in found.of_noise(name, kinds, plan.method)]
            certain = [outcome for outcome in outcomes if outcome.certain]
            right = sum(outcome.kind == TRUE_KINDS[name] for outcome in outcomes) / len(outcomes)
            mistaken = [outcome.kind or "none" for outcome in certain if outcome.kind != TRUE_KINDS[name]]
            others = ", ".join(f"{mistaken.count(kind)} {kind}" for kind in dict.fromkeys(mistaken)) or "0"
            rows.append((noise, name, f"{len(outcomes)}", share(right), share(len(certain) / len(outcomes)), others))
            totals[noise] += outcomes
            wrong[noise] += len(mistaken)
            sure[noise] += len(certain)
    goals = [
        Goal(
            f"wrong kind with `certain`, {noise} noise",
            f"{wrong[noise]} of {len(totals[noise])}",
            "0",
            not wrong[noise],
        )
        for noise in NOISES
    ]
    count = len(totals["matched"])
    found_share = sure["matched"] / count
    asked = f">= {100 * CERTAIN:.0f} %"
    goals.append(Goal("certain answers, full model", f"{share(found_share)} of {count}", asked, found_share >= CERTAIN))
    header = ("noise", "object", "n", "right kind", "certain", "certain and wrong")
    return table(header, rows), goals


def misdrawn_table(found: Sequence[Movement]) -> tuple[str, list[Goal]]:
    """How far careless drawings move the diameter, in half widths of its interval."""
    rows: list[tuple[str, ...]] = []
    goals: list[Goal] = []
    for cell in CELLS:
        within = 0
        here = [movement for movement in found if movement.cell == cell]
        for name in dict.fromkeys(movement.object_name for movement in here):
            for mistake in MISTAKES:
                part = [m for m in here if (m.object_name, m.mistake) == (name, mistake)]
                rows.append((cell.noise, name, mistake, *_movement_row(part)))
                within += sum(movement.moved < 1 for movement in part)
        what = f"bad drawings, {cell.noise} noise: moved by less than the half width"
        goals.append(Goal(what, f"{within} of {len(here)}", "all", within == len(here)))
    header = ("noise", "object", "drawing", "n", "moved less", "median, half widths", "most", "most, %", "refused")
    return table(header, rows), goals


def _coverage_row(values: Coverage, refused: float) -> tuple[tuple[str, ...], bool]:
    good = COVERED[0] <= values.covered <= COVERED[1] and refused <= REFUSED and values.wide <= WIDE
    widths = (number(values.half_width), number(values.percentile_95), number(values.wide))
    return (f"{values.count}", share(values.covered), share(refused), *widths, mark(good)), good


def _movement_row(part: Sequence[Movement]) -> tuple[str, ...]:
    moved = np.array([movement.moved for movement in part])
    percent = 100 * np.array([movement.moved_percent for movement in part])
    known = np.isfinite(percent)
    if not known.any():
        return f"{len(part)}", share(0.0), number(np.nan), number(np.nan), number(np.nan), share(1.0)
    halves = number(float(np.median(moved[known]))), number(float(moved[known].max()))
    within = share(float(np.mean(moved < 1)))
    return f"{len(part)}", within, *halves, number(float(percent[known].max())), share(float(np.mean(~known)))

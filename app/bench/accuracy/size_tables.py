"""The tables of errors: white noise cell by cell, correlated noise, the simulator's full model, and the peers."""

from collections.abc import Callable, Sequence

import numpy as np

from app.bench.accuracy.clouds import CORRELATED, FULL_MODEL, WHITE
from app.bench.accuracy.goals import Goal, mark, number, share
from app.bench.accuracy.outcome import Outcome
from app.bench.accuracy.peers import PEERS
from app.bench.accuracy.statistics import errors, far_off_count, half_angles, radii, refused_share, rms_percent
from app.bench.accuracy.trials import LEAST_SQUARES, PEER_CELLS, Found, Plan, Trial
from app.bench.table import table
from rotrecon.arrays import Floats

BOUND_RATIO = 1.25
CORRELATED_RMS = {"wire": 0.9, "leg": 0.7, "pipe": 0.3, "ball": 0.3, "cone": 0.6}
"""Percent; of the cone's half angle."""
FAR_SIGMAS = 4.0
"""A size that is so many times its bound off, or less, is the data's fault."""

Quantity = tuple[str, Callable[[Sequence[Outcome]], Floats], Callable[[Trial], float]]
"""Its name in the tables, its errors, and its bound."""
RADIUS: Quantity = ("diameter", radii, lambda trial: trial.bound.radius)
HALF_ANGLE: Quantity = ("half angle", half_angles, lambda trial: trial.bound.half_angle)


def quantities(object_name: str) -> tuple[Quantity, ...]:
    """What is measured of an object."""
    return (RADIUS, HALF_ANGLE) if object_name == "cone" else (RADIUS,)


def rms_of(part: Sequence[Trial], quantity: Quantity) -> float:
    """Percent; NaN where nothing was measured."""
    return errors(quantity[1]([trial.outcome for trial in part])).rms


def bound_of(part: Sequence[Trial], quantity: Quantity) -> float:
    """Percent."""
    return rms_percent([quantity[2](trial) for trial in part])


def white_tables(found: Found, plan: Plan) -> tuple[str, list[Goal]]:
    """One table an object, and whether every cell is within its limit."""
    blocks: list[str] = []
    ratios: dict[str, list[float]] = {name: [] for name in plan.objects}
    header = ("cell", "of", "bound", "RMS", "RMS / bound", f"<= {BOUND_RATIO}", "bias", "refused", "> 10 % off")
    for name in plan.objects:
        rows: list[tuple[str, ...]] = []
        for cell, quantity in ((cell, quantity) for cell in WHITE for quantity in quantities(name)):
            part = found.of(name, cell, plan.method)
            row, ratio = _bounded_row(part, quantity)
            others = [rms_of(found.of(name, cell, other), quantity) for other in ("paper", LEAST_SQUARES)]
            rows.append((cell.name, *row, *map(number, others)))
            ratios[name].append(ratio)
        blocks.append(f"### {name.capitalize()}\n\n{table((*header, 'paper, RMS', 'least squares, RMS'), rows)}")
    goals = [_white_goal(name, values) for name, values in ratios.items()]
    return "\n\n".join(blocks), [
        *goals,
        _failure_goal([trial for name in plan.objects for trial in found.of_noise(name, ("white",), plan.method)]),
    ]


def correlated_table(found: Found, plan: Plan) -> tuple[str, list[Goal]]:
    """Both readings of a kernel of 4 px beside their limits and beside the others on the same clouds."""
    rows: list[tuple[str, ...]] = []
    goals: list[Goal] = []
    for name, cell in ((name, cell) for name in plan.objects for cell in CORRELATED):
        for quantity in quantities(name):
            part = found.of(name, cell, plan.method)
            rms = rms_of(part, quantity)
            first = [trial for trial in part if trial.draw == 0]
            same_clouds = rms_of(first, quantity)
            others = [rms_of(found.of(name, cell, other), quantity) for other in ("paper", LEAST_SQUARES)]
            below = all(not np.isfinite(other) or same_clouds < other for other in others)
            row = [name, cell.noise, quantity[0], number(bound_of(part, quantity)), number(rms)]
            bias = number(errors(quantity[1]([trial.outcome for trial in part])).bias, sign=True)
            target = quantity is quantities(name)[-1]
            limit = number(CORRELATED_RMS[name]) if target else ""
            met = not target or rms <= CORRELATED_RMS[name]
            rows.append((*row, limit, mark(met) if target else "", bias, *map(number, others), mark(below)))
            if target:
                what = f"correlated ({cell.noise}), {name}, RMS of the {quantity[0]}"
                asked = f"<= {CORRELATED_RMS[name]} %, and below paper and least squares"
                goals.append(Goal(what, f"{number(rms)} %", asked, met and below))
    header = ("object", "noise", "of", "white bound", "RMS", "asked", "reached", "bias")
    return table((*header, "paper, RMS", "least squares, RMS", "below both"), rows), goals


def full_model_table(found: Found, plan: Plan) -> str:
    """Errors under the simulator's whole model, beside the paper's method and least squares."""
    rows: list[tuple[str, ...]] = []
    for name in plan.objects:
        for method in dict.fromkeys((plan.method, "paper", LEAST_SQUARES)):
            part = found.of(name, FULL_MODEL, method)
            if not part:
                continue
            outcomes = [trial.outcome for trial in part]
            for label, values, _ in quantities(name):
                size = errors(values(outcomes))
                far = f"{far_off_count(outcomes)}" if label == "diameter" else ""
                refused = share(refused_share(outcomes))
                rows.append((name, label, method, f"{len(part)}", *_bias_rms(size.bias, size.rms), refused, far))
    return table(("object", "of", "method", "n", "bias", "RMS", "refused", "> 10 % off"), rows)


def peer_table(found: Found, plan: Plan) -> str:
    """Bias and RMS of every method on the clouds that all of them were given."""
    methods = list(dict.fromkeys((plan.method, "paper", LEAST_SQUARES, *PEERS)))
    rows: list[tuple[str, ...]] = []
    for name, cell in ((name, cell) for name in plan.objects for cell in PEER_CELLS):
        for quantity in quantities(name):
            row = [f"{name}, {quantity[0]}", cell.name]
            for method in methods:
                part = [t for t in found.of(name, cell, method) if t.seed < plan.peer_poses and t.draw == 0]
                size = errors(quantity[1]([trial.outcome for trial in part]))
                row.append(" / ".join(_bias_rms(size.bias, size.rms)) if np.isfinite(size.rms) else "-")
            rows.append(tuple(row))
    return table(("object", "cell", *methods), rows)


def _bounded_row(part: Sequence[Trial], quantity: Quantity) -> tuple[tuple[str, ...], float]:
    outcomes = [trial.outcome for trial in part]
    size, bound = errors(quantity[1](outcomes)), bound_of(part, quantity)
    ratio = size.rms / bound
    figures = (number(bound), number(size.rms), number(ratio), mark(ratio <= BOUND_RATIO), number(size.bias, sign=True))
    return (quantity[0], *figures, share(refused_share(outcomes)), f"{far_off_count(outcomes)}"), ratio


def _white_goal(name: str, ratios: list[float]) -> Goal:
    within = sum(ratio <= BOUND_RATIO for ratio in ratios)
    worst = max(ratios, key=lambda ratio: np.inf if np.isnan(ratio) else ratio)
    found = f"{within} of {len(ratios)} rows; worst {number(worst)}"
    asked = f"<= {BOUND_RATIO} in every one"
    return Goal(f"white noise, {name}, RMS over its bound", found, asked, within == len(ratios))


def _failure_goal(part: Sequence[Trial]) -> Goal:
    refused = sum(trial.outcome.refused for trial in part)
    far = [t for t in part if abs(t.outcome.radius) > 0.1]
    noise = sum(abs(t.outcome.radius) <= FAR_SIGMAS * t.bound.radius for t in far)
    found = f"{refused} and {len(far)} of {len(part)}"
    if noise:
        found += f"; {noise} of the latter within {FAR_SIGMAS:.0f} times their bound"
    return Goal("white noise, refused and more than 10 % off", found, "none", refused + len(far) == 0)


def _bias_rms(bias: float, rms: float) -> tuple[str, str]:
    return number(bias, sign=True), number(rms)

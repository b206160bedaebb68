"""The error of the program on a few simulated clouds at once, while it is being worked on.

python -m app.bench.accuracy --poses 20 --object leg --cell "white 0.25" --method robust --worst
"""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
import typer

from app.bench.accuracy.outcome import TRUE_KINDS
from app.bench.accuracy.statistics import (
    Coverage,
    errors,
    far_off_count,
    half_angle_coverage,
    half_angles,
    radii,
    radius_coverage,
    refused_share,
    rms_percent,
)
from app.bench.accuracy.trials import METHOD, Plan, Trial, trials
from app.bench.table import table
from rotrecon.arrays import Floats
from rotrecon.settings import Settings

COLUMNS = (
    *("cell", "bias %", "RMS %", "bound %", "RMS/bound", "refused", "> 10 %"),
    *("right kind", "certain", "certain, wrong", "covered", "half width %", "over p95", "ms"),
)


def main(
    poses: Annotated[int, typer.Option(help="Of each object.")] = 20,
    object_: Annotated[str, typer.Option("--object", help="One of the simulated objects; all if left out.")] = "",
    cell: Annotated[str, typer.Option(help="Part of a cell's name, such as `white 0.25`, `box` or `matched`.")] = "",
    method: Annotated[str, typer.Option(help="paper or robust.")] = METHOD,
    seed: Annotated[int, typer.Option(help="Of the first pose.")] = 0,
    processes: Annotated[int, typer.Option(help="That share the work.")] = 1,
    worst: Annotated[bool, typer.Option(help="Name each cell's worst seeds, and why others were refused.")] = False,
) -> None:
    """Print bias, RMS, bound and coverage of every cell."""
    plan = Plan(
        Settings(method=method).method,  # type: ignore[arg-type]
        poses,
        seed,
        draws=1,
        matched_draws=1,
        cells=tuple(c for c in Plan().cells if cell in c.name),
        objects=(object_,) if object_ else tuple(TRUE_KINDS),
        compared=False,
        supersampling=1,
    )
    found = trials(plan, processes)
    for name in plan.objects:
        rows: list[tuple[str, ...]] = []
        lines: list[str] = []
        for each in plan.cells:
            part = [trial for trial in found if trial.object_name == name and trial.cell == each]
            rows += _rows(part)
            lines.append(f"{each.name}: {_worst(part)}")
        typer.echo(f"\n{name}\n{table(COLUMNS, rows)}")
        if worst:
            typer.echo("\n".join(lines))


def _rows(part: Sequence[Trial]) -> list[tuple[str, ...]]:
    """One row of a cell, and one more for a cone's half angle."""
    outcomes, kind = [trial.outcome for trial in part], TRUE_KINDS[part[0].object_name]
    bound = rms_percent([trial.bound.radius for trial in part])
    certain = [outcome.kind for outcome in outcomes if outcome.certain]
    middle = (
        f"{100 * refused_share(outcomes):.0f} %",
        f"{far_off_count(outcomes)}",
        f"{100 * np.mean([outcome.kind == kind for outcome in outcomes]):.0f} %",
        f"{100 * len(certain) / len(outcomes):.0f} %",
        f"{sum(other != kind for other in certain)}",
    )
    ms = f"{np.median([trial.milliseconds for trial in part]):.0f}"
    first = (part[0].cell.name, *_size(radii(outcomes), bound), *middle, *_sure(radius_coverage(outcomes)), ms)
    if kind != "cone":
        return [first]
    bound = rms_percent([trial.bound.half_angle for trial in part])
    nothing = ("",) * len(middle)
    angle = ("  half angle", *_size(half_angles(outcomes), bound), *nothing, *_sure(half_angle_coverage(outcomes)), "")
    return [first, angle]


def _size(values: Floats, bound: float) -> tuple[str, ...]:
    found = errors(values)
    return f"{found.bias:+.3f}", f"{found.rms:.3f}", f"{bound:.3f}", f"{found.rms / bound:.2f}"


def _sure(found: Coverage) -> tuple[str, ...]:
    return f"{100 * found.covered:.0f} %", f"{found.half_width:.3f}", f"{found.wide:.2f}"


def _worst(part: Sequence[Trial]) -> str:
    """The seeds of the largest errors over their bound, and of every refusal."""
    measured = [trial for trial in part if not trial.outcome.refused]
    measured.sort(key=lambda trial: abs(trial.outcome.radius) / trial.bound.radius, reverse=True)
    far = [f"{trial.seed} ({100 * trial.outcome.radius:+.2f} %, {trial.outcome.kind})" for trial in measured[:3]]
    refused = [f"{trial.seed} ({trial.outcome.reason})" for trial in part if trial.outcome.refused]
    return f"worst seeds {', '.join(far) or 'none'}; refused {', '.join(refused) or 'none'}"


if __name__ == "__main__":
    typer.run(main)

"""The error of the program on a few simulated clouds at once, while it is being worked on.

python -m app.bench.accuracy --poses 20 --object leg --cell white --method robust
"""

import time
from typing import Annotated

import typer

from app.bench.accuracy.bound import Bound, cramer_rao, derivatives
from app.bench.accuracy.clouds import CORRELATED, FULL_MODEL, WHITE, Cell, cloud_of, pose_of
from app.bench.accuracy.outcome import TRUE_KINDS, Outcome, by_program
from app.bench.accuracy.statistics import (
    errors,
    far_off_count,
    half_angle_coverage,
    half_angles,
    radii,
    radius_coverage,
    refused_share,
    rms_percent,
)
from app.bench.table import table
from rotrecon.settings import Method, Settings

CELLS = (*WHITE, *CORRELATED, FULL_MODEL)
COLUMNS = (
    *("cell", "bias %", "RMS %", "bound %", "RMS/bound", "refused", "> 10 %"),
    *("right kind", "certain", "certain and wrong", "covered", "half width %", "over p95", "ms"),
)


def main(
    poses: Annotated[int, typer.Option(help="Of each object.")] = 20,
    object_: Annotated[str, typer.Option("--object", help="One of the simulated objects; all if left out.")] = "",
    cell: Annotated[str, typer.Option(help="Part of a cell's name, such as `white 0.25` or `box`.")] = "",
    method: Annotated[str, typer.Option(help="paper or robust.")] = Settings().method,
    seed: Annotated[int, typer.Option(help="Of the first pose.")] = 0,
    worst: Annotated[bool, typer.Option(help="Name each cell's worst seed, and why it was refused.")] = False,
) -> None:
    """Print bias, RMS, bound and coverage of every cell."""
    settings = Settings(method=method)  # type: ignore[arg-type]
    cells = [c for c in CELLS if cell in c.name]
    for name in [object_] if object_ else TRUE_KINDS:
        typer.echo(f"\n{name}\n" + _measured(name, range(seed, seed + poses), cells, settings.method, worst))


def _measured(name: str, seeds: range, cells: list[Cell], method: Method, worst: bool) -> str:
    found: dict[Cell, list[tuple[Outcome, Bound, float]]] = {cell: [] for cell in cells}
    for seed in seeds:
        depth_only = pose_of(name, seed)
        known = derivatives(depth_only)
        for cell in cells:
            pose = pose_of(name, seed, supersampling=1) if cell == FULL_MODEL else depth_only
            cloud = cloud_of(pose, cell)
            begun = time.perf_counter()
            outcome = by_program(cloud, method)
            milliseconds = 1000 * (time.perf_counter() - begun)
            found[cell].append((outcome, cramer_rao(cloud, known), milliseconds))
    rows: list[tuple[str, ...]] = []
    for cell in cells:
        outcomes, bounds, times = zip(*found[cell], strict=True)
        rows += _rows(name, cell.name, list(outcomes), list(bounds), sum(times) / len(times))
    text = table(COLUMNS, rows)
    if worst:
        lines = [_worst(cell.name, seeds, [outcome for outcome, _, _ in found[cell]]) for cell in cells]
        text += "\n" + "\n".join(lines)
    return text


def _rows(name: str, cell: str, outcomes: list[Outcome], bounds: list[Bound], ms: float) -> list[tuple[str, ...]]:
    right = sum(outcome.kind == TRUE_KINDS[name] for outcome in outcomes) / len(outcomes)
    certain = sum(outcome.certain for outcome in outcomes) / len(outcomes)
    wrong = sum(outcome.certain and outcome.kind != TRUE_KINDS[name] for outcome in outcomes)
    figures = (f"{100 * refused_share(outcomes):.0f} %", f"{far_off_count(outcomes)}")
    kinds = (f"{100 * right:.0f} %", f"{100 * certain:.0f} %", f"{wrong}")

    def row(label: str, values: object, bound: float, covered: object) -> tuple[str, ...]:
        e, c = errors(values), covered  # type: ignore[arg-type]
        size = (f"{e.bias:+.2f}", f"{e.rms:.2f}", f"{bound:.2f}", f"{e.rms / bound:.2f}")
        sure = (f"{100 * c.covered:.0f} %", f"{c.half_width:.2f}", f"{c.wide:.2f}")  # type: ignore[attr-defined]
        return (label, *size, *figures, *kinds, *sure, f"{ms:.0f}")

    rows = [row(cell, radii(outcomes), rms_percent([b.radius for b in bounds]), radius_coverage(outcomes))]
    if name == "cone":
        bound = rms_percent([b.half_angle for b in bounds])
        rows.append(row("  half angle", half_angles(outcomes), bound, half_angle_coverage(outcomes)))
    return rows


def _worst(cell: str, seeds: range, outcomes: list[Outcome]) -> str:
    """The seed of the largest error, and of every refusal."""
    judged = [(abs(o.radius), seed) for o, seed in zip(outcomes, seeds, strict=True) if not o.refused]
    refused = [f"{seed} ({o.reason})" for o, seed in zip(outcomes, seeds, strict=True) if o.refused]
    text = f"{cell}: refused {', '.join(refused) or 'none'}"
    return text + (f"; worst {100 * max(judged)[0]:.1f} % at seed {max(judged)[1]}" if judged else "")


if __name__ == "__main__":
    typer.run(main)

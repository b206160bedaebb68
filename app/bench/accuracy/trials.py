"""Every method on every cloud: who measures what, and how two processes share the work."""

import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import product
from multiprocessing import get_context
from typing import TypeVar

import cv2

from app.bench.accuracy.bound import Bound, cramer_rao, derivatives
from app.bench.accuracy.clouds import CORRELATED, FULL_MODEL, WHITE, Cell, Cloud, NoiseKind, cloud_of, pose_of
from app.bench.accuracy.outcome import TRUE_KINDS, Outcome, by_program
from app.bench.accuracy.peers import PEERS, orthogonal_least_squares
from rotrecon.settings import Method

POSES = 200
"""Of each object."""
DRAWS = 2
"""Noises and drawings of each pose where noise is correlated: intervals of 800 clouds of every object."""
MATCHED_DRAWS = 3
"""The same of the full model: of 600."""
METHOD: Method = "robust"
"""The one whose accuracy is asked for."""
PEER_POSES = 10
"""The packages of others take up to 3 s a cloud."""
PEER_CELLS = (WHITE[0], WHITE[4], CORRELATED[0])
SUPERSAMPLING = 2
"""Of the pictures of the full model: what outlines are sought in must not be jagged."""
LEAST_SQUARES = "orthogonal least squares"


@dataclass(frozen=True)
class Trial:
    """What one method made of one cloud."""

    object_name: str
    cell: Cell
    method: str
    seed: int
    draw: int
    outcome: Outcome
    bound: Bound
    milliseconds: float


class Found:
    """All trials, found by object, cell and method."""

    def __init__(self, trials: Sequence[Trial]) -> None:
        self._trials: dict[tuple[str, Cell, str], list[Trial]] = {}
        for trial in trials:
            self._trials.setdefault((trial.object_name, trial.cell, trial.method), []).append(trial)

    def of(self, object_name: str, cell: Cell, method: str) -> list[Trial]:
        """Those of one object in one cell by one method."""
        return self._trials.get((object_name, cell, method), [])

    def of_noise(self, object_name: str, noises: tuple[NoiseKind, ...], method: str) -> list[Trial]:
        """Those of one object with some kinds of noise by one method."""
        wanted = (object_name, method)
        parts = [
            part for (name, cell, by), part in self._trials.items() if (name, by) == wanted and cell.noise in noises
        ]
        return [trial for part in parts for trial in part]


@dataclass(frozen=True)
class Plan:
    """How much is measured."""

    method: Method = METHOD
    """The paper's and the others stand beside it."""
    poses: int = POSES
    first_seed: int = 0
    draws: int = DRAWS
    matched_draws: int = MATCHED_DRAWS
    peer_poses: int = PEER_POSES
    cells: tuple[Cell, ...] = (*WHITE, *CORRELATED, FULL_MODEL)
    objects: tuple[str, ...] = tuple(TRUE_KINDS)
    compared: bool = True
    """Whether others are measured at all."""
    supersampling: int = SUPERSAMPLING

    def draws_of(self, cell: Cell) -> int:
        """How often a pose is measured in a cell."""
        by_noise = {"white": 1, "length": self.draws, "box": self.draws, "matched": self.matched_draws}
        return by_noise[cell.noise]

    def others(self, cell: Cell, seed: int) -> dict[str, Callable[[Cloud], Outcome | None]]:
        """The methods that stand beside the one that is asked for, on a pose's first cloud."""
        if not self.compared:
            return {}
        found: dict[str, Callable[[Cloud], Outcome | None]] = {"paper": partial(by_program, method="paper")}
        if cell.outlier_share == 0:
            found[LEAST_SQUARES] = orthogonal_least_squares
        if cell in PEER_CELLS and seed < self.peer_poses:
            found |= PEERS
        return found


def trials(plan: Plan, processes: int | None = None) -> list[Trial]:
    """All trials of a plan, the same whatever the number of processes; None takes one of every core."""
    tasks = list(product(plan.objects, range(plan.first_seed, plan.first_seed + plan.poses)))
    work = partial(_pose_trials, plan)
    return [trial for found in in_processes(work, tasks, processes) for trial in found]


Task = TypeVar("Task")
Result = TypeVar("Result")


def in_processes(work: Callable[[Task], Result], tasks: Sequence[Task], processes: int | None = None) -> list[Result]:
    """Results in the order of the tasks, each process on one thread."""
    count = processes or os.cpu_count() or 1
    if count == 1:
        return [work(task) for task in tasks]
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    context = get_context("spawn")
    with ProcessPoolExecutor(count, mp_context=context, initializer=cv2.setNumThreads, initargs=(1,)) as pool:
        return list(pool.map(work, tasks))


def _pose_trials(plan: Plan, task: tuple[str, int]) -> list[Trial]:
    """All cells of one pose."""
    name, seed = task
    pose = pose_of(name, seed, plan.supersampling if FULL_MODEL in plan.cells else 0)
    known, found = derivatives(pose), list[Trial]()
    for cell in plan.cells:
        for draw in range(plan.draws_of(cell)):
            cloud = cloud_of(pose, cell, draw)
            bound = cramer_rao(cloud, known)
            methods = {plan.method: partial(by_program, method=plan.method)}
            if draw == 0:
                methods |= plan.others(cell, seed)
            for method, measure in methods.items():
                begun = time.perf_counter()
                outcome = _outlasting(measure, cloud)
                milliseconds = 1000 * (time.perf_counter() - begun)
                if outcome is not None:
                    found.append(Trial(name, cell, method, seed, draw, outcome, bound, milliseconds))
    return found


def _outlasting(measure: Callable[[Cloud], Outcome | None], cloud: Cloud) -> Outcome | None:
    """What was measured; one that breaks off has refused, and the other clouds are measured all the same."""
    try:
        return measure(cloud)
    except Exception as error:
        return Outcome(reason=f"{type(error).__name__}: {error}")

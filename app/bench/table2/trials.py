"""What two and four pictures of an object say of its size, by both methods, all the way from the pictures."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np

from app.bench.accuracy.outcome import TRUE_KINDS, Outcome, judged
from app.bench.accuracy.trials import in_processes
from rotrecon.capture import Capture
from rotrecon.frame import FrameUnavailable
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Method, Settings
from rotrecon.simulation.ideal_drawing import perturb
from rotrecon.simulation.stereo import simulate_views
from rotrecon.simulation.surfaces import Texture

POSES, FIRST_SEED = 20, 5000
"""Of each object with each texture; seeds that hardly anything was tuned on."""
BASELINES_M = (0.0, 0.1, 0.2, 0.3)
VIEW_COUNTS = (2, 4)
TEXTURED: tuple[Texture, ...] = ("fine", "coarse", "weak")
PLAIN: tuple[Texture, ...] = ("plain",)
PLAIN_OBJECTS = ("wire", "leg", "pipe")
PLAIN_POSES = 10
AROUND_PX = 160.0
"""What is rendered round the object: farther than anything that is matched for its area."""


@dataclass(frozen=True)
class Trial:
    """One object before so many cameras, and what a method made of it."""

    object_name: str
    texture: Texture
    seed: int
    views: int
    method: Method
    outcome: Outcome


@dataclass(frozen=True)
class Plan:
    """How much is measured."""

    poses: int = POSES
    first_seed: int = FIRST_SEED
    objects: tuple[str, ...] = tuple(TRUE_KINDS)
    textures: tuple[Texture, ...] = (*TEXTURED, *PLAIN)
    view_counts: tuple[int, ...] = VIEW_COUNTS
    methods: tuple[Method, ...] = ("robust", "paper")


def trials(plan: Plan, processes: int | None = None) -> list[Trial]:
    """All trials of a plan, the same whatever the number of processes; None takes one of every core."""
    seeds = range(plan.first_seed, plan.first_seed + plan.poses)
    tasks = [task for task in product(plan.objects, plan.textures, seeds) if _is_asked(task, plan)]
    return [trial for found in in_processes(partial(_of_scene, plan), tasks, processes) for trial in found]


def _is_asked(task: tuple[str, Texture, int], plan: Plan) -> bool:
    """One-coloured objects are fewer: nobody expects much of them."""
    name, texture, seed = task
    return texture not in PLAIN or (name in PLAIN_OBJECTS and seed < plan.first_seed + PLAIN_POSES)


def _of_scene(plan: Plan, task: tuple[str, Texture, int]) -> list[Trial]:
    """Every number of views and every method on one scene, drawn once by an unsteady hand."""
    name, texture, seed = task
    baselines_m = BASELINES_M[: max(plan.view_counts)]
    scene = simulate_views(name, seed, baselines_m=baselines_m, texture=texture, around_px=AROUND_PX)
    drawing = perturb(scene.drawing, np.random.default_rng([seed, *name.encode()]))
    found: list[Trial] = []
    for count in plan.view_counts:
        frame = Capture(name, views=scene.views[:count]).frame(drawing.area)
        for method in plan.methods:
            if isinstance(frame, FrameUnavailable):
                outcome = Outcome(reason=frame.reason)
            else:
                result = reconstruct(frame, drawing, Settings(method=method))
                outcome = judged(result, scene.solid_in_camera, scene.solid_in_camera.center_m)
            found.append(Trial(name, texture, seed, count, method, outcome))
    return found


def chosen(
    found: Sequence[Trial], name: str, textures: tuple[Texture, ...], views: int, method: Method
) -> list[Outcome]:
    """Outcomes of one object with some textures."""
    wanted = (name, views, method)
    return [
        trial.outcome
        for trial in found
        if trial.texture in textures and (trial.object_name, trial.views, trial.method) == wanted
    ]

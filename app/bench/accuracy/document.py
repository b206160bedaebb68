"""docs/accuracy.md: how large the errors are beside the least that is possible, and whether the program knows them."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from app.bench.accuracy.belief_tables import coverage_table, misdrawn_table, recognition_table
from app.bench.accuracy.clouds import CAMERA, KERNEL_PX, MATCHED, OUTLIER_PX
from app.bench.accuracy.goals import Goal, goal_table
from app.bench.accuracy.misdrawn import POSES as MISDRAWN_POSES
from app.bench.accuracy.misdrawn import movements
from app.bench.accuracy.outcome import TRUE_KINDS
from app.bench.accuracy.peers import RANSAC_POINTS, RANSAC_SIGMAS, RANSAC_TRIALS, SLICES, require_peers
from app.bench.accuracy.recorded import RECORDINGS, read_recording
from app.bench.accuracy.recorded_tables import recorded_tables
from app.bench.accuracy.size_tables import (
    BOUND_RATIO,
    FAR_SIGMAS,
    correlated_table,
    full_model_table,
    peer_table,
    white_tables,
)
from app.bench.accuracy.timings import RUNS, timing_table
from app.bench.accuracy.trials import Found, Plan, trials
from app.bench.accuracy.unanswerable import AREAS, Area
from app.bench.accuracy.unanswerable_table import unanswerable_table
from app.bench.table import wrapped
from rotrecon.simulation.simulate import DISTANCE_M, OBJECTS, TILT_RAD


@dataclass(frozen=True)
class Extent:
    """How much is measured."""

    plan: Plan = field(default_factory=Plan)
    misdrawn_poses: int = MISDRAWN_POSES
    areas: tuple[Area, ...] = AREAS
    """Of which none has a certain answer."""
    runs: int = RUNS
    processes: int | None = None
    """None takes one of every core."""


def accuracy_document(recordings: Path | None = None, extent: Extent | None = None) -> str:
    """The document; half an hour of work on two cores unless a smaller extent is named.

    Raises SceneError for a recording that the folder has not, and PeerMissing for a package that is not installed.
    """
    extent = extent or Extent()
    plan = extent.plan
    if plan.compared:
        require_peers()
    recorded, recorded_goals = ("", list[Goal]()) if recordings is None else recorded_tables(recordings, plan.method)
    tin = None if recordings is None else read_recording(RECORDINGS[0], recordings)
    speed, speed_goals = timing_table(tin, plan.method, extent.runs)
    found = Found(trials(plan, extent.processes))
    moved = movements(plan.method, extent.misdrawn_poses, extent.processes)
    unanswerable, unanswerable_goals = unanswerable_table(recordings, plan.method, extent.areas, extent.processes)
    white, white_goals = white_tables(found, plan)
    correlated, correlated_goals = correlated_table(found, plan)
    coverage, coverage_goals = coverage_table(found, plan)
    recognition, recognition_goals = recognition_table(found, plan)
    misdrawn, misdrawn_goals = misdrawn_table(moved)
    goals = [*white_goals, *correlated_goals, *coverage_goals, *recognition_goals]
    goals += [*unanswerable_goals, *misdrawn_goals, *recorded_goals, *speed_goals]
    parts = [
        _summary(goals, plan),
        _introduction(plan),
        _white(white),
        _correlated(correlated),
        _full_model(full_model_table(found, plan), plan),
        _peers(peer_table(found, plan), plan),
        _coverage(coverage),
        _recognition(recognition),
        _unanswerable(unanswerable),
        _misdrawn(misdrawn, extent),
        _recorded(recorded),
        _speed(speed),
    ]
    return wrapped("\n\n".join(parts)) + "\n"


def _summary(goals: list[Goal], plan: Plan) -> str:
    missed = [goal.what for goal in goals if not goal.met]
    count = f"{len(goals) - len(missed)} of {len(goals)} figures are reached"
    return f"""# How accurate it is

Written by `rotrecon bench --accuracy docs/accuracy.md --recordings DIR`; edit `app/bench/accuracy/`, not this file.
Of `method = "{plan.method}"`, {count}{". Not reached: " + "; ".join(missed) if missed else ""}.

{goal_table(goals)}"""


def _introduction(plan: Plan) -> str:
    sizes = ", ".join(f"{name} {2000 * OBJECTS[name].shape.radius_m:.0f} mm" for name in TRUE_KINDS)
    fx, (cx, cy) = CAMERA.focal_px, CAMERA.K[:2, 2]
    return f"""## How it was measured

- **Objects**: {sizes} in diameter, the cone with a half angle of 15 degrees. {plan.poses} poses of each, seeds
  {plan.first_seed} to {plan.first_seed + plan.poses - 1} of the simulator, {DISTANCE_M[0]} to {DISTANCE_M[1]} m away,
  tilted by up to {np.degrees(TILT_RAD):.0f} degrees out of the picture's plane, free in front of a wall.
- **Camera**: {CAMERA.width} x {CAMERA.height} px, focal length {fx:.0f} px, principal point {cx:g}, {cy:g}, baseline
  {MATCHED.baseline_m} m. Depth is ray-cast once a pose; the noise of each cell is laid over its disparity. The frame
  does not state its noise, and its picture is black, so that depth alone is measured; only the full model is rendered.
- **White noise** is independent in every pixel. **Outliers**, a share of all pixels, are spread evenly within
  {OUTLIER_PX:g} px to both sides of the true disparity. An **arc** of 160 degrees means that the object's pixels more
  than 80 degrees round its axis from the camera (a ball: round its centre) have no depth.
- **Correlated noise** has a standard deviation of {MATCHED.disparity_sigma_px} px. "A kernel of {KERNEL_PX} px" can be
  read in two ways: `length` has an autocorrelation of exp(-(lag / {KERNEL_PX} px)^2), `box` is white noise averaged
  over {KERNEL_PX} x {KERNEL_PX} px. The whole view has depth. `matched` is the simulator's full model. Each pose is
  drawn and measured {plan.draws} times with `length` and with `box`, {plan.matched_draws} times with `matched`, every
  time with other noise and another drawing.
- **Drawing**: an ideal operator's, every corner and both ends of the stroke moved by 3 px at random; the kind is not
  told. Whatever kind the answer has, its radius is compared with the true one; a cone's in the middle of its pixels,
  and what its interval is worth where the answer itself has its middle.
- **Errors** are percent of the true value: bias is their mean, RMS the root of their mean square.
- **The bound** is Cramer and Rao's: the least standard deviation of an unbiased measurement from the object's own
  pixels between the ends of the stroke that are no outliers, with the axis (2 + 2), the radius and a cone's slope
  unknown, or a ball's centre and radius. It is derived from the ray-cast depth alone and shares no derivative with the
  program. A cell's bound is the root mean square of its poses' bounds. It knows which pixels are the object's and which
  are outliers, which a program has to find out. It knows nothing of the wall: what is seen beside an object limits its
  size too, so that where little of the object is seen the program can do better. Where the whole view has depth, a few
  pixels at the limb decide the bound, which assumes that errors there are small: it is then too good to be reached."""


def _white(tables: str) -> str:
    return f"""## White noise

Asked for is an RMS of at most {BOUND_RATIO} times the bound in every cell, and no failure: nothing refused, nothing
more than 10 % off. "Least squares" is orthogonal, started at the truth on the object's own pixels, where there are no
outliers. In the wire's cells of 120 degrees and 0.5 px the bound alone would let single sizes lie more than 10 % off
by chance; of those that do, the table above counts which are within {FAR_SIGMAS:.0f} times their own bound.

{tables}"""


def _correlated(tables: str) -> str:
    return f"""## Correlated noise

The bound is that of white noise of equal size, for want of a better one: the true covariance of `length` is so smooth
that it is singular to rounding, and its bound next to nothing. The last three columns are of each pose's first cloud,
the same for all methods.

{tables}"""


def _full_model(tables: str, plan: Plan) -> str:
    return f"""## The simulator's full error model

Disparity is a mean over windows of {MATCHED.window_px} x {MATCHED.window_px} px, of the nearer surface where that fills
{100 * MATCHED.foreground_share:.0f} % of the window, with noise of {MATCHED.disparity_sigma_px} px correlated over
{MATCHED.correlation_px:g} px, shadows of the second camera and holes. The pictures are rendered with
{plan.supersampling} x {plan.supersampling} rays a pixel. The paper and least squares, which is given the true mask,
have each pose's first cloud.

{tables}"""


def _peers(tables: str, plan: Plan) -> str:
    return f"""## Packages that install with pip

Bias / RMS, percent, over the first {plan.peer_poses} poses. All of them are told the kind, and given the object's true
pixels between the stroke's ends with the outliers among them, which no real use has.

- **pyransac3d** draws {RANSAC_TRIALS} samples from {RANSAC_POINTS} random points, its threshold
  {RANSAC_SIGMAS:g} standard deviations of depth. It takes the normal of the plane through three points for a cylinder's
  axis, which holds only if they lie across it; its own documentation warns of that. It has no cone.
- **scikit-image** has circles but no solids: one circle by RANSAC through all points seen along the true axis, of a
  cone one in each of {SLICES} slices and a line through their radii. It has no sphere.
- **MeshLib** approximates the points by a cylinder, a sphere or a cone.

{tables}"""


def _coverage(tables: str) -> str:
    return f"""## Intervals

How many of the 95 % intervals hold the true diameter, or half angle, pooled over all cells of a kind of noise, and the
median half width over the 95th percentile of the absolute errors: 1 is honest, more is too careful.

{tables}"""


def _recognition(tables: str) -> str:
    return f"""## Kinds

All five objects are well inside their class: the wire (25 mm) is a rod, which ends at 30 mm. Right is what the program
called the object, certain or not.

{tables}"""


def _unanswerable(tables: str) -> str:
    return f"""## Nothing round

Areas drawn where nothing stands that could be measured: walls, tables, boxes, bars with edges, heaps, two things at
once, holes; simulated with exact, white and matched depth in turn, and chosen by hand in the recorded scenes.

{tables}"""


def _misdrawn(tables: str, extent: Extent) -> str:
    return f"""## Careless drawings

The change of the diameter at one place of the object when an ideal drawing is spoilt, in half widths of the interval
that the ideal one gives; {extent.misdrawn_poses} poses. "Moved less" is the share below 1. A shortened axis ends early;
a larger area is grown about its middle and holds the wall to both sides.

{tables}"""


def _recorded(tables: str) -> str:
    if not tables:
        return "## Recorded scenes\n\nNot measured: no folder of recordings was named."
    return f"""## Recorded scenes

Their sizes are estimates, by outlines and by hand, and so wide. Drawn once by hand, kind not told.

{tables}"""


def _speed(tables: str) -> str:
    return f"""## Speed

Medians after warm-up on one thread, on the machine that wrote this. One cylinder: from its starts, by the drawing, to
its covariance. Drawing to Reconstruction: everything, with its sections, its parts and what else it may be; also where
the operator says that it is a cylinder.

{tables}"""

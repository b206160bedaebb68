"""Where the camera should go next: how well the diameter would be known from other places, before going there."""

from dataclasses import dataclass, replace
from math import cos, sin

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.camera import PinholeCamera, inverse, transform
from rotrecon.frame import DepthCameraNoise
from rotrecon.grasp import strange
from rotrecon.noise import RayNoise
from rotrecon.outcome import Evidence, Fit
from rotrecon.primitives import Primitive, Sphere
from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.limbs import limbs_of
from rotrecon.rays.surfaces import Surface, turn_of
from rotrecon.rays.traces import Derivatives
from rotrecon.reconstruction import Reconstruction
from rotrecon.workspace import out_of_reach

ANGLES_RAD = tuple(np.deg2rad([-75.0, -60.0, -45.0, -30.0, -15.0, 0.0, 15.0, 30.0, 45.0, 60.0, 75.0]).tolist())
"""Round the object's axis from where the camera is: a finer ring would promise no more than its numbers hold."""
NEARNESSES = (0.6, 0.8, 1.0, 1.25)
"""Distances from the object's middle over the present one; beyond, what is assumed of the noise may not hold."""
GRID = 48
"""Rays each way over the object: twice as many change no prediction by a percent."""
INNER = 0.97
"""Share of the radius within which depths are counted on: at the outline itself derivatives grow without limit."""
LIMB_POINTS = 60
CLEAR_M = 0.02
"""By which something must be before the surface to hide it: more than depths smear."""
CELLS = 24
"""Each way over the object, in which it is asked whether anything is in the way."""
MOST_POINTS = 20_000
"""Of what may be in the way: several a cell."""
AS_GOOD = 0.05
"""Share by which an interval may be wider than the narrowest for the shorter way to be the better one."""
FEWEST_RAYS = 40
"""That meet the object: from where fewer do, nothing is promised."""


@dataclass(frozen=True, eq=False)
class ViewFrom:
    """A place of the camera, and what is expected from there."""

    T_base_camera: Floats
    """(4, 4) rigid."""
    angle_rad: float
    """By which the camera is turned about the object's direction, right-handed."""
    nearness: float
    """Distance from the object's middle over the present one."""
    distance_m: float
    toward: str
    """Which way round that is, as the camera sees it now: left, right, up or down; empty for straight ahead."""
    half_width_m: float
    """Half the 95 % interval of the diameter, of a measurement from there alone."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class _Present:
    """What is known of the object now."""

    result: Reconstruction
    evidence: Evidence
    solid: Primitive
    """In base coordinates."""
    in_way_m: Floats
    """(n, 3) base coordinates: points that are not the object's."""
    half_width_m: float
    sigma_m: float
    """Standard deviation of the radius by the Fisher information of the present view."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class NextView:
    """The best of the places that were tried."""

    best: ViewFrom
    now_m: float
    """Half the present 95 % interval of the diameter."""
    tried: tuple[ViewFrom, ...]
    """All of which something can be said, the best first."""
    beyond_reach: int
    """Places that the arm's limits do not allow."""
    by_distance: tuple[ViewFrom, ...]
    """The best at each distance, the nearest first."""


def next_view(result: Reconstruction) -> NextView | None:
    """The place from which the diameter would be known best; None where no interval is known, or nothing can be said.

    Places are on rings about the object's axis, looking the way the camera looks now. The program measures one frame
    at a time: what is predicted is the interval of a frame from there alone.
    """
    present = _present(result)
    if present is None:
        return None
    tried: list[ViewFrom] = []
    beyond_reach = 0
    for angle_rad in ANGLES_RAD:
        for nearness in NEARNESSES:
            T_base_camera = moved_round(result.frame.T_base_camera, present.solid, angle_rad, nearness)
            if out_of_reach(T_base_camera[:3, 3], result.frame.workspace) is not None:
                beyond_reach += 1
                continue
            half_width_m = _half_width(present, T_base_camera)
            if half_width_m is not None:
                away_m = float(np.linalg.norm(T_base_camera[:3, 3] - present.solid.center_m))
                toward = _toward(result.frame.T_base_camera, T_base_camera)
                tried.append(ViewFrom(T_base_camera, angle_rad, nearness, away_m, toward, half_width_m))
    if not tried:
        return None
    at_each = [[view for view in tried if view.nearness == nearness] for nearness in NEARNESSES]
    tried.sort(key=lambda view: view.half_width_m)
    by_distance = tuple(_best(views) for views in at_each if views)
    return NextView(_best(tried), present.half_width_m, tuple(tried), beyond_reach, by_distance)


def _best(views: list[ViewFrom]) -> ViewFrom:
    """Of those that are as good as the best, the one that takes the shortest way."""
    least_m = min(view.half_width_m for view in views)
    good = [view for view in views if view.half_width_m <= (1 + AS_GOOD) * least_m]
    return min(good, key=lambda view: abs(view.angle_rad) + abs(1 - view.nearness))


def moved_round(T_base_camera: Floats, solid: Primitive, angle_rad: float, nearness: float) -> Floats:
    """The camera's pose (4, 4) turned about a solid's axis, then moved toward its middle; base coordinates."""
    turn = _about(solid.direction, angle_rad)
    pose = np.eye(4)
    pose[:3, :3] = turn @ T_base_camera[:3, :3]
    pose[:3, 3] = solid.center_m + nearness * (turn @ (T_base_camera[:3, 3] - solid.center_m))
    return pose


def predicted_half_width(result: Reconstruction, T_base_camera: Floats) -> float | None:
    """Half the 95 % interval, m, of the diameter of the measured solid from another pose (4, 4) of the camera.

    The Fisher information of depths and outline that would be seen, at the noise of this frame, what its cloud shows
    to be in the way left out; times by how much the present interval is wider than its own prediction. The part of the
    interval that other ways to the size differ by comes from the limbs, where errors are of so many pixels: it shrinks
    with the distance only. None where there is no interval, or too little would be seen.
    """
    present = _present(result)
    return None if present is None else _half_width(present, T_base_camera)


def _present(result: Reconstruction) -> _Present | None:
    fit, solid = result.fit, result.solid
    if not isinstance(fit, Fit) or fit.intervals is None or fit.evidence is None or solid is None:
        return None
    low_m, high_m = fit.intervals.diameter_m
    present = _Present(result, fit.evidence, solid, _in_the_way(result, fit), (high_m - low_m) / 2, 0.0)
    sigma_m = _sigma(present, result.frame.T_base_camera)
    return None if sigma_m is None else replace(present, sigma_m=sigma_m)


def _half_width(present: _Present, T_base_camera: Floats) -> float | None:
    sigma_m = _sigma(present, T_base_camera)
    if sigma_m is None:
        return None
    centers_m = np.stack([present.result.frame.T_base_camera[:3, 3], T_base_camera[:3, 3]])
    now_m, there_m = np.linalg.norm(centers_m - present.solid.center_m, axis=1)
    doubt = present.evidence.doubt_share
    by_noise, by_doubt = (sigma_m / present.sigma_m) ** 2, float(there_m / now_m) ** 2
    return present.half_width_m * float(np.sqrt((1 - doubt) * by_noise + doubt * by_doubt))


def _sigma(present: _Present, T_base_camera: Floats) -> float | None:
    """Standard deviation of the radius by the Fisher information alone; None where too little would be seen."""
    evidence, frame = present.evidence, present.result.frame
    camera, T_camera_base = frame.camera, inverse(T_base_camera)
    solid = present.solid.moved(T_camera_base)
    box_px = _box_px(solid, camera)
    if box_px is None:
        return None
    surface = _surface(solid, camera)
    rays, pixels_each = _rays(camera, box_px)
    depth_m, seen = surface.meet(rays)
    seen &= (surface.off_middle(rays) < INNER) & (depth_m > 0)
    if not isinstance(solid, Sphere):
        along = solid.direction @ (rays * depth_m - solid.center_m[:, None])
        seen &= (along >= solid.ends[0]) & (along <= solid.ends[1])
    if frame.workspace.depth_m is not None:
        nearest_m, farthest_m = frame.workspace.depth_m
        seen &= (depth_m >= nearest_m) & (depth_m <= farthest_m)
    seen &= ~_hidden(transform(T_camera_base, present.in_way_m), camera, box_px, rays, depth_m)
    if seen.sum() < FEWEST_RAYS:
        return None
    noise = _noise(present)
    trace = surface.trace(rays[:, seen])
    information = _information(trace, evidence.depth_weight * pixels_each / noise.sigma_m(trace.depth_m) ** 2)
    information += _outline(surface, solid, camera, evidence.outline_weight)
    covariance = np.linalg.pinv(information, hermitian=True)
    place = 3 if isinstance(surface, Ball) else 4
    return float(np.sqrt(covariance[place, place]))


def _information(derivatives: Derivatives, weight: Floats) -> Floats:
    columns = derivatives.columns
    return (columns * weight) @ columns.T


def _outline(surface: Surface, solid: Primitive, camera: PinholeCamera, weight: float) -> Floats:
    """Information of the outline, of which as much is told by a pixel as now is by all that is seen of it."""
    count = len(surface.units(1.0))
    limbs = limbs_of(surface, camera, np.linspace(*solid.ends, LIMB_POINTS))
    if weight == 0.0 or len(limbs.side) == 0:
        return np.zeros((count, count))
    tangency = surface.tangency(camera.unproject(limbs.point_px, np.ones(len(limbs.side))).T)
    px_per_m = camera.focal_px / tangency.depth_m
    return _information(tangency, weight / len(limbs.side) * px_per_m**2)


def _noise(present: _Present) -> RayNoise:
    """The noise of the frame: as it is stated, else that of a stereo camera that errs by as much at the object."""
    evidence, stated = present.evidence, present.result.frame.noise
    if isinstance(stated, DepthCameraNoise):
        return RayNoise(stated.sigma0_m, stated.sigma2_per_m, evidence.correlation_px, True)
    depth_m = float(present.solid.moved(inverse(present.result.frame.T_base_camera)).center_m[2])
    return RayNoise(0.0, evidence.noise_m / depth_m**2, evidence.correlation_px, stated is not None)


def _surface(solid: Primitive, camera: PinholeCamera) -> Surface:
    """The surface of a solid; a general solid of revolution is taken for a cylinder as thick as its middle."""
    if isinstance(solid, Sphere):
        return Ball(solid.center_m, solid.radius_m, camera.focal_px)
    slope = float(np.tan(solid.half_angle_rad)) if solid.kind == "cone" else 0.0
    turn = turn_of(solid.direction, -solid.center_m)
    return Lateral(solid.center_m, turn, solid.radius_m, slope, camera.focal_px, solid.kind == "cone")


def _box_px(solid: Primitive, camera: PinholeCamera) -> Floats | None:
    """Lowest and highest pixel (2, 2) of the rectangle that a solid is in, within the picture; None outside of it."""
    radius_m = float(np.max(solid.radius_at(np.linspace(*solid.ends, 9))))
    ends_m = solid.center_m + np.array(solid.ends)[:, None] * solid.direction
    if ends_m[:, 2].min() <= radius_m:
        return None
    reach_px = radius_m * camera.focal_px / (ends_m[:, 2] - radius_m)
    place = camera.project(ends_m)
    size = np.array([camera.width, camera.height]) - 1.0
    low = np.clip((place - reach_px[:, None]).min(axis=0), 0.0, size)
    high = np.clip((place + reach_px[:, None]).max(axis=0), 0.0, size)
    return np.stack([low, high]) if (high - low > 1.0).all() else None


def _rays(camera: PinholeCamera, box_px: Floats) -> tuple[Floats, float]:
    """Rays (3, n) evenly over a rectangle, and how many pixels each stands for."""
    low, high = box_px
    share = (np.arange(GRID) + 0.5) / GRID
    v, u = np.indices((GRID, GRID))
    place = low + np.stack([share[u.ravel()], share[v.ravel()]], axis=-1) * (high - low)
    size = high - low
    return camera.unproject(place, np.ones(len(place))).T, float(size[0] * size[1]) / GRID**2


def _in_the_way(result: Reconstruction, fit: Fit) -> Floats:
    """Points (n, 3), base coordinates, of the frame's cloud that are not the object's and no farther than twice it."""
    frame = result.frame
    points_m = frame.points_m.reshape(-1, 3)[strange(result, fit)].astype(np.float64)
    points_m = points_m[points_m[:, 2] < 2 * fit.solid.center_m[2]]
    return transform(frame.T_base_camera, points_m[:: len(points_m) // MOST_POINTS + 1])


def _hidden(in_way_m: Floats, camera: PinholeCamera, box_px: Floats, rays: Floats, depth_m: Floats) -> Bools:
    """Which rays (n,) pass a cell of the rectangle in which something, camera coordinates, is before the surface."""
    low, high = box_px
    place = camera.project(in_way_m)
    cell = np.floor((place - low) / (high - low) * CELLS)
    with np.errstate(invalid="ignore"):
        inside = ((cell >= 0) & (cell < CELLS)).all(axis=1)
    nearest_m = np.full((CELLS, CELLS), np.inf)
    column, row = cell[inside].astype(np.int32).T
    np.minimum.at(nearest_m, (row, column), in_way_m[inside, 2])
    at_px = camera.project(rays.T)
    column, row = np.clip((at_px - low) / (high - low) * CELLS, 0, CELLS - 1).astype(np.int32).T
    return nearest_m[row, column] < depth_m - CLEAR_M


def _about(direction: Floats, angle_rad: float) -> Floats:
    """Rotation (3, 3) about a unit vector (Rodrigues)."""
    x, y, z = direction
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sin(angle_rad) * cross + (1 - cos(angle_rad)) * (cross @ cross)


def _toward(T_base_camera: Floats, T_base_moved: Floats) -> str:
    """Which way a camera is turned, as it sees it; empty where it is not."""
    right, down, _ = T_base_camera[:3, :3].T @ (T_base_moved[:3, 2] - T_base_camera[:3, 2])
    if max(abs(right), abs(down)) < np.finfo(np.float32).eps:
        return ""
    # it goes on looking at the object, and so goes left where it comes to look to the right
    if abs(right) >= abs(down):
        return "left" if right > 0 else "right"
    return "up" if down > 0 else "down"

"""How well the diameter of a measured solid would be known from another place of the camera."""

from dataclasses import dataclass, replace

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
FEWEST_RAYS = 40
"""That meet the object: from where fewer do, nothing is promised."""


@dataclass(frozen=True, eq=False)
class Present:
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


def predicted_half_width(result: Reconstruction, T_base_camera: Floats) -> float | None:
    """Half the 95 % interval, m, of the diameter of the measured solid from another pose (4, 4) of the camera.

    The Fisher information of depths and outline that would be seen, at the noise of this frame, what its cloud shows
    to be in the way left out; times by how much the present interval is wider than its own prediction. The part of the
    interval that other ways to the size differ by comes from the limbs, where errors are of so many pixels: it shrinks
    with the distance only. None where there is no interval, or too little would be seen.
    """
    present = present_of(result)
    return None if present is None else half_width_from(present, T_base_camera)


def present_of(result: Reconstruction) -> Present | None:
    """What is known of a measured object; None where no interval is known, or too little is seen."""
    fit, solid = result.fit, result.solid
    if not isinstance(fit, Fit) or fit.intervals is None or fit.evidence is None or solid is None:
        return None
    low_m, high_m = fit.intervals.diameter_m
    present = Present(result, fit.evidence, solid, _in_the_way(result, fit), (high_m - low_m) / 2, 0.0)
    sigma_m = _sigma(present, result.frame.T_base_camera)
    return None if sigma_m is None else replace(present, sigma_m=sigma_m)


def half_width_from(present: Present, T_base_camera: Floats) -> float | None:
    """Half the 95 % interval, m, of the diameter from a pose (4, 4); see `predicted_half_width`."""
    sigma_m = _sigma(present, T_base_camera)
    if sigma_m is None:
        return None
    centers_m = np.stack([present.result.frame.T_base_camera[:3, 3], T_base_camera[:3, 3]])
    now_m, there_m = np.linalg.norm(centers_m - present.solid.center_m, axis=1)
    doubt = present.evidence.doubt_share
    by_noise, by_doubt = (sigma_m / present.sigma_m) ** 2, float(there_m / now_m) ** 2
    return present.half_width_m * float(np.sqrt((1 - doubt) * by_noise + doubt * by_doubt))


def _sigma(present: Present, T_base_camera: Floats) -> float | None:
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
    return float(np.sqrt(covariance[surface.size_place, surface.size_place]))


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


def _noise(present: Present) -> RayNoise:
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
    cloud = frame.points_m.reshape(-1, 3)
    with np.errstate(invalid="ignore"):
        pixels = np.flatnonzero(strange(result, fit, cloud[:, 2] < 2 * fit.solid.center_m[2]))
    return transform(frame.T_base_camera, cloud[pixels[:: len(pixels) // MOST_POINTS + 1]])


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

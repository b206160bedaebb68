"""What others make of the same clouds: orthogonal least squares, and three packages that install with pip.

All of them are given what nobody has outside a simulation: the kind, and the pixels that are the object's; least
squares starts at the truth, and scikit-image knows the true axis.
"""

import random
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from app.bench.accuracy.clouds import FOCAL_BASELINE, Cloud
from app.bench.accuracy.outcome import Outcome, radius_at, true_half_angle
from rotrecon.arrays import Bools, Floats
from rotrecon.primitives import Frustum, Simple, Sphere, basis_across

RANSAC_POINTS = 1000
"""Points that the packages' loops of random samples are given: they are written in Python, and slow."""
RANSAC_TRIALS = 1000
RANSAC_SIGMAS = 3.0
"""Threshold of an inlier, in standard deviations of depth."""
SLICES = 30
"""Sections of a cone whose circles are fitted one by one."""


class PeerMissing(RuntimeError):
    """A package that the benchmark compares with is not installed; the message says how to get it."""


def orthogonal_least_squares(cloud: Cloud) -> Outcome:
    """Least squares of orthogonal distances, started at the truth, without outliers."""
    points, truth = _points(cloud, cloud.own), cloud.truth
    count = 4 if isinstance(truth, Sphere) else 6 if truth.kind == "cone" else 5

    def solid(change: Floats) -> Simple:
        return _changed(truth, change)

    found = least_squares(lambda change: solid(change).distance(points), np.zeros(count), x_scale="jac")
    return _outcome(solid(found.x), cloud)


def pyransac3d(cloud: Cloud) -> Outcome | None:
    """Its cylinder or sphere by random samples of three or four points; it has no cone."""
    if cloud.truth.kind == "cone":
        return None
    package, rng = _package("pyransac3d"), np.random.default_rng(cloud.seed)
    points = _points(cloud, cloud.surface)
    sample = points[rng.permutation(len(points))[:RANSAC_POINTS]]
    random.seed(cloud.seed)
    model = package.Sphere() if isinstance(cloud.truth, Sphere) else package.Cylinder()
    with np.errstate(all="ignore"):
        model.fit(sample, _threshold_m(cloud), RANSAC_TRIALS)
    return Outcome(radius=float(model.radius) / cloud.truth.radius_m - 1, kind=cloud.truth.kind)


def scikit_image(cloud: Cloud) -> Outcome | None:
    """Circles by RANSAC across the true axis: one of a cylinder, of a cone thirty and a line through their radii."""
    truth = cloud.truth
    if isinstance(truth, Sphere):
        return None
    points = _points(cloud, cloud.surface)
    along = (points - truth.center_m) @ truth.direction
    across = np.stack([(points - truth.center_m) @ axis for axis in basis_across(truth.direction, -truth.center_m)], 1)
    if truth.kind != "cone":
        return Outcome(radius=_circle_radius(across, cloud) / truth.radius_m - 1, kind=truth.kind)
    edges = np.linspace(along.min(), along.max(), SLICES + 1)
    heights, radii = (edges[:-1] + edges[1:]) / 2, np.zeros(SLICES)
    for number in range(SLICES):
        within = (along >= edges[number]) & (along <= edges[number + 1])
        radii[number] = _circle_radius(across[within], cloud)
    slope, at_zero = np.polyfit(heights, radii, 1)
    cone = Frustum("cone", truth.center_m, truth.direction, truth.length_m, float(at_zero), float(np.arctan(slope)))
    return _outcome(cone, cloud)


def meshlib(cloud: Cloud) -> Outcome:
    """MeshLib's approximations of points by a cylinder, a sphere or a cone."""
    package = _package("meshlib.mrmeshpy")
    points, truth = _points(cloud, cloud.surface), cloud.truth
    vector = package.std_vector_Vector3_float()
    for point in points:
        vector.append(package.Vector3f(*map(float, point)))
    if isinstance(truth, Sphere):
        return Outcome(radius=package.SphereObject(vector).getRadius() / truth.radius_m - 1, kind=truth.kind)
    if truth.kind != "cone":
        return Outcome(radius=package.CylinderObject(vector).getRadius() / truth.radius_m - 1, kind=truth.kind)
    found = package.ConeObject(vector)
    apex, direction, half_angle = _vector(found.getCenter()), _vector(found.getDirection()), float(found.getAngle())
    radius = float((cloud.place_m - apex) @ direction) * float(np.tan(half_angle))
    relative = radius / radius_at(truth, cloud.place_m) - 1
    return Outcome(radius=relative, half_angle=half_angle / true_half_angle(truth) - 1, kind=truth.kind)


Peer = Callable[[Cloud], Outcome | None]
PEERS: dict[str, Peer] = {"pyransac3d": pyransac3d, "scikit-image": scikit_image, "MeshLib": meshlib}
"""None for what a package does not offer."""


def require_peers() -> None:
    """Raise PeerMissing unless all packages are there: better at once than after ten minutes."""
    for name in ("pyransac3d", "skimage", "meshlib"):
        _package(name)


def _package(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError as error:
        missing = name.partition(".")[0]
        raise PeerMissing(
            f"{missing}, which the benchmark compares with, is not installed; run pip install -e '.[bench]'"
        ) from error


def _circle_radius(across: Floats, cloud: Cloud) -> float:
    measure = _package("skimage.measure")
    model, _ = measure.ransac(
        across, measure.CircleModel, 3, _threshold_m(cloud), max_trials=RANSAC_TRIALS, rng=cloud.seed
    )
    return float(model.radius) if model else np.nan


def _changed(truth: Simple, change: Floats) -> Simple:
    """The truth with its unknowns changed: centre and radius, or axis (2 + 2), radius and slope."""
    if isinstance(truth, Sphere):
        return Sphere(truth.center_m + change[:3], truth.direction, truth.radius_m + float(change[3]))
    first, second = basis_across(truth.direction, -truth.center_m)
    direction = truth.direction + change[2] * first + change[3] * second
    return Frustum(
        truth.kind,
        truth.center_m + change[0] * first + change[1] * second,
        direction / np.linalg.norm(direction),
        truth.length_m,
        truth.radius_m + float(change[4]),
        truth.half_angle_rad + (float(change[5]) if len(change) == 6 else 0.0),
    )


def _outcome(solid: Simple, cloud: Cloud) -> Outcome:
    """A solid of the same kind beside the truth."""
    radius = radius_at(solid, cloud.place_m) / radius_at(cloud.truth, cloud.place_m) - 1
    return Outcome(radius, half_angle=_half_angle(solid) / true_half_angle(cloud.truth) - 1, kind=solid.kind)


def _half_angle(solid: Simple) -> float:
    return np.nan if isinstance(solid, Sphere) else solid.half_angle_rad


def _points(cloud: Cloud, chosen: Bools) -> Floats:
    return cloud.frame.points_m[chosen].astype(np.float64)


def _threshold_m(cloud: Cloud) -> float:
    depth_m = float(np.median(cloud.frame.depth_m[cloud.surface]))
    return RANSAC_SIGMAS * depth_m**2 * cloud.sigma_px / FOCAL_BASELINE


def _vector(found: Any) -> Floats:
    return np.array([found.x, found.y, found.z], dtype=np.float64)

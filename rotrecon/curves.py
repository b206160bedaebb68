"""The curves of a solid that a person would draw: its rims, where it bends, and its limbs, on the frame."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.primitives import Frustum, Primitive, Revolution, Sphere, basis_across

CURVE_POINTS = 97
"""Enough for a polygon to pass for a circle at any size a frame can show."""
BEND = 0.08
"""Share of the largest radius by which a profile leaves a straight line before it has a ring there: a bottle has one
at its shoulder and one at its neck, a ball three between its poles (7.6 % would give it seven)."""
SIGHT_STEPS = 128
"""Places on a line of sight where it is asked whether the solid is in its way: one in 0.8 % of the solid's size."""
WITHIN = 5e-3
"""Share of the largest radius that a line of sight must go into the solid before it counts as stopped: a chord between
two points of a drawn circle is 0.05 % inside, the first step of a line that goes straight in 1.6 % or more."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A curve on the solid, re-projected on the frame."""

    points_px: Floats
    """(n, 2); NaN behind the camera, and where a limb has a gap."""
    visible: Bools
    """(n,) False where the solid itself hides the curve."""

    def __post_init__(self) -> None:
        freeze(self)


def curves_of(solid: Primitive, camera: PinholeCamera) -> tuple[Outline, ...]:
    """Curves of a solid in camera coordinates: bases and limbs, of a ball its diametric section and limb.

    A general solid of revolution has a ring wherever its profile bends, too.
    """
    if isinstance(solid, Sphere):
        return _sphere_curves(solid, camera)
    if isinstance(solid, Revolution):
        return _revolution_curves(solid, camera)
    return _frustum_curves(solid, camera)


def _ring(center_m: Floats, normal: Floats, radius_m: float) -> Floats:
    """Points (n, 3) of a circle round a normal."""
    x, y = basis_across(normal, -center_m)
    angle = np.linspace(0, 2 * np.pi, CURVE_POINTS)[:, None]
    return center_m + radius_m * (np.cos(angle) * x + np.sin(angle) * y)


def _sphere_curves(ball: Sphere, camera: PinholeCamera) -> tuple[Outline, ...]:
    """The diametric section across the drawn axis, and the limb where sight lines touch the ball."""
    section = _ring(ball.center_m, ball.direction, ball.radius_m)
    hidden = ((section - ball.center_m) * section).sum(axis=1) > 0
    curves = [Outline(camera.project(section), ~hidden)]
    away_m = float(np.linalg.norm(ball.center_m))
    shrink = 1 - (ball.radius_m / away_m) ** 2
    if shrink > 0:
        limb = _ring(ball.center_m * shrink, ball.center_m / away_m, ball.radius_m * np.sqrt(shrink))
        curves.append(Outline(camera.project(limb), np.ones(len(limb), dtype=np.bool_)))
    return tuple(curves)


def _frustum_curves(solid: Frustum, camera: PinholeCamera) -> tuple[Outline, ...]:
    """The two bases, and the two lines where sight lines touch the side.

    The tangent plane is the same along a whole generator, so a point of the rim is seen when the side there or the
    base itself faces the camera, which is the origin.
    """
    slope = float(np.tan(solid.half_angle_rad))
    curves: list[Outline] = []
    for end, outward in zip(solid.ends, (-solid.direction, solid.direction), strict=True):
        center = solid.center_m + end * solid.direction
        rim = _ring(center, solid.direction, float(solid.radius_at(end)))
        radial = (rim - center) / max(float(solid.radius_at(end)), 1e-12)
        side_faces = ((radial - slope * solid.direction) * rim).sum(axis=1) < 0
        curves.append(Outline(camera.project(rim), side_faces | bool(center @ outward < 0)))
    for radial in _limb_directions(solid, solid.center_m, solid.radius_m, slope):
        line = [solid.center_m + end * solid.direction + solid.radius_at(end) * radial for end in solid.ends]
        curves.append(Outline(camera.project(np.array(line)), np.ones(2, dtype=np.bool_)))
    return tuple(curves)


def _limb_directions(
    solid: Frustum | Revolution, center_m: Floats, radius_m: float, slope: float
) -> tuple[Floats, ...]:
    """Unit vectors (3,) across the axis to the two generators that sight lines touch; none from inside the cone.

    The cone grows by `slope` along the axis, and its section about `center_m` (3,) has `radius_m`.
    """
    x, y = basis_across(solid.direction, -center_m)
    toward = np.array([center_m @ x, center_m @ y])
    offset = radius_m - slope * float(center_m @ solid.direction)
    ratio = -offset / max(float(np.linalg.norm(toward)), 1e-12)
    if abs(ratio) >= 1:
        return ()
    middle, half = np.arctan2(toward[1], toward[0]), np.arccos(ratio)
    return tuple(np.cos(angle) * x + np.sin(angle) * y for angle in (middle - half, middle + half))


def _revolution_curves(solid: Revolution, camera: PinholeCamera) -> tuple[Outline, ...]:
    """Rings at the ends and where the profile bends, and the two limbs, piece by piece of the profile."""
    rings = [
        _ring(solid.center_m + along * solid.direction, solid.direction, radius)
        for along, radius in zip(solid.along_m, solid.radii_m, strict=True)
    ]
    curves: list[Floats] = [rings[number] for number in _bends(solid)] + _limbs(solid)
    return tuple(Outline(camera.project(curve), ~_is_hidden(solid, curve)) for curve in curves)


def _bends(solid: Revolution) -> list[int]:
    """Numbers of the positions of a polygon close to the profile, both ends among them (Douglas and Peucker 1973)."""
    profile = np.stack([solid.along_m, solid.radii_m], axis=1).astype(np.float32)
    kept = np.asarray(
        cv2.approxPolyDP(profile[:, None], BEND * float(solid.radii_m.max()), closed=False), dtype=np.float32
    )
    return [number for number, along in enumerate(profile[:, 0]) if along in kept[:, 0, 0]]


def _limbs(solid: Revolution) -> list[Floats]:
    """The two curves (2 (n - 1), 3) where sight lines touch the side; NaN along pieces that no sight line touches."""
    count = len(solid.along_m)
    limbs = np.full((2, count - 1, 2, 3), np.nan)
    axis_m = solid.center_m + solid.along_m[:, None] * solid.direction
    slopes = np.diff(solid.radii_m) / np.diff(solid.along_m)
    for piece, slope in enumerate(slopes):
        radials = _limb_directions(solid, axis_m[piece], float(solid.radii_m[piece]), float(slope))
        for limb, radial in zip(limbs, radials, strict=False):
            for end in (0, 1):
                limb[piece, end] = axis_m[piece + end] + solid.radii_m[piece + end] * radial
    return [limb.reshape(-1, 3) for limb in limbs]


def _is_hidden(solid: Revolution, points_m: Floats) -> Bools:
    """Whether the line of sight to points (n, 3) of the surface goes through the solid first."""
    largest_m = float(solid.radii_m.max())
    low, high = solid.ends
    size_m = float(np.hypot(high - low, 2 * largest_m))
    away_m = np.linalg.norm(points_m, axis=1)[:, None]
    back_m = np.minimum(np.linspace(0, size_m, SIGHT_STEPS), away_m)
    offset = points_m[:, None] * (1 - back_m / away_m)[..., None] - solid.center_m
    along = offset @ solid.direction
    across = np.linalg.norm(offset - along[..., None] * solid.direction, axis=-1)
    margin_m = WITHIN * largest_m
    inside = (along > low + margin_m) & (along < high - margin_m) & (across < solid.radius_at(along) - margin_m)
    return inside.any(axis=1)

"""Which way an axis lies that the operator holds: upright, along the stroke, or square to a plane."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera, inverse, rotate
from rotrecon.drawing import Drawing, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.outcome import FailureReason, FitFailure
from rotrecon.stroke.foreground import Foreground, find_foreground, places_of
from rotrecon.stroke.planes import least_squares, normal_of, refined

STRIP_SHARE = 0.3
"""Share of the object's half width, to each side of the stroke, whose depth says how the stroke runs in space."""
FEWEST_PIXELS = 30
"""Fewer do not hold a line against noise."""
ROUNDS = 10
"""Of reweighting: the weights have settled to a percent by then."""
TUKEY = 4.685
"""Standard deviations at which a pixel counts for nothing; 95 % efficient on normal errors (Holland, Welsch 1977)."""
MAD_TO_SIGMA = 1.4826
"""Standard deviation of a normal distribution over its median magnitude."""
PLANE_SHARE = 0.5
"""Share of what is known round the object that must lie on the plane: most of it."""
AWAY_RAD = float(np.deg2rad(45.0))
"""Largest angle of the direction off the plane of stroke and camera: farther off it lies across the stroke."""
ALONG = "draw the axis along it, or let the direction be free"


def held_direction(frame: Frame, drawing: Drawing) -> Floats | FitFailure | None:
    """Unit direction (3,) in camera coordinates that an axis is held to, along the stroke; None where it is free.

    Refused where there is no such direction, or it lies across the stroke. Raises ValueError for a drawing without an
    axis, DrawingError for an area that cannot be used on this frame. "drawn" is the line on the surface under the
    stroke: a cylinder's axis is parallel to it, a cone's is half its angle off it.
    """
    wanted = drawing.constraints.direction
    if wanted == "free":
        return None
    if wanted == "vertical":
        direction = rotate(inverse(frame.T_base_camera), np.array([0.0, 0.0, 1.0]))
    else:
        found = find_foreground(frame, drawing.area)
        if isinstance(found, FitFailure):
            return found
        if wanted == "drawn":
            direction = _under_stroke(found, drawing.stroke, frame.camera)
        else:
            direction = _square_to_plane(found, frame.camera)
        if isinstance(direction, FitFailure):
            return direction
    return _along_stroke(direction, drawing.stroke, frame.camera)


def _along_stroke(direction: Floats, stroke: ObjectAxis, camera: PinholeCamera) -> Floats | FitFailure:
    """The direction or its opposite, whichever goes the way of the stroke; refused when neither does."""
    start, end = camera.unproject(np.array([stroke.start_px, stroke.end_px]), np.ones(2))
    start, end = start / np.linalg.norm(start), end / np.linalg.norm(end)
    across = np.cross(start, end) / np.linalg.norm(np.cross(start, end))
    if abs(float(direction @ across)) > np.sin(AWAY_RAD):
        advice = f"the direction that was chosen lies across the stroke; {ALONG}"
        return FitFailure(FailureReason.CONSTRAINED, advice)
    return direction if direction @ (end - start) >= 0 else -direction


def _square_to_plane(found: Foreground, camera: PinholeCamera) -> Floats | FitFailure:
    """The normal of the plane that most of what is known round the object lies on."""
    patch, others = found.patch, found.patch.known & ~found.mask
    advice = "nothing flat is seen round the object; draw the area larger, or let the direction be free"
    refusal = FitFailure(FailureReason.CONSTRAINED, advice)
    if not found.planes:
        return refusal
    pixels, depth = patch.frame_px(places_of(others)), patch.inverse_depth[others]
    plane, on = refined(found.planes[0], pixels, depth, patch.tolerance[others])
    return normal_of(plane, camera) if on.mean() >= PLANE_SHARE else refusal


def _under_stroke(found: Foreground, stroke: ObjectAxis, camera: PinholeCamera) -> Floats | FitFailure:
    """The direction of the line on the surface under the stroke: in inverse depth it is straight too."""
    patch = found.patch
    start, end = np.array(stroke.start_px), np.array(stroke.end_px)
    length_px = float(np.linalg.norm(end - start))
    along = (end - start) / length_px
    offset = patch.frame_px(places_of(found.mask)) - start
    lengthwise, crosswise = offset @ along, offset @ np.array([-along[1], along[0]])
    beside = (lengthwise > 0) & (lengthwise < length_px)
    half_width_px = float(np.median(np.abs(crosswise[beside]))) * 2 if beside.any() else 0.0
    near = beside & (np.abs(crosswise) < max(STRIP_SHARE * half_width_px, patch.step_px))
    if near.sum() < FEWEST_PIXELS:
        advice = f"no surface that stands out is under the stroke; {ALONG}"
        return FitFailure(FailureReason.CONSTRAINED, advice)
    share = lengthwise[near] / length_px
    ends = _robust(np.column_stack([1 - share, share]), patch.inverse_depth[found.mask][near])
    points_m = camera.unproject(np.array([start, end]), 1 / ends)
    return (points_m[1] - points_m[0]) / np.linalg.norm(points_m[1] - points_m[0])


def _robust(terms: Floats, values: Floats) -> Floats:
    """Coefficients (m,) with which terms (n, m) come nearest to most values (n,): Tukey's biweight, reweighted."""
    solution = least_squares(terms, values)
    for _ in range(ROUNDS):
        off = values - terms @ solution
        sigma = MAD_TO_SIGMA * float(np.median(np.abs(off)))
        if sigma == 0.0:
            break
        root_weight = np.clip(1 - np.square(off / (TUKEY * sigma)), 0, None)
        solution = least_squares(terms * root_weight[:, None], values * root_weight)
    return solution

"""The drawing a careful operator would make round a solid whose place is known."""

import cv2
import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, Drawing, ObjectAxis
from rotrecon.primitives import Frustum, Simple, Sphere, basis_across

MARGIN_PX = 6.0
"""Distance of the area from the outline: nobody draws closer, and the background must be seen to be told apart."""
KEPT_LENGTH = 0.9
"""Share of the visible length inside the area, so that sections stay clear of edges of the ends."""
STROKE_INSET_PX = 1.0
"""How far the stroke ends inside the area."""
CIRCLE_POINTS = 128
"""Points on a drawn circle: its polygon is within 0.1 px of it for any object that fits the picture."""
BALL_VERTICES = 16
"""Vertices of the area round a ball: between them it is still outside the outline."""


def outline_px(solid: Simple, camera: PinholeCamera) -> Floats:
    """Convex outline (N, 2), px, of a solid in camera coordinates; NaN when part of it is behind the camera."""
    if isinstance(solid, Sphere):
        return _ball_outline(solid, camera, CIRCLE_POINTS)
    rims = np.concatenate([camera.project(_rim(solid, end_m)) for end_m in solid.ends])
    if not np.isfinite(rims).all():
        return np.full((1, 2), np.nan)
    corners = np.asarray(cv2.convexHull(rims.astype(np.float32), returnPoints=False), dtype=np.int32)
    return rims[corners[:, 0]]


def ideal_drawing(solid: Simple, camera: PinholeCamera) -> Drawing:
    """Area and stroke, to a tenth of a pixel, round a solid in camera coordinates that is in front of the camera.

    A frustum's area is a quadrangle across the middle of its lateral surface, ends left out; a ball's is a
    polygon round all of it. The stroke follows the projected axis.
    """
    return _ball_drawing(solid, camera) if isinstance(solid, Sphere) else _frustum_drawing(solid, camera)


def perturb(drawing: Drawing, rng: np.random.Generator, sigma_px: float = 3.0) -> Drawing:
    """The same drawing by a less steady hand: every vertex and both ends of the stroke moved at random."""
    area = np.array(drawing.area.vertices_px)
    stroke = np.array([drawing.stroke.start_px, drawing.stroke.end_px])
    return _drawing(area + sigma_px * rng.standard_normal(area.shape), stroke + sigma_px * rng.standard_normal((2, 2)))


def as_arguments(drawing: Drawing) -> tuple[str, str]:
    """Area and axis as the command line takes them: "u,v u,v ..."."""
    stroke = (drawing.stroke.start_px, drawing.stroke.end_px)
    area, axis = (" ".join(f"{u:g},{v:g}" for u, v in points) for points in (drawing.area.vertices_px, stroke))
    return area, axis


def _frustum_drawing(solid: Frustum, camera: PinholeCamera) -> Drawing:
    start, end = camera.project(solid.center_m + np.outer(solid.ends, solid.direction))
    turn = _along_and_across(end - start)
    # a cap that is seen hides the beginning of the lateral surface by its whole inner half
    first, last = 0.0, float(np.linalg.norm(end - start))
    rims = [(camera.project(_rim(solid, end_m)) - start) @ turn.T for end_m in solid.ends]
    if _cap_is_seen(solid, 0):
        first = float(rims[0][:, 0].max())
    if _cap_is_seen(solid, 1):
        last = float(rims[1][:, 0].min())
    cut = (1 - KEPT_LENGTH) / 2 * (last - first)
    first, last = first + cut, last - cut
    outline = (outline_px(solid, camera) - start) @ turn.T
    (low0, high0), (low1, high1) = _width(outline, first), _width(outline, last)
    area = [
        (first, low0 - MARGIN_PX),
        (last, low1 - MARGIN_PX),
        (last, high1 + MARGIN_PX),
        (first, high0 + MARGIN_PX),
    ]
    stroke = [(first + STROKE_INSET_PX, 0.0), (last - STROKE_INSET_PX, 0.0)]
    return _drawing(start + np.array(area) @ turn, start + np.array(stroke) @ turn)


def _ball_drawing(ball: Sphere, camera: PinholeCamera) -> Drawing:
    centre, ahead = camera.project(ball.center_m + np.outer([0, 1e-3], ball.direction))
    turn = _along_and_across(ahead - centre)
    outline = _ball_outline(ball, camera, BALL_VERTICES) - centre
    area = outline * (1 + MARGIN_PX / np.linalg.norm(outline, axis=1, keepdims=True))
    across, along = 1, 0
    swapped = (_ball_outline(ball, camera, CIRCLE_POINTS) - centre) @ turn[[across, along]].T
    first, last = _width(swapped, 0.0)
    stroke = np.array([[first + STROKE_INSET_PX, 0.0], [last - STROKE_INSET_PX, 0.0]])
    return _drawing(centre + area, centre + stroke @ turn)


def _drawing(area: Floats, stroke: Floats) -> Drawing:
    vertices = tuple((round(float(u), 1), round(float(v), 1)) for u, v in area)
    start, end = ((round(float(u), 1), round(float(v), 1)) for u, v in stroke)
    return Drawing(AreaOfInterest(vertices), ObjectAxis(start, end))


def _rim(solid: Frustum, along_m: float) -> Floats:
    """Circle (CIRCLE_POINTS, 3) of the surface at a distance from the middle."""
    centre = solid.center_m + along_m * solid.direction
    return centre + float(solid.radius_at(along_m)) * _circle(solid.direction, CIRCLE_POINTS)


def _ball_outline(ball: Sphere, camera: PinholeCamera, count: int) -> Floats:
    """The circle in which the cone of tangents from the camera touches the ball, projected; (count, 2)."""
    distance = float(np.linalg.norm(ball.center_m))
    toward = ball.center_m / distance
    depth = distance - ball.radius_m**2 / distance
    radius = ball.radius_m * np.sqrt(1 - (ball.radius_m / distance) ** 2)
    return camera.project(depth * toward + radius * _circle(toward, count))


def _circle(normal: Floats, count: int) -> Floats:
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    first, second = basis_across(normal, np.array([0.0, 0.0, 1.0]))
    return np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second


def _cap_is_seen(solid: Frustum, number: int) -> bool:
    """Whether the camera, at the origin, is on the outer side of the first (0) or last (1) end."""
    end_m = solid.ends[number]
    return float((solid.center_m + end_m * solid.direction) @ solid.direction) * np.sign(end_m) < 0


def _along_and_across(stroke_px: Floats) -> Floats:
    """(2, 2) rows: unit vector along a stroke, and a quarter turn clockwise on the screen."""
    u, v = stroke_px / np.linalg.norm(stroke_px)
    return np.array([[u, v], [-v, u]])


def _width(outline: Floats, along: float) -> tuple[float, float]:
    """Lowest and highest second coordinate of a closed outline (N, 2) where its first is `along`."""
    following = np.roll(outline, -1, axis=0)
    crossing = (outline[:, 0] <= along) != (following[:, 0] <= along)
    here, there = outline[crossing], following[crossing]
    share = (along - here[:, 0]) / (there[:, 0] - here[:, 0])
    across = here[:, 1] + share * (there[:, 1] - here[:, 1])
    return float(across.min()), float(across.max())

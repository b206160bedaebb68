"""A careless stroke, put right: along the axis of what was found with it, over as much of that as the area holds."""

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, Drawing, ObjectAxis, area_mask
from rotrecon.outcome import Fit
from rotrecon.primitives import Primitive, Sphere

LEAST_COVERED = 0.72
"""Share of the object's length that a careful stroke covers at least: ends are no place to draw in."""
MOST_BESIDE, STEADY_PX = 0.1, 3.0
"""Widths by which its middle may lie beside the axis, or what no hand is steadier than."""
MOST_TURNED_RAD = float(np.deg2rad(4.0))
"""By which it may be turned."""
INSET_PX = 1.0
"""How far it stays inside the object's ends."""
MOST_PX = 20000
"""Longer than the diagonal of any picture: what is fitted to nothing may be of any length."""


def corrected(drawing: Drawing, fit: Fit, camera: PinholeCamera) -> ObjectAxis | None:
    """The stroke that a careful hand had drawn along a measured solid; None where the drawn one is good enough.

    It never ends before the drawn one, and goes on as far as the object was followed in the area. A stroke that holds
    the direction of the axis is left as it is.
    """
    if drawing.constraints.direction == "drawn":
        return None
    drawn = np.array([drawing.stroke.start_px, drawing.stroke.end_px])
    found = _along(fit, drawn, camera)
    length_px = float(np.linalg.norm(found[1] - found[0])) if np.isfinite(found).all() else 0.0
    if length_px <= 2 * INSET_PX:
        return None
    along = (found[1] - found[0]) / length_px
    offset = (drawn - found[0]) @ np.array([[along[0], -along[1]], [along[1], along[0]]])
    if _is_careful(offset, length_px, fit.solid, camera):
        return None
    first, last = offset[:, 0]
    reach = np.arange(min(first, INSET_PX), max(last, length_px - INSET_PX), 1.0)[:MOST_PX]
    # to a tenth of a pixel, so that the stroke is the same when it is told and given back
    places = (found[0] + reach[:, None] * along).round(1)
    places = places[_inside(drawing.area, places, camera)]
    if len(places) < 2:
        return None
    (u0, v0), (u1, v1) = places[[0, -1]].tolist()
    return ObjectAxis((u0, v0), (u1, v1))


def _is_careful(offset_px: Floats, length_px: float, solid: Primitive, camera: PinholeCamera) -> bool:
    """Whether a stroke's ends (2, 2), along and across the line it should be on, lie well; a ball has no direction."""
    first, last = offset_px[:, 0]
    covered_px = min(last, length_px) - max(first, 0.0)
    beside_px = abs(float(offset_px[:, 1].mean()))
    width_px = 2 * float(solid.radius_at(0.0)) * camera.focal_px / float(solid.center_m[2])
    turned_rad = 0.0 if isinstance(solid, Sphere) else abs(np.arctan2(np.diff(offset_px[:, 1])[0], last - first))
    return bool(
        covered_px >= LEAST_COVERED * length_px
        and beside_px <= max(MOST_BESIDE * width_px, STEADY_PX)
        and turned_rad <= MOST_TURNED_RAD
    )


def _inside(area: AreaOfInterest, places_px: Floats, camera: PinholeCamera) -> Bools:
    """Which places (n, 2) are on pixels of an area."""
    size_px = (camera.width, camera.height)
    column, row = np.floor(np.clip(places_px, -1.0, size_px) + 0.5).astype(np.int32).T
    on_frame = (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
    return on_frame & (area_mask(area, size_px)[row * on_frame, column * on_frame] > 0)


def _along(fit: Fit, drawn_px: Floats, camera: PinholeCamera) -> Floats:
    """Start and end (2, 2) in the picture of the line along the middle of a solid's visible side."""
    solid = fit.solid
    if isinstance(solid, Sphere):
        # a ball has no axis but the stroke's
        middle_px = camera.project(solid.center_m[None])[0]
        along = (drawn_px[1] - drawn_px[0]) / np.linalg.norm(drawn_px[1] - drawn_px[0])
        reach_px = solid.radius_m * camera.focal_px / float(solid.center_m[2])
        return middle_px + np.array([[-reach_px], [reach_px]]) * along
    toward = -solid.center_m + (solid.center_m @ solid.direction) * solid.direction
    toward /= np.linalg.norm(toward) * (-1.0 if fit.concave else 1.0)
    ends_m = np.array(solid.ends)
    ridge = ends_m[:, None] * solid.direction + solid.radius_at(ends_m)[:, None] * toward
    return camera.project(solid.center_m + ridge)

"""The stroke along an object, proposed by the program where only an area was drawn."""

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.drawing import AreaOfInterest, ObjectAxis, area_mask, check_area
from rotrecon.frame import Frame
from rotrecon.outcome import DRAW_CLOSE, FailureReason, FitFailure
from rotrecon.settings import Settings

LEAST_PIXELS = 30
"""Fewer do not show which way an object lies."""


def propose_axis(frame: Frame, area: AreaOfInterest, settings: Settings) -> ObjectAxis | FitFailure:
    """The stroke along the nearest thing in an area; a refusal where nothing stands out.

    Raises DrawingError for an area that cannot be used on this frame.
    """
    size_px = (frame.camera.width, frame.camera.height)
    check_area(area, size_px)
    inside = (area_mask(area, size_px) > 0) & np.isfinite(frame.depth_m)
    near = inside & (frame.depth_m < frame.depth_m[inside].mean()) if inside.any() else inside
    if near.sum() < LEAST_PIXELS:
        return FitFailure(FailureReason.NO_AXIS, f"nothing stands out in the area; {DRAW_CLOSE}")
    return _along(near)


def _along(mask: Bools) -> ObjectAxis:
    """The stroke along the long direction of a mask (height, width)."""
    v, u = np.nonzero(mask)
    places: Floats = np.stack([u, v], axis=1).astype(np.float64)
    middle = places.mean(axis=0)
    direction = np.linalg.eigh(np.cov(places.T))[1][:, -1]
    direction = direction if direction.sum() > 0 else -direction
    low, high = np.quantile((places - middle) @ direction, [0.05, 0.95])
    start, end = middle + low * direction, middle + high * direction
    return ObjectAxis((float(start[0]), float(start[1])), (float(end[0]), float(end[1])))

"""What the watch over frames has to know of them, and whether a newer one shows something else in the area."""

from dataclasses import replace
from datetime import datetime
from hashlib import sha256

import numpy as np

from app.deciding.watchdog import FrameFacts
from rotrecon.capture import Capture
from rotrecon.drawing import AreaOfInterest
from rotrecon.frame import Frame

CHANGED_LEVELS = 8.0
"""Mean difference of pixels, of 255, above which an area shows something else: a sensor's noise stays below 4."""
SAME_POSE = 1e-3
"""Metres, and radians: how well an arm repeats a pose. From elsewhere pixels cannot be compared."""

ENOUGH_PIXELS = 250_000
"""Of an area that are compared: more tell nothing else, and everybody waits for it."""


def facts_of(frame: Frame) -> FrameFacts:
    """Of a recorded frame; its pixels are its picture's and its depths."""
    digest = sha256(frame.image.tobytes())
    digest.update(frame.points_m.tobytes())
    return FrameFacts(digest.hexdigest(), captured_s=_unix_s(frame.captured_at))


def newer_facts(capture: Capture, arrived_at: datetime) -> FrameFacts:
    """Of a recording that was pushed in; where it does not say when it was taken, it is as old as its arrival."""
    if capture.recorded is not None:
        recorded = facts_of(capture.recorded)
        captured_s = arrived_at.timestamp() if recorded.captured_s is None else recorded.captured_s
        return replace(recorded, source="live", captured_s=captured_s)
    digest = sha256()
    for view in capture.views:
        digest.update(view.image.tobytes())
    return FrameFacts(digest.hexdigest(), "live", captured_s=arrived_at.timestamp())


def shows_change(held: Frame, newer: Capture, area: AreaOfInterest | None) -> bool:
    """Whether a newer recording shows something else in the area than the frame that is held."""
    first = newer.views[0] if newer.recorded is None else newer.recorded
    return has_changed(held, first.image, first.T_base_camera, area)


def has_changed(held: Frame, image: np.ndarray, T_base_camera: np.ndarray, area: AreaOfInterest | None) -> bool:
    """Whether a newer picture (H, W, 3) shows something else in the area, or anywhere when there is none.

    One from another pose, or of another size, shows something else.
    """
    if image.shape != held.image.shape or np.abs(T_base_camera - held.T_base_camera).max() > SAME_POSE:
        return True
    window = np.s_[:, :]
    if area is not None:
        (left, top), (right, bottom) = np.min(area.vertices_px, axis=0), np.max(area.vertices_px, axis=0)
        window = np.s_[int(top) : int(bottom) + 1, int(left) : int(right) + 1]
    newer, before = image[window], held.image[window]
    step = max(1, int(np.sqrt(newer[..., 0].size / ENOUGH_PIXELS)))
    difference = newer[::step, ::step].astype(np.float32) - before[::step, ::step]
    return bool(np.abs(difference).mean() > CHANGED_LEVELS)


def _unix_s(moment: datetime | None) -> float | None:
    return None if moment is None else moment.timestamp()

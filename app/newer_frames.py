"""What the watch over frames has to know of them, and whether a newer one shows something else in the area."""

from datetime import datetime
from hashlib import sha256

import numpy as np

from app.clock import wall_s
from app.deciding.watchdog import FrameFacts
from rotrecon.capture import Capture
from rotrecon.drawing import AreaOfInterest
from rotrecon.frame import Frame

CHANGED_LEVELS = 8.0
"""Mean difference of pixels, of 255, above which an area shows something else: a sensor's noise stays below 4."""
SAME_POSE = 1e-3
"""Metres, and radians: how well an arm repeats a pose. From elsewhere pixels cannot be compared."""


def facts_of(frame: Frame) -> FrameFacts:
    """Of a recorded frame; its pixels are its picture's and its depths."""
    digest = sha256(frame.image.tobytes())
    digest.update(frame.points_m.tobytes())
    return FrameFacts(digest.hexdigest(), captured_s=_unix_s(frame.captured_at))


def newer_facts(held: Frame, capture: Capture, area: AreaOfInterest | None) -> tuple[FrameFacts, float, bool]:
    """Of a capture that came after the frame that is held: facts, this machine's time, whether the area has changed."""
    if capture.recorded is not None:
        newer = capture.recorded
        return facts_of(newer), wall_s(), has_changed(held, newer.image, newer.T_base_camera, area)
    digest = sha256(b"".join(view.image.tobytes() for view in capture.views))
    first = capture.views[0]
    return FrameFacts(digest.hexdigest()), wall_s(), has_changed(held, first.image, first.T_base_camera, area)


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
    difference = image[window].astype(np.float32) - held.image[window]
    return bool(np.abs(difference).mean() > CHANGED_LEVELS)


def _unix_s(moment: datetime | None) -> float | None:
    return None if moment is None else moment.timestamp()

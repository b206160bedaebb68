"""What a depth must be to be believed."""

import numpy as np

from rotrecon.arrays import Cloud
from rotrecon.scene.formats.source import SourceFile

FARTHEST_MEDIAN_M = 100.0
"""Far beyond any arm's camera, near beyond the first depth map in millimetres that is taken for metres."""

FARTHEST_M = 1000.0
"""A single depth or coordinate beyond this is a spike of the sensor, not a measurement."""


def check_depth(source: SourceFile, depth_m: Cloud) -> None:
    """Refuse depths, NaN where not valid, of which none is valid or which cannot be metres; raises SceneError."""
    valid = depth_m[np.isfinite(depth_m)]
    if valid.size == 0:
        raise source.error(
            "has no valid depth: all of it is zero, negative, NaN or infinite",
            "record it again, or turn its axes, in metres with z pointing away from the camera",
        )
    median = float(np.median(valid))
    if median > FARTHEST_MEDIAN_M:
        raise source.error(
            f"has a median depth of {median:.0f} m, which looks like millimetres",
            "convert it to metres, or correct depth_scale",
        )

"""Pictures that hold too little to be matched: too dark, saturated, or without contrast."""

import cv2
import numpy as np

from rotrecon.arrays import Bytes

DARK_LEVEL = 24
"""Grey level of 255 below which nearly all of a picture is too dark: noise is then a tenth of it and more."""
BRIGHT_LEVEL = 250
"""Grey level from which a pixel is taken for saturated."""
NEARLY_ALL = 0.95
"""Share of the pixels."""
ENOUGH = 50_000
"""Pixels that are looked at: so many tell a share to half a percent."""
MOST_SATURATED = 0.4
"""Share of saturated pixels above which there is too little left to match."""


def exposure_problem(pixels: Bytes) -> str | None:
    """What is wrong with the exposure of some pixels (n, 3), and what to do; None when they can be matched."""
    step = 1 + len(pixels) // ENOUGH
    grey = cv2.cvtColor(np.ascontiguousarray(pixels[::step, None]), cv2.COLOR_RGB2GRAY)
    saturated = float((grey >= BRIGHT_LEVEL).mean())
    if saturated > MOST_SATURATED:
        return f"is saturated in {100 * saturated:.0f} % of its pixels; expose for a shorter time, or dim the light"
    if float(np.quantile(grey, NEARLY_ALL)) < DARK_LEVEL:
        return f"is too dark, below {DARK_LEVEL} of 255 nearly everywhere; expose for longer, or light the scene"
    return None

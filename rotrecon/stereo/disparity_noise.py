"""What matched disparities err by, told from the pictures: how far they differ, and how much texture holds them."""

import cv2
import numpy as np

from rotrecon.arrays import Bytes, Cloud

FLOOR_PX = 0.1
"""Of parabolas through costs at whole disparities, which pull towards these, and of steps of a sixteenth."""
SUPPORT_PX = 5
"""Side of the window whose texture holds a disparity: the block, and what its paths bring in from beside it."""
OVER_BOUND = 1.7
"""Error over the bound for such a window, on rendered pairs of fine, coarse and weak texture: the matcher's cost is cut
off and its paths smooth, and that is no optimal estimate."""
TAIL = 0.05
"""Share of the disparities at either end that may be wrong."""
WORST_PX = 1.0
"""Where texture holds it worse than this, the paths' smoothness does: to about a disparity."""
NORMAL_MAD = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation."""
FEWEST = 50
"""Matched pixels that say something."""


def disparity_sigma_px(reference: Bytes, other: Bytes, disparity: Cloud) -> float | None:
    """Standard deviation (RMS) of disparities (h, w), negative where unknown, between two rectified pictures (h, w).

    A shift is known to sigma_I / sqrt(sum g^2), sigma_I being that of the difference of the pictures and g the gradient
    along rows (Foerstner 1982). That of the nearer half of the disparities counts, as the object is in front; None for
    too few pixels.
    """
    known = disparity >= 0
    if known.sum() < FEWEST:
        return None
    known &= disparity >= np.quantile(disparity[known], [TAIL, 1 - TAIL]).mean()
    columns = np.arange(disparity.shape[1], dtype=np.float32)[None, :] - disparity
    rows = np.repeat(np.arange(disparity.shape[0], dtype=np.float32)[:, None], disparity.shape[1], axis=1)
    seen = np.asarray(cv2.remap(other, columns, rows, cv2.INTER_LINEAR), dtype=np.float32)
    difference = (reference - seen)[known]
    spread = NORMAL_MAD * float(np.median(np.abs(difference - np.median(difference))))
    slope = cv2.Scharr(reference, cv2.CV_32F, 1, 0, scale=1 / 32)
    held = np.asarray(cv2.boxFilter(cv2.multiply(slope, slope), -1, (SUPPORT_PX, SUPPORT_PX), normalize=False))[known]
    bound = spread**2 / np.maximum(held, np.finfo(np.float32).tiny)
    variance = np.minimum(OVER_BOUND**2 * bound, WORST_PX**2)
    return float(np.sqrt(FLOOR_PX**2 + variance.mean()))

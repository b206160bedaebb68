"""What the pictures say of matched disparities: which cannot be, and what the others err by."""

import cv2
import numpy as np

from rotrecon.arrays import Bytes, Cloud, strips
from rotrecon.stereo.canvas import beyond

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
EVERY = 4
"""Rows from one that is looked at to the next: a quarter of a million pixels say as much as a million."""
FEWEST = 50
"""Matched pixels that say something."""


def check_against_pictures(reference: Bytes, other: Bytes, disparity: Cloud) -> float | None:
    """Take out of disparities (h, w) what lies beyond either picture, and say what the others err by, px.

    Disparities that are negative are unknown, and those taken out become so in place; pictures are (h, w), black where
    nothing was recorded. None for too few to say.
    """
    return _sigma_px(*_checked(reference, other, disparity))


def _checked(reference: Bytes, other: Bytes, disparity: Cloud) -> Cloud:
    """Take out what lies beyond either picture; how far pictures differ at the others, what holds these, and these.

    (3, n) of every `EVERY`-th row; see `_sigma_px`.
    """
    unseen, other_unseen = beyond(reference), beyond(other)
    columns = np.arange(disparity.shape[1], dtype=np.float32)[None, :]
    told = np.empty((3, disparity[::EVERY].size), dtype=np.float32)
    count = 0
    for top, bottom in strips(len(disparity)):
        part = disparity[top:bottom]
        x = columns - part
        y = np.broadcast_to(np.arange(top, bottom, dtype=np.float32)[:, None], x.shape).copy()
        lost = cv2.remap(other_unseen, x, y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_CONSTANT, borderValue=(255.0,))
        part[(np.asarray(lost) > 0) | (unseen[top:bottom] > 0)] = -1.0
        known = part[::EVERY] >= 0
        seen = np.asarray(cv2.remap(other, x[::EVERY], y[::EVERY], cv2.INTER_LINEAR), dtype=np.float32)
        difference = _local(np.where(known, reference[top:bottom:EVERY] - seen, np.float32(np.nan)))
        here = slice(count, count + np.count_nonzero(known))
        told[:, here] = difference[known], _squared_slopes(reference, top, bottom)[::EVERY][known], part[::EVERY][known]
        count = here.stop
    return told[:, :count]


def _local(difference: Cloud) -> Cloud:
    """Differences (r, w) of pictures less those a support to the left, scaled to the same deviation: light that changes
    from view to view, as on glossy surfaces, is smooth and not noise. NaN where either is unknown."""
    local = np.full_like(difference, np.nan)
    local[:, SUPPORT_PX:] = (difference[:, SUPPORT_PX:] - difference[:, :-SUPPORT_PX]) / np.float32(np.sqrt(2))
    return local


def _squared_slopes(reference: Bytes, top: int, bottom: int) -> Cloud:
    """(bottom - top, w) sum of the squared gradients along rows, over the support of a disparity."""
    above = min(top, SUPPORT_PX)
    slope = cv2.Scharr(reference[top - above : bottom + SUPPORT_PX], cv2.CV_32F, 1, 0, scale=1 / 32)
    sums = cv2.boxFilter(cv2.multiply(slope, slope), -1, (SUPPORT_PX, SUPPORT_PX), normalize=False)
    return np.asarray(sums, dtype=np.float32)[above : above + bottom - top]


def _sigma_px(difference: Cloud, held: Cloud, disparity: Cloud) -> float | None:
    """Standard deviation (RMS) of disparities (n,), from how far pictures differ there and what texture holds them.

    A shift is known to sigma_I / sqrt(sum g^2), sigma_I being that of the difference of the pictures and g the gradient
    along rows (Foerstner 1982). That of the nearer half of the disparities counts, as the object is in front.
    """
    if len(disparity) < FEWEST:
        return None
    near = disparity >= np.quantile(disparity, [TAIL, 1 - TAIL]).mean()
    difference, held = difference[near], held[near]
    known = difference[np.isfinite(difference)]
    if len(known) < FEWEST:
        return None
    spread = NORMAL_MAD * float(np.median(np.abs(known)))
    bound = spread**2 / np.maximum(held, np.finfo(np.float32).tiny)
    return float(np.sqrt(FLOOR_PX**2 + np.minimum(OVER_BOUND**2 * bound, WORST_PX**2).mean()))

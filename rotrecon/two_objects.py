"""Whether the sections across a stroke show two things side by side: each bulges, and there is a furrow between."""

import cv2
import numpy as np

from rotrecon.arrays import Floats

SMOOTHED_SHARE = 0.04
"""Of a section's width, over which depths are averaged across."""
SMOOTHED_ROWS = 9
"""Sections along the stroke that are averaged."""
FURROW_SHARE = 0.06
"""Of a section's width, the least depth of a furrow: between touching rods it is a quarter, noise has been averaged."""
SECTIONS_SHARE = 0.5
"""Of the sections, how many must show it."""


def shows_two(depth_m: Floats, metre_per_px: float) -> bool:
    """Whether most sections (S, W) of depths, NaN off what was segmented, have two bulges.

    A bulge's depth rises to both of its sides, so that the inside of a pipe has none at all.
    """
    known = np.isfinite(depth_m)
    count = known.sum(axis=1)
    rows = count >= max(count.max(initial=0) / 2, 3)
    if not rows.any():
        return False
    columns = np.flatnonzero(known[rows].any(axis=0))
    near = _smoothed(-depth_m[rows, columns[0] : columns[-1] + 1])
    furrow_m = FURROW_SHARE * metre_per_px * float(np.median(count[rows]))
    return bool((_furrows(near) > furrow_m).mean() > SECTIONS_SHARE)


def _smoothed(values: Floats) -> Floats:
    """Local means of the known among values (S, W); NaN where there are none."""
    size = (2 * int(SMOOTHED_SHARE * values.shape[1] / 2) + 1, min(SMOOTHED_ROWS, len(values)))
    known = np.isfinite(values)
    total, share = (
        np.asarray(cv2.blur(part, size, borderType=cv2.BORDER_CONSTANT), dtype=np.float64)
        for part in (np.where(known, values, 0.0), known.astype(np.float64))
    )
    return np.where(share > 0.25, total / np.maximum(share, 1e-9), np.nan)


def _furrows(near: Floats) -> Floats:
    """Depth (S,) of the deepest furrow of every section (S, W), between two peaks whose outer sides fall as far."""
    filled = np.where(np.isfinite(near), near, -np.inf)
    first, last = np.isfinite(near).argmax(axis=1), near.shape[1] - 1 - np.isfinite(near)[:, ::-1].argmax(axis=1)
    number = np.arange(len(near))
    ends = filled[number, first], filled[number, last]
    peaks = np.maximum.accumulate(filled, axis=1), np.maximum.accumulate(filled[:, ::-1], axis=1)[:, ::-1]
    falls = [peak - np.maximum(filled, end[:, None]) for peak, end in zip(peaks, ends, strict=True)]
    return np.nan_to_num(np.minimum(*falls), nan=-np.inf, posinf=-np.inf).max(axis=1)

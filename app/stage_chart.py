"""The chart of one line of pixels at one step of the segmentation: pixel against depth."""

from functools import lru_cache
from typing import Any

import numpy as np

from app.charts import BAND, LIT, MISSING, ODD, PROFILE, USED, dots
from rotrecon.arrays import Floats
from rotrecon.line_stages import Line

STAGE_SERIES: tuple[Any, ...] = (
    {"label": "px across the axis"},
    {"label": "3 sigma", "stroke": BAND, "fill": BAND, "width": 0, "points": {"show": False}},
    {"label": "", "class": "rr-unnamed", "width": 0, "points": {"show": False}},
    {"label": "mean", "stroke": PROFILE, "width": 2, "points": {"show": False}},
    dots("kept", USED, 5),
    dots("taken away", ODD, 6),
    dots("brought back", LIT, 6),
    dots("gone before", MISSING, 3),
)
STAGE_BANDS: tuple[Any, ...] = ({"series": (1, 2), "fill": BAND},)
STAGE_AXES: tuple[Any, ...] = (
    {"size": 34},
    {"label": "depth, mm", "labelSize": 16, "size": 52, "labelFont": "12px sans-serif"},
)
NO_STAGE: tuple[Floats, ...] = tuple(
    np.array([0.0, 1.0]) * scale for scale in (1.0, *[np.nan] * (len(STAGE_SERIES) - 1))
)


@lru_cache(maxsize=4)
def stage_chart(line: Line | None, step: int) -> tuple[Floats, ...]:
    """Columns of the chart: place, px, and depths, mm, NaN where a pixel is not of the series."""
    if line is None or len(line.place_px) < 2:
        return NO_STAGE
    stage = line.stages[min(step, len(line.stages) - 1)]
    depth_mm = 1000 * line.depth_m
    level = np.full(len(depth_mm), np.nan if stage.mean_m is None else 1000 * stage.mean_m)
    reach_mm = np.nan if stage.reach_m is None else 1000 * stage.reach_m
    kept = stage.members & ~stage.added
    gone = ~(stage.members | stage.removed)
    series = [np.where(which, depth_mm, np.nan) for which in (kept, stage.removed, stage.added, gone)]
    return (line.place_px, level + reach_mm, level - reach_mm, level, *series)


def stage_scales(line: Line | None) -> dict[str, Any]:
    """Ranges of the chart's axes, the same at every step."""
    depth_mm = np.array([0.0, 1.0]) if line is None else 1000 * line.depth_m[np.isfinite(line.depth_m)]
    if len(depth_mm) == 0 or line is None:
        return {"x": {"time": False, "range": (0.0, 1.0)}, "y": {"range": (0.0, 1.0)}}
    low, high = float(depth_mm.min()), float(depth_mm.max())
    margin = max(0.06 * (high - low), 1.0)
    ends = (float(line.place_px[0]) - 1, float(line.place_px[-1]) + 1)
    return {"x": {"time": False, "range": ends}, "y": {"range": (low - margin, high + margin)}}


def stage_text(line: Line | None, step: int) -> str:
    """One step in words."""
    if line is None:
        return "No line of pixels: this section has none, or nothing is measured."
    number = min(step, len(line.stages) - 1)
    stage = line.stages[number]
    removed, added, kept = (int(which.sum()) for which in (stage.removed, stage.added, stage.members))
    sum_ = f"{kept + removed - added} " if removed or added else ""
    sum_ += f"\u2212 {removed} taken away " if removed else ""
    sum_ += f"+ {added} brought back " if added else ""
    sum_ += "= " if sum_ else ""
    parts = [f"Step {number + 1} of {len(line.stages)}, {stage.name}: {sum_}{kept} pixels kept"]
    parts += [] if stage.mean_m is None else [f"mean {1000 * stage.mean_m:.1f} mm"]
    parts += [] if stage.reach_m is None else [f"3 sigma {1000 * stage.reach_m:.1f} mm"]
    return ", ".join(parts) + "."

"""The chart of radii along the axis."""

from typing import Any

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.circles import SectionState
from rotrecon.fitting import Fit
from rotrecon.reconstruct import Reconstruction

USED, ODD, EXCLUDED, PROFILE, LIT = "#3c93d0", "#d55e00", "#8a8a8a", "#009e73", "#cc79a7"
"""Okabe and Ito's colours, which the colour-blind tell apart, as light and dark backgrounds allow."""
CHART_HEIGHT_PX = 132


def _dots(label: str, color: str, size_px: float) -> dict[str, Any]:
    points = {"show": True, "size": size_px, "fill": color, "stroke": color}
    return {"label": label, "stroke": color, "width": 0, "points": points}


RADIUS_SERIES: tuple[Any, ...] = (
    {"label": "mm along the axis"},
    {"label": "fitted", "stroke": PROFILE, "width": 2, "points": {"show": False}},
    _dots("used", USED, 4),
    _dots("odd radius", ODD, 4),
    _dots("excluded", EXCLUDED, 5),
    _dots("this section", LIT, 10),
)
RADIUS_AXES: tuple[Any, ...] = (
    {"size": 34},
    {"label": "radius, mm", "labelSize": 16, "size": 48, "labelFont": "12px sans-serif"},
)
NO_CHART: tuple[Floats, ...] = tuple(np.array([0.0, 1.0]) * scale for scale in (1.0, *[np.nan] * 5))


def section_count(result: Reconstruction | None) -> int:
    """How many sections there are to look at."""
    return 0 if result is None or result.second_cut is None else len(result.second_cut.circles.state)


def radius_chart(result: Reconstruction | None, section: int) -> tuple[Floats, ...]:
    """Columns of the chart: position and radius, mm, NaN where a section is not of the series."""
    if result is None or result.second_cut is None or not isinstance(result.fit, Fit):
        return NO_CHART
    radius_mm, along_mm = 1000 * result.second_cut.circles.radius_m, 1000 * result.fit.along_m
    order = np.argsort(along_mm)
    order = order[np.isfinite(along_mm[order])]
    if len(order) < 2:
        return NO_CHART
    state = result.fit.section_state
    fitted_mm = 1000 * result.fit.solid.radius_at(result.fit.along_m)
    shown = [SectionState.USED, SectionState.ODD_RADIUS, SectionState.EXCLUDED]
    columns = [along_mm, fitted_mm, *(np.where(state == kind, radius_mm, np.nan) for kind in shown)]
    columns.append(np.where(np.arange(len(state)) == section, radius_mm, np.nan))
    return tuple(column[order] for column in columns)


def radius_scales(chart: tuple[Floats, ...]) -> dict[str, Any]:
    """Ranges that hold everything, with a margin; the radius never magnified so far that noise looks like shape."""
    radii = np.concatenate(chart[1:5])
    radii = radii[np.isfinite(radii)]
    if len(radii) == 0:
        return {"x": {"time": False}, "y": {"range": (0.0, 1.0)}}
    low, high = np.percentile(radii, [2, 98])
    margin = max(0.6 * (high - low), 0.1 * high, 1.0)
    return {"x": {"time": False}, "y": {"range": (max(0.0, float(low - margin)), float(high + margin))}}

"""The chart of radii along the axis."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from app.answers import answer_of
from rotrecon.arrays import Floats
from rotrecon.circles import SectionState
from rotrecon.outcome import Fit
from rotrecon.reconstruction import Reconstruction

USED, ODD, EXCLUDED, PROFILE, MISSING, LIT = "#3c93d0", "#d55e00", "#8a8a8a", "#009e73", "#e69f00", "#cc79a7"
"""Okabe and Ito's colours, which the colour-blind tell apart, as light and dark backgrounds allow."""
BAND = "rgba(0, 158, 115, 0.3)"
"""The same green, for the interval round the fitted line."""
CHART_HEIGHT_PX = 132
BOTTOM = 0.04
"""How far up the chart sections without a radius stand: high enough to be seen whole."""


def dots(label: str, color: str, size_px: float) -> dict[str, Any]:
    points = {"show": True, "size": size_px, "fill": color, "stroke": color}
    return {"label": label, "stroke": color, "width": 0, "points": points}


RADIUS_SERIES: tuple[Any, ...] = (
    {"label": "mm along the axis"},
    {"label": "95 %", "stroke": BAND, "fill": BAND, "width": 0, "points": {"show": False}},
    {"label": "", "class": "rr-unnamed", "width": 0, "points": {"show": False}},
    {"label": "fitted", "stroke": PROFILE, "width": 2, "points": {"show": False}},
    dots("used", USED, 4),
    dots("odd radius", ODD, 4),
    dots("excluded", EXCLUDED, 5),
    dots("no radius", MISSING, 4),
    dots("chosen", LIT, 10),
)
RADIUS_BANDS: tuple[Any, ...] = ({"series": (1, 2), "fill": BAND},)
RADIUS_AXES: tuple[Any, ...] = (
    {"size": 34},
    {"label": "radius, mm", "labelSize": 16, "size": 48, "labelFont": "12px sans-serif"},
)
NO_CHART: tuple[Floats, ...] = tuple(
    np.array([0.0, 1.0]) * scale for scale in (1.0, *[np.nan] * (len(RADIUS_SERIES) - 1))
)


def section_count(result: Reconstruction | None) -> int:
    """How many sections there are to look at."""
    return 0 if result is None or result.second_cut is None else len(result.second_cut.circles.state)


@lru_cache(maxsize=4)
def radius_chart(result: Reconstruction | None, section: int) -> tuple[Floats, ...]:
    """Columns of the chart: position and radius, mm, NaN where a section is not of the series.

    Sections without a radius stand in a row at the bottom.
    """
    if result is None or result.second_cut is None or result.sections is None:
        return NO_CHART
    circles, fit = result.second_cut.circles, result.fit
    even_m = _evenly(fit.along_m if isinstance(fit, Fit) else result.sections.axis.along(circles.points_m[:, 1]))
    along_m = np.where(np.isfinite(fit.along_m), fit.along_m, even_m) if isinstance(fit, Fit) else even_m
    along_mm, radius_mm = 1000 * along_m, 1000 * circles.radius_m
    order = np.argsort(along_mm)
    if len(order) < 2 or not np.isfinite(along_mm).all():
        return NO_CHART
    state = fit.section_state if isinstance(fit, Fit) else circles.state
    fitted_mm = 1000 * fit.solid.radius_at(along_mm / 1000) if isinstance(fit, Fit) else np.full(len(state), np.nan)
    shown = [SectionState.USED, SectionState.ODD_RADIUS, SectionState.EXCLUDED]
    columns = [
        along_mm,
        *_interval(result, along_mm),
        fitted_mm,
        *(np.where(state == kind, radius_mm, np.nan) for kind in shown),
    ]
    low, high = _radius_range(columns)
    missing = np.where(np.isfinite(radius_mm), np.nan, low + BOTTOM * (high - low))
    lit = np.where(np.isfinite(radius_mm), radius_mm, missing)
    columns += [missing, np.where(np.arange(len(state)) == section, lit, np.nan)]
    return tuple(column[order] for column in columns)


def _interval(result: Reconstruction, along_mm: Floats) -> tuple[Floats, Floats]:
    """Highest and lowest radius (S,), mm, of the 95 % interval at positions along the axis; NaN where none is known."""
    known = [row for row in answer_of(result)["profile"] if None not in row]
    if not known:
        return np.full(len(along_mm), np.nan), np.full(len(along_mm), np.nan)
    at_mm, _, low_mm, high_mm = np.array(sorted(known)).T
    return np.interp(along_mm, at_mm, high_mm / 2), np.interp(along_mm, at_mm, low_mm / 2)


def _evenly(along_m: Floats) -> Floats:
    """Positions (S,) on the line through those that are known, as sections lie evenly; NaN if there is none."""
    number, known = np.arange(len(along_m)), np.isfinite(along_m)
    if known.sum() < 2:
        return np.full(len(along_m), np.nan)
    return np.asarray(np.polyval(np.polyfit(number[known], along_m[known], 1), number), dtype=np.float64)


def radius_scales(chart: tuple[Floats, ...]) -> dict[str, Any]:
    """Ranges of the chart's axes; both are said, as the page now and then keeps a sliver of an earlier chart's."""
    low, high = float(chart[0].min()), float(chart[0].max())
    margin = 0.02 * (high - low)
    return {"x": {"time": False, "range": (low - margin, high + margin)}, "y": {"range": _radius_range(chart)}}


def _radius_range(columns: Sequence[Floats]) -> tuple[float, float]:
    """What holds all radii, with a margin; never magnified so far that noise looks like shape."""
    radii = np.concatenate(columns[1:7])
    radii = radii[np.isfinite(radii)]
    if len(radii) == 0:
        return (0.0, 1.0)
    low, high = np.percentile(radii, [2, 98])
    margin = max(0.6 * (high - low), 0.1 * high, 1.0)
    return (max(0.0, float(low - margin)), float(high + margin))

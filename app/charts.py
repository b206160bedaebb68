"""The charts: radius along the axis as a uPlot, and one section in its own plane as a drawing."""

from typing import Any

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.circles import SectionState
from rotrecon.fitting import Fit
from rotrecon.reconstruct import Reconstruction

USED, ODD, EXCLUDED, PROFILE, LIT = "#3c93d0", "#d55e00", "#8a8a8a", "#009e73", "#cc79a7"
"""Okabe and Ito's colours, which the colour-blind tell apart, as light and dark backgrounds allow."""
STATE_TEXT = {
    SectionState.USED: "used",
    SectionState.EMPTY: "dropped: no pixel segmented",
    SectionState.TOO_FEW_PIXELS: "dropped: too few pixels",
    SectionState.COLLINEAR: "dropped: its points are on a line",
    SectionState.EXCLUDED: "excluded by hand",
    SectionState.ODD_RADIUS: "dropped: odd radius",
}
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


def section_text(result: Reconstruction | None, section: int) -> str:
    """One section in words."""
    count = section_count(result)
    if result is None or result.second_cut is None or section >= count:
        return "No sections yet."
    state = result.fit.section_state if isinstance(result.fit, Fit) else result.second_cut.circles.state
    radius_mm = 1000 * float(result.second_cut.circles.radius_m[section])
    radius = f", radius {radius_mm:.1f} mm" if np.isfinite(radius_mm) else ""
    return f"Section {section + 1} of {count}{radius}, {STATE_TEXT[SectionState(state[section])]}"


def section_svg(result: Reconstruction | None, section: int) -> str:
    """One section in its own plane: its points, the circle, and the points S, C and F it goes through."""
    if result is None or result.sections is None or result.second_cut is None or section >= section_count(result):
        return ""
    sections, circles = result.sections, result.second_cut.circles

    def in_plane_mm(points_m: Floats) -> Floats:
        offset = points_m - sections.axis.point_m
        return 1000 * np.stack([offset @ sections.across, -(offset @ sections.toward_camera)], axis=-1)

    points = 1000 * sections.in_plane(section) * [1, -1]
    base, center = in_plane_mm(circles.points_m[section]), in_plane_mm(circles.center_m[section])
    radius = 1000 * float(circles.radius_m[section])
    if len(points) == 0:
        return ""
    low, high = points.min(axis=0), points.max(axis=0)
    dot = max(float((high - low).max()), 1.0) / 110
    x, y = low - np.array([6, 12]) * dot
    width, height = high - low + np.array([12, 18]) * dot
    shapes = [_circle(u, v, dot, f'fill="{USED}" fill-opacity="0.75"') for u, v in points[:: len(points) // 400 + 1]]
    if np.isfinite(radius):
        shapes.append(
            _circle(center[0], center[1], radius, f'fill="none" stroke="{PROFILE}" stroke-width="{dot * 0.8:.3f}"')
        )
        shapes.append(_circle(center[0], center[1], dot, f'fill="{PROFILE}"'))
    for name, (u, v) in zip("SCF", base, strict=True):
        if np.isfinite(u):
            shapes.append(_circle(u, v, dot * 1.8, f'fill="{LIT}"'))
            shapes.append(
                f'<text x="{u:.3f}" y="{v - 2.8 * dot:.3f}" font-size="{7 * dot:.3f}" text-anchor="middle" '
                f'fill="currentColor">{name}</text>'
            )
    return f'<svg class="rr-section" viewBox="{x:.3f} {y:.3f} {width:.3f} {height:.3f}">{"".join(shapes)}</svg>'


def _circle(u: float, v: float, radius: float, style: str) -> str:
    return f'<circle cx="{u:.3f}" cy="{v:.3f}" r="{radius:.3f}" {style}/>'

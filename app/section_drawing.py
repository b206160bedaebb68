"""One section in words, and drawn in its own plane."""

from functools import lru_cache

import numpy as np

from app.charts import LIT, ODD, PROFILE, USED, section_count
from app.wording import measured
from rotrecon.arrays import Floats
from rotrecon.circles import SectionState
from rotrecon.outcome import Fit
from rotrecon.overlay import first_cut_line
from rotrecon.reconstruction import Reconstruction

STATE_TEXT = {
    SectionState.USED: "used",
    SectionState.EMPTY: "dropped: no pixel segmented",
    SectionState.TOO_FEW_PIXELS: "dropped: too few pixels",
    SectionState.COLLINEAR: "dropped: its points are on a line",
    SectionState.EXCLUDED: "excluded by hand",
    SectionState.ODD_RADIUS: "dropped: odd radius",
}
MOST_DOTS = 300
"""Points of a section that are drawn: more would lie on each other."""


def section_text(result: Reconstruction | None, section: int) -> str:
    """One section in words."""
    count = section_count(result)
    if result is None:
        return "No sections yet."
    if result.second_cut is None or section >= count:
        return f"No sections: {_why_none(result)} to cut the object across."
    state = result.fit.section_state if isinstance(result.fit, Fit) else result.second_cut.circles.state
    radius_mm = 1000 * float(result.second_cut.circles.radius_m[section])
    place = f"Section {section + 1} of {count}, {STATE_TEXT[SectionState(state[section])]}"
    if not np.isfinite(radius_mm) or result.sections is None:
        return place
    residuals_mm = 1000 * result.sections.residuals_m(section, result.second_cut.circles)
    off_mm = float(np.sqrt(np.mean(residuals_mm**2)))
    radius = measured(radius_mm, radius_interval_mm(result, section), " mm")
    return f"{place}. Radius {radius}; its {len(residuals_mm)} pixels lie {off_mm:.2f} mm off (RMS)."


def _why_none(result: Reconstruction) -> str:
    by_paper = result.settings.method == "paper"
    return "the lines of pixels gave no axis" if by_paper else "nothing round was found"


def line_text(result: Reconstruction | None, section: int) -> str:
    """What each step of paper 3.2 did on the line of pixels that a section was made of; nothing if it has none.

    A sum from the pixels with depth to those that are kept. The section itself is cut anew across the axis that was
    found, and holds other pixels.
    """
    row = None if result is None or section >= section_count(result) else first_cut_line(result, section)
    if result is None or row is None:
        return ""
    segmentation = result.segmentation
    mean_mm, sigma_mm = 1000 * segmentation.mean_m[-1, row], 1000 * segmentation.sigma_m[-1, row]
    counts, inside = segmentation.counts(row), int(result.segments.inside[row].sum())
    known, kept = (counts.pop(step) for step in ("with depth", "kept"))
    signs = {step: "+" if step == "grown back" else "\u2212" for step in counts}
    steps = "".join(f" {signs[step]} {count} {step}" for step, count in counts.items() if count)
    return (
        f"On its line across the stroke, of {inside} pixels in the area: {known} with usable depth{steps} = {kept} kept"
        f"; mean depth {mean_mm:.1f} mm, sigma {sigma_mm:.1f} mm."
    )


@lru_cache(maxsize=4)
def section_svg(result: Reconstruction | None, section: int) -> str:
    """One section in its own plane: its points, its circle, and how far they lie off it; the paper's S, C and F."""
    if result is None or result.sections is None or result.second_cut is None or section >= section_count(result):
        return ""
    sections, circles = result.sections, result.second_cut.circles
    on_paper = np.array([1000.0, -1000.0])
    points, base, center = (
        on_paper * sections.in_plane(points_m)
        for points_m in (sections.points_in(section), circles.points_m[section], circles.center_m[section])
    )
    if len(points) == 0:
        return ""
    low, high = points.min(axis=0), points.max(axis=0)
    dot = max(float((high - low).max()), 1.0) / 110
    corner, size = low - np.array([6, 12]) * dot, high - low + np.array([12, 18]) * dot
    drawn = points[:: len(points) // MOST_DOTS + 1]
    radius = 1000 * float(circles.radius_m[section])
    shapes = (
        _interval(result, section, center) + _fitted_circle(center, radius, drawn, dot) if np.isfinite(radius) else []
    )
    shapes += [_circle(u, v, 0.8 * dot, f'fill="{USED}"') for u, v in drawn]
    for name, (u, v) in zip("SCF", base, strict=True) if result.settings.method == "paper" else ():
        if np.isfinite(u):
            shapes += [_circle(u, v, 1.8 * dot, f'fill="{LIT}"'), _label(name, u, v - 2.8 * dot, 7 * dot)]
    box = " ".join(f"{value:.3f}" for value in (*corner, *size))
    return f'<svg class="rr-section" viewBox="{box}">{"".join(shapes)}</svg>'


def radius_interval_mm(result: Reconstruction, section: int) -> tuple[float, float] | None:
    """The 95 % interval of a section's own radius; None where there is none."""
    if not isinstance(result.fit, Fit) or result.fit.evidence is None:
        return None
    low, high = (
        1000 * float(of[section]) for of in (result.fit.evidence.radius_low_m, result.fit.evidence.radius_high_m)
    )
    return (low, high) if np.isfinite([low, high]).all() else None


def _interval(result: Reconstruction, section: int, center: Floats) -> list[str]:
    """The ring that holds the circle in 95 of 100 cases."""
    interval = radius_interval_mm(result, section)
    if interval is None:
        return []
    low, high = interval
    style = f'fill="none" stroke="{PROFILE}" stroke-opacity="0.3" stroke-width="{high - low:.3f}"'
    return [_circle(center[0], center[1], (low + high) / 2, style)]


def _fitted_circle(center: Floats, radius: float, points: Floats, dot: float) -> list[str]:
    """The circle, its centre, and a line from it to each of the points (n, 2)."""
    outward = points - center
    feet = center + radius * outward / np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-9)
    lines = "".join(f"M{u:.3f} {v:.3f}L{x:.3f} {y:.3f}" for (u, v), (x, y) in zip(points, feet, strict=True))
    return [
        _circle(center[0], center[1], radius, f'fill="none" stroke="{PROFILE}" stroke-width="{0.8 * dot:.3f}"'),
        _circle(center[0], center[1], dot, f'fill="{PROFILE}"'),
        f'<path d="{lines}" stroke="{ODD}" stroke-width="{0.5 * dot:.3f}"/>',
    ]


def _circle(u: float, v: float, radius: float, style: str) -> str:
    return f'<circle cx="{u:.3f}" cy="{v:.3f}" r="{radius:.3f}" {style}/>'


def _label(text: str, u: float, v: float, size: float) -> str:
    place = f'x="{u:.3f}" y="{v:.3f}" font-size="{size:.3f}"'
    return f'<text {place} text-anchor="middle" fill="currentColor">{text}</text>'

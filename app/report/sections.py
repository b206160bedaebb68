"""The sections of a measurement, one line each."""

import csv
from io import StringIO

import numpy as np

from rotrecon.axis import SpaceSections
from rotrecon.camera import transform
from rotrecon.circles import SectionCircles, SectionState
from rotrecon.outcome import Fit
from rotrecon.reconstruction import Reconstruction

COLUMNS = [
    "section", "state", "along_mm", "radius_mm", "radius_low_mm", "radius_high_mm", "arc_deg", "pixels", "rms_mm",
    "center_x_m", "center_y_m", "center_z_m",
]  # fmt: skip
"""Sections count from 1 as on the page; along is from the solid's middle; centres in base coordinates."""


def sections_csv(result: Reconstruction, sections: SpaceSections, circles: SectionCircles) -> bytes:
    """CSV with a line of names; empty where a section has no such number."""
    fit = result.fit
    count = len(circles.state)
    unknown = np.full(count, np.nan)
    is_fit = isinstance(fit, Fit)
    evidence = fit.evidence if is_fit else None
    state = fit.section_state if is_fit else circles.state
    centers_m = transform(result.frame.T_base_camera, circles.center_m)
    numbers = np.column_stack(
        [
            1000 * (fit.along_m if is_fit else unknown),
            1000 * circles.radius_m,
            1000 * (evidence.radius_low_m if evidence else unknown),
            1000 * (evidence.radius_high_m if evidence else unknown),
            np.degrees(circles.arc_rad),
            np.diff(sections.start),
            [1000 * _rms_m(sections, circles, section) for section in range(count)],
            centers_m,
        ]
    )
    text = StringIO()
    lines = csv.writer(text)
    lines.writerow(COLUMNS)
    for number, row in enumerate(numbers):
        lines.writerow([number + 1, SectionState(state[number]).name.lower(), *map(_cell, row)])
    return text.getvalue().encode()


def _rms_m(sections: SpaceSections, circles: SectionCircles, section: int) -> float:
    """How far the points of a section lie off its circle; NaN where it has none."""
    if not np.isfinite(circles.radius_m[section]) or len(sections.pixels_in(section)) == 0:
        return np.nan
    return float(np.sqrt(np.mean(sections.residuals_m(section, circles) ** 2)))


def _cell(number: float) -> str:
    """Six decimals are a nanometre of what is in millimetres, a micrometre of what is in metres."""
    return f"{number:.6f}".rstrip("0").rstrip(".") if np.isfinite(number) else ""

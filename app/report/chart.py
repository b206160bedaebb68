"""The radii along the axis as a picture of lines, which a file can hold."""

from math import floor, log10

import numpy as np

from app.charts import EXCLUDED, MISSING, NO_CHART, ODD, PROFILE, USED, radius_chart, radius_scales
from rotrecon.arrays import Floats
from rotrecon.reconstruction import Reconstruction

WIDTH, HEIGHT = 720.0, 260.0
LEFT, RIGHT, TOP, BOTTOM = 52.0, 8.0, 8.0, 36.0
"""Margins, for what is written beside the axes."""
TICKS = 6
"""About so many on each axis."""
NO_SECTION = -1
SERIES = ((4, USED, "used"), (5, ODD, "odd radius"), (6, EXCLUDED, "excluded"), (7, MISSING, "no radius"))
"""Columns of the chart that are dots, with colour and name."""


def sections_svg(result: Reconstruction) -> str:
    """Radius of every section against its place along the axis, the fitted line and its interval; empty without any."""
    chart = radius_chart(result, NO_SECTION)
    if chart is NO_CHART:
        return ""
    scales = radius_scales(chart)
    x_range, y_range = scales["x"]["range"], scales["y"]["range"]

    def at(along: Floats, radius: Floats) -> Floats:
        """Places (n, 2) on the picture; what is beyond the scale lies on its border."""
        x = LEFT + (along - x_range[0]) / (x_range[1] - x_range[0]) * (WIDTH - LEFT - RIGHT)
        share = np.clip((radius - y_range[0]) / (y_range[1] - y_range[0]), 0, 1)
        return np.stack([x, HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM)], axis=1)

    along, high, low, fitted = chart[:4]
    shapes = [_ticks(x_range, y_range, at)]
    known = np.isfinite(high) & np.isfinite(low)
    if known.any():
        band = np.concatenate([at(along[known], high[known]), at(along[known], low[known])[::-1]])
        shapes.append(f'<polygon points="{_points(band)}" fill="{PROFILE}" fill-opacity="0.25"/>')
    if np.isfinite(fitted).all():
        line = _points(at(along, fitted))
        shapes.append(f'<polyline points="{line}" fill="none" stroke="{PROFILE}" stroke-width="2"/>')
    for column, color, name in SERIES:
        there = np.isfinite(chart[column])
        dots = "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2"/>' for x, y in at(along[there], chart[column][there]))
        shapes.append(f'<g fill="{color}"><title>{name}</title>{dots}</g>')
    return (
        f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="radius along the axis">{"".join(shapes)}</svg>'
    )


def _ticks(x_range: tuple[float, float], y_range: tuple[float, float], at) -> str:
    """Lines with numbers across the picture, and what they are of."""
    pieces: list[str] = []
    for value in _round_numbers(*y_range):
        ((_, y),) = at(np.array([x_range[0]]), np.array([value]))
        pieces.append(f'<path d="M{LEFT:g} {y:.1f}H{WIDTH - RIGHT:g}"/>')
        pieces.append(f'<text x="{LEFT - 6:g}" y="{y + 4:.1f}" text-anchor="end">{value:g}</text>')
    for value in _round_numbers(*x_range):
        ((x, y),) = at(np.array([value]), np.array([y_range[0]]))
        pieces.append(f'<path d="M{x:.1f} {TOP:g}V{y:.1f}"/>')
        pieces.append(f'<text x="{x:.1f}" y="{y + 15:.1f}" text-anchor="middle">{value:g}</text>')
    middle = (HEIGHT - BOTTOM + TOP) / 2
    pieces.append(f'<text x="{(WIDTH + LEFT) / 2:g}" y="{HEIGHT - 4:g}" text-anchor="middle">mm along the axis</text>')
    turned = f'transform="translate(14 {middle:g}) rotate(-90)"'
    pieces.append(f'<text {turned} text-anchor="middle">radius, mm</text>')
    return f'<g class="ticks">{"".join(pieces)}</g>'


def _round_numbers(low: float, high: float) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten between two numbers."""
    rough = (high - low) / TICKS
    power = 10.0 ** floor(log10(rough))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= rough)
    return [float(round(number * step, 9)) for number in np.arange(np.ceil(low / step), np.floor(high / step) + 1)]


def _points(places: Floats) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in places)

"""Where a stroke begins and ends: on the side of an object, not on a cap that is seen."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.stroke.planes import least_squares

SPAN = (0.02, 0.98)
"""Quantiles of pixels that count as an object's ends: what hangs off it is less."""
INSET = 0.08
"""Share of the length that a stroke ends before each end, where outlines are smeared and feet meet the table."""
BINS = 40
"""Pieces of the line over the surface: a corner between cap and side is found to 2.5 % of the length."""
FEWEST_BINS = 3
"""A cap seen over fewer is not told from a smeared edge, and does no harm."""
CORNER_RAD = float(np.deg2rad(60.0))
"""Least turn of the surface at a cap's edge: 90 degrees less the half angle of a cone."""
SHARPER = 10.0
"""Times the squares that two lines must leave less than a parabola: round ends, as a ball's, are parabolas."""
SHORT_SHARE = 0.25
"""Share of the length up to which the shorter part is the cap; of longer parts it is the one that is flatter across."""


@dataclass(frozen=True, eq=False)
class Strip:
    """The object's pixels near a stroke."""

    along: Floats
    """(n,) px from the stroke's middle."""
    across: Floats
    """(n,) px beside it."""
    inverse_depth: Floats
    """(n,) 1/m."""
    middle_px: Floats
    """(2,) place in the frame where both are 0."""
    direction: Floats
    """(2,) unit, in the frame."""

    def __post_init__(self) -> None:
        freeze(self)


def side_of(strip: Strip, camera: PinholeCamera) -> tuple[float, float]:
    """Where along a strip the side of the object begins and ends, px, a little inset: without a cap that is seen.

    Straight in space is straight in inverse depth: cap and side of a cylinder or cone are two lines there.
    """
    low, high = (float(end) for end in np.quantile(strip.along, SPAN))
    corner = _corner(strip, low, high, camera)
    if corner is not None:
        low, high = (low, corner) if _cap_is_last(strip, low, corner, high) else (corner, high)
    inset = INSET * (high - low)
    return low + inset, high - inset


def _corner(strip: Strip, low: float, high: float, camera: PinholeCamera) -> float | None:
    """Where a cap meets the side; None where there is none."""
    edges = np.linspace(low, high, BINS + 1)
    number = np.digitize(strip.along, edges) - 1
    filled = [piece for piece in range(BINS) if (number == piece).any()]
    if len(filled) < 4 * FEWEST_BINS:
        return None
    along = (edges[:-1] + edges[1:])[filled] / 2
    height = np.array([np.median(strip.inverse_depth[number == piece]) for piece in filled])
    splits = range(FEWEST_BINS, len(along) - FEWEST_BINS + 1)
    left = [_line(along[:split], height[:split]) for split in splits]
    right = [_line(along[split:], height[split:]) for split in splits]
    squares = [one[1] + other[1] for one, other in zip(left, right, strict=True)]
    best = int(np.argmin(squares))
    parabola = np.column_stack([np.ones(len(along)), along, along**2])
    if SHARPER * squares[best] > _fitted(parabola, height)[1]:
        return None
    split = splits[best]
    first = _in_space(strip, along[:split], left[best][0], camera)
    second = _in_space(strip, along[split:], right[best][0], camera)
    turned = float(first @ second) < np.cos(CORNER_RAD)
    return float(along[split - 1] + along[split]) / 2 if turned else None


def _cap_is_last(strip: Strip, low: float, corner: float, high: float) -> bool:
    """Which of the parts before and after a corner is the cap."""
    share = (corner - low) / (high - low)
    if not SHORT_SHARE < share < 1 - SHORT_SHARE:
        return share > 0.5
    before = strip.along < corner
    return _bend(strip, before) > _bend(strip, ~before)


def _bend(strip: Strip, members: Bools) -> float:
    """Magnitude of the second derivative of inverse depth across the stroke, over some of its pixels."""
    along, across = strip.along[members], strip.across[members]
    terms = np.column_stack([np.ones(len(along)), along, across, across**2])
    return abs(float(least_squares(terms, strip.inverse_depth[members])[3]))


def _line(along: Floats, height: Floats) -> tuple[Floats, float]:
    """Coefficients (2,) of a line, and the sum of squares that it leaves."""
    return _fitted(np.column_stack([np.ones(len(along)), along]), height)


def _fitted(terms: Floats, values: Floats) -> tuple[Floats, float]:
    """Coefficients of least squares, and the sum of squares that they leave."""
    solution = least_squares(terms, values)
    return solution, float(np.square(terms @ solution - values).sum())


def _in_space(strip: Strip, along: Floats, line: Floats, camera: PinholeCamera) -> Floats:
    """Unit direction (3,) in which a line of inverse depth goes between its first and its last place."""
    ends = along[[0, -1]]
    points_m = camera.unproject(strip.middle_px + ends[:, None] * strip.direction, 1 / (line[0] + line[1] * ends))
    direction = points_m[1] - points_m[0]
    return direction / np.linalg.norm(direction)

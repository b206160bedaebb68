"""One circle through the first, the middle and the last point of every section (paper 3.3)."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from rotrecon.arrays import Bools, Bytes, Cloud, Floats, Indices, freeze
from rotrecon.settings import Settings


class SectionState(IntEnum):
    """Whether a section counts, and if not, why."""

    USED = 0
    EMPTY = 1
    """No pixel of it was segmented."""
    TOO_FEW_PIXELS = 2
    COLLINEAR = 3
    """First, middle and last point lie on a line."""
    EXCLUDED = 4
    """Taken out by the operator."""
    ODD_RADIUS = 5
    """Its radius deviates by more than the mean deviation, paper (14)."""


@dataclass(frozen=True, eq=False)
class SectionCircles:
    """A circle for each of S sections, NaN where there is none; camera coordinates."""

    state: Bytes
    """(S,) SectionState."""
    center_m: Floats
    """(S, 3)"""
    radius_m: Floats
    """(S,)"""
    points_m: Floats
    """(S, 3, 3) the three points S, C and F."""
    arc_rad: Floats
    """(S,) angle from S to F round the centre: the visible arc."""
    concave: Bools
    """(S,) the middle point lies behind the centre: the surface is seen from inside."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def used(self) -> Bools:
        """(S,) which sections count."""
        return self.state == SectionState.USED


def base_points(points_m: Cloud, pixel: Indices, kept: Bools) -> tuple[Floats, Indices]:
    """First, middle and last segmented point (S, 3, 3) of each section of pixels, and how many there are (S,).

    `points_m` (H, W, 3) is the organised cloud, `pixel` and `kept` (S, W). NaN where a section has no pixel.
    """
    count = kept.sum(axis=1, dtype=np.int32)
    first = kept.argmax(axis=1)
    last = kept.shape[1] - 1 - kept[:, ::-1].argmax(axis=1)
    rank = kept.cumsum(axis=1, dtype=np.min_scalar_type(-kept.shape[1]))
    middle = (rank > (count[:, None] - 1) // 2).argmax(axis=1)
    column = np.stack([first, middle, last], axis=1)
    chosen = np.take_along_axis(pixel, column, axis=1)
    points = points_m.reshape(-1, 3)[np.maximum(chosen, 0)].astype(np.float64)
    points[count == 0] = np.nan
    return points, count


def circumcircles(points_m: Floats, count: Indices, settings: Settings) -> SectionCircles:
    """Circles through three points (S, 3, 3) of sections that have `count` (S,) pixels; equations (7) to (9).

    The centre is where the plane SCF meets the planes that halve SC and CF at right angles, solved in closed form.
    """
    start, middle, end = points_m[:, 0], points_m[:, 1], points_m[:, 2]
    to_start, to_middle = start - end, middle - end
    normal = np.cross(to_start, to_middle)
    chord2 = (to_start**2).sum(axis=1)
    twice_area = np.linalg.norm(normal, axis=1)
    state = np.full(len(points_m), SectionState.USED, dtype=np.uint8)
    state[~(twice_area > settings.minimum_bulge * chord2)] = SectionState.COLLINEAR
    state[count < settings.minimum_section_pixels] = SectionState.TOO_FEW_PIXELS
    state[count == 0] = SectionState.EMPTY
    scale = np.where(state == SectionState.USED, 2 * twice_area**2, np.nan)[:, None]
    lever = chord2[:, None] * to_middle - (to_middle**2).sum(axis=1)[:, None] * to_start
    center = end + np.cross(lever, normal) / scale
    radius = np.linalg.norm(center - start, axis=1)
    outward = (middle - center) / radius[:, None]
    to_chord = (start + end) / 2 - center
    before_chord = np.copysign(np.linalg.norm(to_chord, axis=1), (to_chord * outward).sum(axis=1))
    half_arc = np.arctan2(np.sqrt(chord2) / 2, before_chord)
    concave = (outward * middle).sum(axis=1) > 0
    return SectionCircles(state, center, radius, points_m, 2 * half_arc, concave)

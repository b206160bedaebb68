"""The stroke along an object, proposed by the program where only an area was drawn."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.outcome import FailureReason, FitFailure
from rotrecon.settings import Settings
from rotrecon.stroke.foreground import FEWEST_PIXELS, Foreground, find_foreground, places_of
from rotrecon.stroke.hollow import straight_line
from rotrecon.stroke.mirror import Mirror
from rotrecon.stroke.planes import least_squares
from rotrecon.stroke.stroke_ends import SPAN, Strip, side_of

LEAST_SHARE = 0.015
"""Of an area: an object covers it, ripples of a table and specks do not; a wire in an area twice too large has 0.03."""
MEASURES = 1000
"""Pixels that say how long and wide an object is: to a percent."""
STRAIGHT, LONG = 0.5, 0.5
"""What a stroke across the curved or the short side costs: as much as half of the pixels not being symmetric."""
HOLLOW_BEND = 0.5
"""Largest bend along a straight hollow surface over that across it."""
TURN_RAD, SHIFT = float(np.deg2rad(5.0)), 0.05
TURNS_RAD: Floats = TURN_RAD * np.arange(36.0)
"""Directions first tried, off the long side's: without that one long things would be met at none."""
SHIFTS: Floats = SHIFT * np.array([0.0, -1.0, 1.0, -2.0, 2.0])
"""Places first tried, in widths beside the middle; where nothing speaks for another, the middle is taken."""
NEARBY = np.array([0.0, -0.5, 0.5, -1.0, 1.0])
"""Turns and shifts tried round the best, in steps that are halved every time."""
HALVINGS = 4
"""From 5 degrees and 5 % of the width to a third of a degree and 0.3 %."""
MIDDLE_SHARE = 0.15
"""Share of the width, to each side of the stroke, in which its ends are looked for."""


def propose_axis(frame: Frame, area: AreaOfInterest, settings: Settings) -> ObjectAxis | FitFailure:
    """The stroke along the nearest thing in an area, downward or to the right; refused where nothing stands out.

    Raises DrawingError for an area that cannot be used on this frame. The stroke is the line about which the surface
    is most like its mirror image (see `mirror`); the middle of a cylinder is such a line across it too, so that one
    along the straight and the long side is preferred.
    """
    found = find_foreground(frame, area)
    if isinstance(found, FitFailure):
        return found
    if found.mask.sum() < max(FEWEST_PIXELS, LEAST_SHARE * found.patch.inside.sum()):
        advice = (
            "nothing in the area stands out from what is behind it; draw the area round the object, "
            "or if it is in it, its axis by hand"
        )
        return FitFailure(FailureReason.FLAT, advice)
    start, end = _ends(found, *_axis_line(found, frame.camera), frame.camera)
    length_px = float(np.linalg.norm(end - start))
    if length_px < settings.minimum_axis_px:
        advice = f"what stands out in the area is only {length_px:.0f} px long; draw the axis by hand or come nearer"
        return FitFailure(FailureReason.NO_AXIS, advice)
    # to a tenth of a pixel, so that the stroke is the same when it is told and given back
    (u0, v0), (u1, v1) = np.round([start, end], 1).tolist()
    return ObjectAxis((u0, v0), (u1, v1))


@dataclass(frozen=True, eq=False)
class _Shape:
    """An object's outline and curvature, in pixels of the frame."""

    pixels: Floats
    """(n, 2) some of its pixels, from their middle."""
    middle_px: Floats
    """(2,) in the frame."""
    curvature: Floats
    """(2, 2) second derivatives of inverse depth."""
    relief: float
    """How far off the plane through all of its pixels half of them lie, in inverse depth, 1/m."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def long_side_rad(self) -> float:
        """Direction in which the object spreads most."""
        along = np.linalg.eigh(np.cov(self.pixels.T))[1][:, 1]
        return float(np.arctan2(along[1], along[0]))

    @property
    def straight_and_hollow(self) -> bool:
        """Whether it is seen from inside, as a pipe that one looks into."""
        bend = np.linalg.eigvalsh(self.curvature)
        return bool(bend[1] > 0 and abs(bend[0]) < HOLLOW_BEND * bend[1])

    def span(self, directions: Floats) -> tuple[Floats, Floats]:
        """Lowest and highest place (k,) of the object along directions (k, 2), px from its middle."""
        low, high = np.quantile(directions @ self.pixels.T, SPAN, axis=1)
        return low, high

    def bend(self, along: Floats) -> Floats:
        """Share (k,) of the curvature that is along directions (k, 2), not across them."""
        lengthwise, crosswise = (
            np.abs(np.einsum("ki,ij,kj->k", way, self.curvature, way)) for way in (along, _across(along))
        )
        return lengthwise / np.maximum(lengthwise + crosswise, np.finfo(float).tiny)


def _shape(found: Foreground) -> _Shape:
    """Its curvature is that of the quadric of least squares through the object's inverse depth."""
    pixels = found.patch.frame_px(places_of(found.mask))
    middle_px = pixels.mean(axis=0)
    pixels = pixels - middle_px
    x, y = pixels.T
    terms = np.column_stack([np.ones(len(x)), x, y, x * x / 2, x * y, y * y / 2])
    inverse_depth = found.patch.inverse_depth[found.mask]
    xx, xy, yy = least_squares(terms, inverse_depth)[3:]
    low, high = np.quantile(inverse_depth - terms[:, :3] @ least_squares(terms[:, :3], inverse_depth), [0.25, 0.75])
    some = np.linspace(0, len(x) - 1, min(MEASURES, len(x))).astype(int)
    return _Shape(pixels[some], middle_px, np.array([[xx, xy], [xy, yy]]), float(high - low) / 2)


def _axis_line(found: Foreground, camera: PinholeCamera) -> tuple[Floats, Floats, float]:
    """A place (2,) on the axis in the frame, its direction (2,), and the object's width across it, px."""
    shape = _shape(found)
    line = straight_line(found, camera) if shape.straight_and_hollow else None
    if line is not None:
        (low,), (high,) = shape.span(_across(line[1][None]))
        return *line, float(high - low)
    turn_rad, shift = _most_symmetric(shape, Mirror.of(found, shape.relief, camera))
    fan = _fan(shape, np.array([turn_rad]), np.array([shift]))
    return fan.places_px[0, 0], fan.along[0], float(fan.width_px[0])


def _most_symmetric(shape: _Shape, mirror: Mirror) -> tuple[float, float]:
    """Direction of the best line, and how many widths beside the middle it lies."""
    best = shape.long_side_rad, 0.0
    turns_rad, shifts = best[0] + TURNS_RAD, SHIFTS
    for halving in range(HALVINGS + 1):
        cost = _cost(shape, mirror, turns_rad, shifts)
        turn, shift = np.unravel_index(cost.argmin(), cost.shape)
        best = float(turns_rad[turn]), float(shifts[shift])
        turns_rad, shifts = best[0] + TURN_RAD / 2**halving * NEARBY, best[1] + SHIFT / 2**halving * NEARBY
    return best


@dataclass(frozen=True, eq=False)
class _Fan:
    """Lines through an object, in T directions at K places."""

    places_px: Floats
    """(T, K, 2) on each line, in the frame."""
    along: Floats
    """(T, 2) unit."""
    width_px: Floats
    """(T,) of the object, across the lines."""


def _fan(shape: _Shape, turns_rad: Floats, shifts: Floats) -> _Fan:
    """Lines in directions (T,), each as many widths beside the middle as there are shifts (K,)."""
    along = np.stack([np.cos(turns_rad), np.sin(turns_rad)], axis=1)
    low, high = shape.span(_across(along))
    beside = ((low + high) / 2)[:, None] + shifts * (high - low)[:, None]
    return _Fan(shape.middle_px + beside[..., None] * _across(along)[:, None], along, high - low)


def _cost(shape: _Shape, mirror: Mirror, turns_rad: Floats, shifts: Floats) -> Floats:
    """What speaks (T, K) against strokes in directions (T,) at places (K,)."""
    fan = _fan(shape, turns_rad, shifts)
    first, last = shape.span(fan.along)
    crosswise = STRAIGHT * shape.bend(fan.along) + LONG * fan.width_px / (fan.width_px + last - first)
    along = np.repeat(fan.along, len(shifts), axis=0)
    unlikeness = mirror.unlikeness(fan.places_px.reshape(-1, 2), along)
    return crosswise[:, None] + unlikeness.reshape(len(turns_rad), len(shifts))


def _across(along: Floats) -> Floats:
    """Directions (k, 2) a quarter turn clockwise on the screen from others."""
    return np.stack([-along[:, 1], along[:, 0]], axis=1)


def _ends(found: Foreground, place_px: Floats, along: Floats, width_px: float, camera: PinholeCamera) -> Floats:
    """Start and end (2, 2) of the stroke on a line through the object, px."""
    offset = found.patch.frame_px(places_of(found.mask)) - place_px
    lengthwise, crosswise = offset @ along, offset @ _across(along[None])[0]
    near = np.abs(crosswise) < max(MIDDLE_SHARE * width_px, found.patch.step_px)
    inverse_depth = found.patch.inverse_depth[found.mask]
    strip = Strip(lengthwise[near], crosswise[near], inverse_depth[near], place_px, along)
    stroke = place_px + np.array(side_of(strip, camera))[:, None] * along
    return stroke if along[np.abs(along).argmax()] > 0 else stroke[::-1]

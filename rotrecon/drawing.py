"""What the operator draws on the camera frame, and the lines of pixels it cuts the object into (paper 3.1)."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.primitives import Kind


class DrawingError(ValueError):
    """A drawing nothing can be measured with; the message says what to draw instead."""


@dataclass(frozen=True)
class AreaOfInterest:
    """A simple polygon on the frame, px; a rectangle is one of four vertices."""

    vertices_px: tuple[tuple[float, float], ...]

    @staticmethod
    def rectangle(corner_px: tuple[float, float], opposite_px: tuple[float, float]) -> "AreaOfInterest":
        """The rectangle between two opposite corners."""
        (u0, v0), (u1, v1) = corner_px, opposite_px
        return AreaOfInterest(((u0, v0), (u1, v0), (u1, v1), (u0, v1)))


@dataclass(frozen=True)
class ObjectAxis:
    """The stroke drawn along the object, px; its direction is the direction of every axis in the result."""

    start_px: tuple[float, float]
    end_px: tuple[float, float]


@dataclass(frozen=True)
class Drawing:
    """Everything the operator said about one object."""

    area: AreaOfInterest
    axis: ObjectAxis
    kind: Kind | None = None
    """None: the program decides."""
    excluded_sections: frozenset[int] = frozenset()
    """Sections of the second cut that the operator took out by hand."""


@dataclass(frozen=True, eq=False)
class CrossSegments:
    """Lines of pixels perpendicular to the drawn axis, inside the area: S sections of at most W pixels (figure 2).

    The grid is nearest-neighbour: cell (s, w) is the pixel at
    `origin_px + s * along + (first_offset_px + w) * across`, rounded.
    """

    pixel: Indices
    """(S, W) index into the flattened frame; -1 outside the area."""
    origin_px: Floats
    """(2,) where the first section meets the drawn axis."""
    along: Floats
    """(2,) unit vector of the drawn axis."""
    across: Floats
    """(2,) unit vector of a section: along, a quarter turn clockwise on the screen."""
    first_offset_px: int

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def inside(self) -> Bools:
        """(S, W) which cells lie in the area."""
        return self.pixel >= 0

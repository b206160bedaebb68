"""What the operator draws on the camera frame, and the lines of pixels it cuts the object into (paper 3.1)."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Bools, Bytes, Floats, Indices, freeze
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


def cut_sections(area: AreaOfInterest, axis: ObjectAxis, size_px: tuple[int, int]) -> CrossSegments:
    """Cross segments of a drawing on a frame of `size_px` (width, height), a pixel apart (paper 3.1).

    Raises DrawingError for a drawing that cannot be cut. Sections and lines without a pixel of the area are left out.
    """
    mask = _area_mask(area, size_px)
    start, end = np.array(axis.start_px), np.array(axis.end_px)
    length_px = float(np.linalg.norm(end - start))
    if not np.isfinite(length_px) or length_px < 1.0:
        raise DrawingError("the axis has no length; draw a stroke along the object")
    along = (end - start) / length_px
    across = np.array([-along[1], along[0]])
    offsets = (np.array(area.vertices_px) - start) @ across
    columns: Floats = np.arange(np.floor(offsets.min()), np.ceil(offsets.max()) + 1, dtype=np.float64)
    rows: Floats = np.arange(np.floor(length_px) + 1, dtype=np.float64)
    pixel = _pixels_on_grid(mask, start, along, across, rows, columns)
    inside = pixel >= 0
    if not inside[:, columns == 0].any():
        raise DrawingError("the axis lies outside the area; draw it along the object, inside the area")
    first_row, last_row = np.flatnonzero(inside.any(axis=1))[[0, -1]]
    first_column, last_column = np.flatnonzero(inside.any(axis=0))[[0, -1]]
    return CrossSegments(
        pixel=np.ascontiguousarray(pixel[first_row : last_row + 1, first_column : last_column + 1]),
        origin_px=start + first_row * along,
        along=along,
        across=across,
        first_offset_px=int(columns[first_column]),
    )


def _pixels_on_grid(
    mask: Bytes, origin_px: Floats, along: Floats, across: Floats, rows: Floats, columns: Floats
) -> Indices:
    """Index (S, W) of the pixel under each cell of a grid laid over the mask; -1 where the mask is empty."""
    height, width = mask.shape

    def coordinate(axis: int) -> Indices:
        # rounded by floor(x + 0.5), as rint rounds halves to even and would take every other pixel twice
        place = (origin_px[axis] + rows * along[axis] + 0.5).astype(np.float32)[:, None]
        place = place + (columns * across[axis]).astype(np.float32)
        return np.floor(place, out=place).astype(np.int32)

    u, v = coordinate(0), coordinate(1)
    in_frame = (u >= 0) & (u < width) & (v >= 0) & (v < height)
    pixel = np.multiply(v, width, out=v)
    pixel += u
    pixel[~in_frame] = 0
    in_frame &= mask.ravel()[pixel] > 0
    pixel[~in_frame] = -1
    return pixel


def _area_mask(area: AreaOfInterest, size_px: tuple[int, int]) -> Bytes:
    """Mask (height, width) of an area that was checked to be a simple polygon on the frame."""
    width, height = size_px
    vertices = np.array(area.vertices_px, dtype=np.float64).reshape(-1, 2)
    if len(vertices) < 3:
        raise DrawingError("the area has fewer than three corners; drag a rectangle or click a polygon")
    if not np.isfinite(vertices).all():
        raise DrawingError("the area has a corner that is not a number; give every corner as u,v in pixels")
    outside = (vertices < -0.5) | (vertices > (width, height))
    if outside.any():
        u, v = vertices[outside.any(axis=1)][0]
        raise DrawingError(
            f"the area's corner {u:g},{v:g} lies outside the frame of {width} x {height} px; draw it on the frame"
        )
    if _crosses_itself(vertices):
        raise DrawingError("the area's outline crosses itself; draw its corners in order round the object")
    if cv2.contourArea(vertices.astype(np.float32)) < 1.0:
        raise DrawingError("the area has no size; draw it round the object")
    mask = np.zeros((height, width), dtype=np.uint8)
    cv2.fillPoly(mask, [np.rint(vertices).astype(np.int32)], 1)
    return mask


def _crosses_itself(vertices: Floats) -> bool:
    """Whether two edges (of N) that are not neighbours meet; (N, N) orientation tests at once."""
    start, end = vertices, np.roll(vertices, -1, axis=0)

    def side(a: Floats, b: Floats, c: Floats) -> Floats:
        """Sign of the turn a -> b -> c, for every pair of an edge and a point."""
        return np.sign(
            (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
        )

    a, b, c, d = start[:, None], end[:, None], start[None], end[None]
    meet = (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)
    return bool(meet.any())

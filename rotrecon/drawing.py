"""What the operator draws on the camera frame, and the lines of pixels it cuts the object into (paper 3.1)."""

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np

from rotrecon.arrays import Bools, Bytes, Floats, Indices, freeze
from rotrecon.contact import PROPOSED, Place
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


Direction = Literal["free", "vertical", "drawn", "plane"]
"""How an object's axis lies: in any way, along the base's z, along the stroke over its surface in space, or square to
the plane that most of the area's other pixels lie on."""


@dataclass(frozen=True)
class Constraints:
    """What the operator knows of an object before it is measured."""

    radius_m: tuple[float, float] | None = None
    """Lowest and highest; equal for a radius that is known."""
    direction: Direction = "free"


@dataclass(frozen=True)
class Drawing:
    """Everything the operator said about one object."""

    area: AreaOfInterest
    axis: ObjectAxis | None = None
    """None: the program proposes one."""
    kind: Kind | None = None
    """None: the program decides."""
    excluded_sections: frozenset[int] = frozenset()
    """Sections of the second cut that the operator took out by hand."""
    constraints: Constraints = Constraints()
    contact: Place = PROPOSED
    """Where a tool is to touch the object."""

    @property
    def stroke(self) -> ObjectAxis:
        """The axis, of a drawing that has one; raises ValueError."""
        if self.axis is None:
            raise ValueError("the drawing has no axis; propose one first")
        return self.axis


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
    check_area(area, size_px)
    mask = area_mask(area, size_px)
    start, end = np.array(axis.start_px, dtype=np.float64), np.array(axis.end_px, dtype=np.float64)
    _check_on_frame("the axis's end", np.stack([start, end]), size_px)
    length_px = float(np.linalg.norm(end - start))
    if length_px < 1.0:
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


def check_area(area: AreaOfInterest, size_px: tuple[int, int]) -> None:
    """Raise DrawingError unless an area is a simple polygon with a size, on a frame of `size_px` (width, height)."""
    vertices = np.array(area.vertices_px, dtype=np.float64).reshape(-1, 2)
    if len(vertices) < 3:
        raise DrawingError("the area has fewer than three corners; drag a rectangle or click a polygon")
    _check_on_frame("the area's corner", vertices, size_px)
    if np.ptp(vertices, axis=0).min() < 1.0:
        raise DrawingError("the area has no size; draw it round the object")
    if _crosses_itself(vertices[(vertices != np.roll(vertices, 1, axis=0)).any(axis=1)]):
        raise DrawingError("the area's outline crosses or touches itself; draw its corners in order round the object")


def area_mask(area: AreaOfInterest, size_px: tuple[int, int]) -> Bytes:
    """Mask (height, width), 0 or 1, of an area that `check_area` has passed."""
    width, height = size_px
    mask = np.zeros((height, width), dtype=np.uint8)
    cv2.fillPoly(mask, [np.rint(np.array(area.vertices_px)).astype(np.int32)], 1)
    return mask


def _check_on_frame(what: str, points: Floats, size_px: tuple[int, int]) -> None:
    """Refuse points (n, 2) beyond the frame; its far border may be named by the frame's size."""
    outside = ~((points >= -0.5) & (points <= size_px)).all(axis=1)
    if outside.any():
        u, v = points[outside][0]
        width, height = size_px
        raise DrawingError(f"{what} {u:g},{v:g} lies outside the frame of {width} x {height} px; draw it on the frame")


def _crosses_itself(vertices: Floats) -> bool:
    """Whether two of N edges meet elsewhere than at a corner they share, or neighbours fold back on each other."""
    start, end = vertices, np.roll(vertices, -1, axis=0)
    along, onward = end - start, np.roll(end - start, -1, axis=0)
    folds_back = (along[:, 0] * onward[:, 1] == along[:, 1] * onward[:, 0]) & ((along * onward).sum(axis=1) < 0)

    def side(point: Floats) -> Floats:
        """Sign (N, N) of the turn from each edge to each point."""
        offset = point[None] - start[:, None]
        return np.sign(along[:, None, 0] * offset[..., 1] - along[:, None, 1] * offset[..., 0])

    low, high = np.minimum(start, end), np.maximum(start, end)
    boxes_meet = ((low[:, None] <= high[None]) & (low[None] <= high[:, None])).all(axis=2)
    straddles = side(start) * side(end) <= 0
    number = np.arange(len(vertices))
    apart = np.abs(number[:, None] - number[None])
    strangers = (apart > 1) & (apart < len(vertices) - 1)
    return bool(folds_back.any() or (strangers & boxes_meet & straddles & straddles.T).any())

"""What has been drawn of one object, and how its parts change when one of them is moved."""

from dataclasses import dataclass, replace
from math import copysign, inf, isfinite
from typing import Literal

from rotrecon.contact import PROPOSED, Place
from rotrecon.drawing import AreaOfInterest, Constraints, Direction, Drawing, ObjectAxis
from rotrecon.primitives import Kind

Pixel = tuple[float, float]
Part = Literal["area", "axis"]
PARTS: tuple[Part, ...] = ("area", "axis")
SMALLEST_PX = 4.0
"""Side of a rectangle that is still meant as one: enough to be seen and grabbed again."""
UNKNOWN_MM = (0.0, 0.0)
"""Typed limits of a diameter of which nothing is known."""


@dataclass(frozen=True)
class ObjectDrawing:
    """What has been drawn of one object; parts that are not there yet are None."""

    area: AreaOfInterest | None = None
    axis: ObjectAxis | None = None
    kind: Kind | None = None
    excluded_sections: frozenset[int] = frozenset()
    diameter_mm: tuple[float, float] = UNKNOWN_MM
    """Its limits as they were typed, in either order; 0 is none."""
    direction: Direction = "free"
    contact: Place = PROPOSED
    """Where a tool is to touch it."""
    proposed: bool = False
    """Whether the axis is the program's, and not drawn: then it belongs to the area it was proposed for."""

    @property
    def constraints(self) -> Constraints:
        """What is known before it is measured."""
        if self.diameter_mm == UNKNOWN_MM:
            return Constraints(None, self.direction)
        low_mm, high_mm = sorted((self.diameter_mm[0], self.diameter_mm[1] or inf))
        return Constraints((low_mm / 2000, high_mm / 2000), self.direction)

    @property
    def complete(self) -> Drawing | None:
        """The drawing that can be measured, once the area is there; where it has no axis, one is proposed."""
        if self.area is None:
            return None
        return Drawing(self.area, self.axis, self.kind, self.excluded_sections, self.constraints, self.contact)

    @property
    def middle_px(self) -> Pixel | None:
        """The middle of the area."""
        if self.area is None:
            return None
        columns, rows = zip(*self.area.vertices_px, strict=True)
        return ((min(columns) + max(columns)) / 2, (min(rows) + max(rows)) / 2)


def drawn_as(drawing: Drawing) -> ObjectDrawing:
    """What was drawn for a drawing that can be measured; an axis that it lacks is proposed again."""
    limits = drawing.constraints.radius_m
    # to a nanometre: what was typed, and not what halving it has left of it
    low_mm, high_mm = UNKNOWN_MM if limits is None else (round(2000 * radius_m, 6) for radius_m in limits)
    return ObjectDrawing(
        drawing.area,
        drawing.axis,
        drawing.kind,
        drawing.excluded_sections,
        (low_mm, high_mm if isfinite(high_mm) else 0.0),
        drawing.constraints.direction,
        drawing.contact,
    )


def with_area(drawn: ObjectDrawing, area: AreaOfInterest) -> ObjectDrawing:
    """The object with a new area; an axis that lies elsewhere was meant for another object."""
    drawn = without_proposal(drawn)
    axis = drawn.axis
    if axis is not None:
        middle = [(a + b) / 2 for a, b in zip(axis.start_px, axis.end_px, strict=True)]
        for value, along in zip(middle, zip(*area.vertices_px, strict=True), strict=True):
            if not min(along) <= value <= max(along):
                axis = None
    return replace(drawn, area=area, axis=axis, contact=PROPOSED)


def with_axis(drawn: ObjectDrawing, axis: ObjectAxis, proposed: bool = False) -> ObjectDrawing:
    """The object with an axis, the operator's unless it is proposed."""
    return replace(drawn, axis=axis, proposed=proposed)


def without_proposal(drawn: ObjectDrawing) -> ObjectDrawing:
    """The object as it was drawn, for an area that changes."""
    return replace(drawn, axis=None, proposed=False) if drawn.proposed else drawn


def with_corner(area: AreaOfInterest, index: int, point: Pixel) -> AreaOfInterest:
    """The area with one corner elsewhere; a rectangle stays one, and does not collapse."""
    corners = area.vertices_px
    if not _is_rectangle(corners):
        return AreaOfInterest((*corners[:index], point, *corners[index + 1 :]))
    (old_u, old_v), opposite = corners[index], corners[index - 2]
    u, v = (_apart(*values) for values in zip(point, corners[index], opposite, strict=True))
    return AreaOfInterest(tuple((u if cu == old_u else cu, v if cv == old_v else cv) for cu, cv in corners))


def _apart(value: float, before: float, opposite: float) -> float:
    """A side's new place, kept the smallest size off the opposite one, on the side where it was `before`."""
    if abs(value - opposite) >= SMALLEST_PX:
        return value
    return opposite + copysign(min(SMALLEST_PX, abs(before - opposite)), before - opposite)


def _is_rectangle(corners: tuple[Pixel, ...]) -> bool:
    """Whether four corners are those of an upright rectangle that has a size."""
    columns, rows = {u for u, _ in corners}, {v for _, v in corners}
    return len(corners) == 4 and len(set(corners)) == 4 and len(columns) == 2 and len(rows) == 2


def on_frame(point: Pixel, size_px: tuple[int, int]) -> Pixel | None:
    """The nearest point on a frame of `size_px` (width, height); None for what is not a point."""
    if not all(isfinite(value) for value in point):
        return None
    (u, v), (width, height) = point, size_px
    return (min(max(float(u), 0.0), width - 1.0), min(max(float(v), 0.0), height - 1.0))


def distance_px(one: Pixel, other: Pixel) -> float:
    """How far two points are apart."""
    return ((one[0] - other[0]) ** 2 + (one[1] - other[1]) ** 2) ** 0.5

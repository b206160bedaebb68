"""Drawings as they are typed on a command line: "u,v u,v"."""

import math

from rotrecon.drawing import AreaOfInterest, DrawingError, ObjectAxis


def parse_area(text: str) -> AreaOfInterest:
    """Two points are a rectangle's corners, more a polygon; raises DrawingError."""
    points = _parse_points("area", text)
    if len(points) < 2:
        raise DrawingError('the area needs two corners of a rectangle or a polygon\'s; write --area "u,v u,v"')
    return AreaOfInterest.rectangle(*points) if len(points) == 2 else AreaOfInterest(tuple(points))


def parse_axis(text: str) -> ObjectAxis:
    """Start and end of the stroke along the object; raises DrawingError."""
    points = _parse_points("axis", text)
    if len(points) != 2:
        raise DrawingError(f'the axis has {len(points)} points; write its two ends as --axis "u,v u,v"')
    return ObjectAxis(*points)


def stroke_text(axis: ObjectAxis) -> str:
    """A stroke as `parse_axis` reads it, to a tenth of a pixel and in quotes."""
    return '"' + " ".join(f"{u:.1f},{v:.1f}" for u, v in (axis.start_px, axis.end_px)) + '"'


def _parse_points(what: str, text: str) -> list[tuple[float, float]]:
    points: list[tuple[float, float]] = []
    for word in text.split():
        try:
            u, v = (float(number) for number in word.split(","))
        except ValueError as error:
            raise DrawingError(f'the {what}\'s "{word}" is not a pixel; write it as u,v such as 325,75') from error
        if not (math.isfinite(u) and math.isfinite(v)):
            raise DrawingError(f'the {what}\'s "{word}" is not a pixel; write it as u,v such as 325,75')
        points.append((u, v))
    return points

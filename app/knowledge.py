"""What the operator says is known of an object before it is measured: its kind, how its axis lies, its diameter."""

from dataclasses import replace
from math import isfinite, radians
from typing import get_args

from app.events import ContactPlaced, DiameterTyped, DirectionChosen, KindChosen
from app.object_drawing import UNKNOWN_MM, ObjectDrawing
from rotrecon.contact import MOST_ANGLE_RAD, Place
from rotrecon.drawing import Direction
from rotrecon.primitives import KINDS

Said = ContactPlaced | KindChosen | DirectionChosen | DiameterTyped
DIRECTION_NAMES: dict[Direction, str] = {
    "free": "in any way",
    "vertical": "vertical",
    "drawn": "along the stroke",
    "plane": "square to the table",
}
"""How an axis lies, as a person says it."""


def with_knowledge(drawn: ObjectDrawing, said: Said) -> ObjectDrawing:
    """The object of which something more is known; what a page could not have sent by its controls changes nothing."""
    match said:
        case KindChosen(kind) if kind is None or kind in KINDS:
            return replace(drawn, kind=kind)
        case DirectionChosen(direction) if direction in get_args(Direction):
            return replace(drawn, direction=direction)
        case DiameterTyped(from_mm, to_mm) if all(isfinite(mm) and mm >= 0 for mm in (from_mm, to_mm)):
            return replace(drawn, diameter_mm=(from_mm, to_mm))
        case ContactPlaced(angle_deg, along_mm) if isfinite(angle_deg) and isfinite(along_mm):
            angle_rad = min(max(radians(angle_deg), -MOST_ANGLE_RAD), MOST_ANGLE_RAD)
            return replace(drawn, contact=Place(angle_rad, along_mm / 1000))
        case _:
            return drawn


def knowledge_text(drawn: ObjectDrawing) -> str:
    """What is known of how its axis lies and of its diameter, in a few words; empty when that is nothing."""
    parts = [] if drawn.direction == "free" else [DIRECTION_NAMES[drawn.direction]]
    low, high = sorted(drawn.diameter_mm) if all(drawn.diameter_mm) else drawn.diameter_mm
    if drawn.diameter_mm != UNKNOWN_MM:
        least, most = f"{low:g}" if low else "up", f" to {high:g}" if high else " or more"
        parts.append(f"{low:g} mm" if low == high else f"{least}{most} mm")
    return ", ".join(parts)

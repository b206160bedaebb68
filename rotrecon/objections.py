"""What speaks against a tool for one thing that an object may be (paper table 1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, inf

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.outcome import Range
from rotrecon.primitives import Frustum, Kind, in_words
from rotrecon.reading import Reading, diameter_mm, length_over_diameter, widest_mm
from rotrecon.tool_table import Tool

STRAIGHT_RAD: Range = (-0.05, 0.05)
"""Half angles that a tool for a cylinder or a rod takes for straight: 3 degrees is the angle of friction of greased
steel (0.05), below which jaws do not slip along a taper."""
NEARER = "look at it from nearer, or from the side"
"""What narrows the interval of a size."""


@dataclass(frozen=True)
class Objection:
    """What speaks against a tool."""

    why: str
    settled_by: str = ""
    """What the operator can do about it."""
    certain: bool = True
    """It holds over the whole interval, not for a part of it only."""


def objections_to(tool: Tool, reading: Reading, contact_m: Floats, dangerous: frozenset[Kind]) -> Sequence[Objection]:
    """What speaks against a tool for one reading: the first that is certain, or else all; nothing when it fits."""
    checks = (
        _kind(tool, reading),
        _danger(tool, reading, dangerous),
        _diameter(tool, reading),
        _depth(tool, reading),
        _length(tool, reading),
        _reach(tool, contact_m),
    )
    objections = [objection for objection in checks if objection is not None]
    return [objection for objection in objections if objection.certain][:1] or objections


def _kind(tool: Tool, reading: Reading) -> Objection | None:
    """A cone that hardly tapers is as good as straight to a tool for what is straight."""
    solid = reading.solid
    if solid.kind in tool.takes:
        return None
    half_angle_rad = solid.half_angle_rad if isinstance(solid, Frustum) else 0.0
    taper_rad = reading.half_angle_rad or (half_angle_rad, half_angle_rad)
    if solid.kind != "cone" or not {"cylinder", "rod"} & set(tool.takes) or not _overlap(taper_rad, STRAIGHT_RAD):
        taper = f" of {degrees(abs(half_angle_rad)):.1f} degrees" if solid.kind == "cone" else ""
        return Objection(f"does not take a {in_words(solid.kind)}{taper}")
    if _within(taper_rad, STRAIGHT_RAD):
        return None
    has = _range((degrees(taper_rad[0]), degrees(taper_rad[1])))
    why = f"takes a half angle up to {degrees(STRAIGHT_RAD[1]):.1f} degrees, the cone has {has} degrees"
    return Objection(why, "draw more of its length", certain=False)


def _danger(tool: Tool, reading: Reading, dangerous: frozenset[Kind]) -> Objection | None:
    kind = reading.solid.kind
    if tool.dangerous_ok or kind not in dangerous:
        return None
    return Objection(f"may not be put to a {in_words(kind)}, which is marked dangerous")


def _diameter(tool: Tool, reading: Reading) -> Objection | None:
    """A general solid of revolution must not be wider than the tool anywhere: how broad its jaws are is not known."""
    low, high = tool.diameter_mm
    middle_mm, most_mm = diameter_mm(reading), widest_mm(reading)
    if middle_mm[0] >= low and most_mm[1] <= high:
        return None
    at_widest = "" if most_mm == middle_mm else f" in the middle and {_range(most_mm)} mm where it is widest"
    why = f"takes {low:g} to {high:g} mm, the {in_words(reading.solid.kind)} has {_range(middle_mm)} mm{at_widest}"
    if middle_mm[1] < low or most_mm[0] > high:
        return Objection(why)
    return Objection(why, NEARER, certain=False)


def _depth(tool: Tool, reading: Reading) -> Objection | None:
    """Jaws that do not get past the middle close in front of it, and push the object away."""
    if tool.depth_mm is None:
        return None
    low_mm, high_mm = (diameter / 2 for diameter in widest_mm(reading))
    if high_mm <= tool.depth_mm:
        return None
    middle = f"the middle of the {in_words(reading.solid.kind)} {_range((low_mm, high_mm))} mm"
    why = f"reaches {tool.depth_mm:g} mm deep, {middle}"
    if low_mm > tool.depth_mm:
        return Objection(why)
    return Objection(why, NEARER, certain=False)


def _length(tool: Tool, reading: Reading) -> Objection | None:
    least = tool.min_length_over_diameter
    ratio = length_over_diameter(reading)
    if ratio[0] >= least:
        return None
    has = f"at least {ratio[0]:.1f}" if ratio[1] == inf else _range(ratio)
    why = f"needs an object {least:g} times as long as thick, the {in_words(reading.solid.kind)} is {has} times"
    return Objection(why, "draw more of its length if there is more", certain=ratio[1] < least)


def _reach(tool: Tool, contact_m: Floats) -> Objection | None:
    distance_m = float(np.linalg.norm(contact_m))
    if tool.reach_m is None or distance_m <= tool.reach_m:
        return None
    return Objection(f"reaches {tool.reach_m:g} m, the object is {distance_m:.2f} m away")


def _within(interval: Range, limits: Range) -> bool:
    return limits[0] <= interval[0] and interval[1] <= limits[1]


def _overlap(interval: Range, limits: Range) -> bool:
    return interval[0] <= limits[1] and limits[0] <= interval[1]


def _range(interval: Range) -> str:
    """An interval in words; one number where it is no wider than what is shown of it."""
    low, high = (f"{value:.1f}" for value in interval)
    return low if low == high else f"{low} to {high}"

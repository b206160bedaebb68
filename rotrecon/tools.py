"""Which tool fits an object, for all that it may be (paper table 1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, inf

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.contact import PROPOSED, Place, contact_on
from rotrecon.outcome import Range
from rotrecon.primitives import Frustum, Kind, Primitive, Revolution, in_words
from rotrecon.tool_table import Tool, ToolTable

STRAIGHT_RAD: Range = (-0.05, 0.05)
"""Half angles that a tool for a cylinder or a rod takes for straight: 3 degrees is the angle of friction of greased
steel (0.05), below which jaws do not slip along a taper."""
WHICH_KIND = "look at it from elsewhere, or choose its kind if you know it"
"""What settles which of the readings is the true one."""

NEARER = "look at it from nearer, or from the side"
"""What narrows the interval of a size."""


@dataclass(frozen=True, eq=False)
class Reading:
    """One thing that the object may be, and between which limits; base coordinates.

    An interval is (lowest, highest); where it is None, no interval is known and the solid's own number counts. A rod
    and a cylinder are one solid under two names: give it once, under the name it goes by.
    """

    solid: Primitive
    diameter_m: Range | None = None
    """At the middle of its length."""
    length_m: Range | None = None
    """Where an end is open, the highest is inf."""
    half_angle_rad: Range | None = None
    """Of a cone."""

    def __post_init__(self) -> None:
        for interval in (self.diameter_m, self.length_m, self.half_angle_rad):
            if interval is not None and not interval[0] <= interval[1]:
                raise ValueError(f"{interval} is not an interval: give (lowest, highest)")


@dataclass(frozen=True, eq=False)
class ToolProposal:
    """The tool that fits, and how it would come to the object; base coordinates."""

    tool: Tool
    contact_point_m: Floats
    """(3,) on the surface, at the middle of the object, where it faces the camera."""
    approach: Floats
    """(3,) unit: the way the tool moves to get there, at right angles to the object's axis."""
    unsure: tuple[str, ...] = ()
    """Tools before it in the table that may fit too: a sentence a tool."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True)
class NoTool:
    """No tool can be named, and why: a sentence a tool."""

    reasons: tuple[str, ...]
    unsure: tuple[str, ...] = ()
    """Those of the reasons that leave open whether the tool fits."""


@dataclass(frozen=True)
class Judged:
    """What speaks against one tool."""

    why: str
    """In words and with what settles it; empty for a tool that fits."""
    is_out: bool
    """Whether it is ruled out, whatever the object may be."""

    @property
    def fits(self) -> bool:
        """Whatever the object may be."""
        return not self.why


@dataclass(frozen=True)
class _Objection:
    """What speaks against a tool."""

    why: str
    settled_by: str = ""
    """What the operator can do about it."""
    certain: bool = True
    """It holds over the whole interval, not for a part of it only."""


def propose_tool(
    readings: tuple[Reading, ...],
    camera_center_m: Floats,
    concave: bool,
    tools: ToolTable,
    place: Place = PROPOSED,
    dangerous: frozenset[Kind] = frozenset(),
) -> ToolProposal | NoTool:
    """The first tool of the table that fits whatever the object may be, seen by a camera at `camera_center_m` (3,).

    The first reading is the chosen one: contact and approach are its. A tool fits when it fits every reading over its
    whole intervals; it is ruled out when it fits none anywhere; in between it is not sure. To a class marked
    `dangerous` fit those alone that the table says may be put to one. A tool that fits is proposed
    even where one before it in the table is not sure: it is right whichever way that doubt is settled, and the order of
    the table is a preference among tools that fit. Where no tool fits, NoTool. Raises ValueError without a reading.
    """
    if not readings:
        raise ValueError("there is no reading to choose a tool for")
    if concave:
        return NoTool(("the surface is seen from inside, and no tool works there; draw an object seen from outside",))
    contact = contact_on(readings[0].solid, camera_center_m, place)
    reasons: list[str] = []
    unsure: list[str] = []
    for tool in tools:
        judged = judge(tool, readings, contact.point_m, dangerous)
        if judged.fits:
            return ToolProposal(tool, contact.point_m, contact.approach, tuple(unsure))
        reasons.append(f"{tool.name}: {judged.why}")
        unsure += [] if judged.is_out else reasons[-1:]
    return NoTool(tuple(reasons), tuple(unsure))


def judge(
    tool: Tool, readings: Sequence[Reading], contact_m: Floats, dangerous: frozenset[Kind] = frozenset()
) -> Judged:
    """What speaks against a tool at a contact (3,), for all that the object may be."""
    objections = [_objections(tool, reading, contact_m, dangerous) for reading in readings]
    return Judged(*_verdict(objections)) if any(objections) else Judged("", False)


def _verdict(objections: Sequence[Sequence[_Objection]]) -> tuple[str, bool]:
    """What speaks against a tool, for each reading, in words and with what settles it; and whether it is ruled out."""
    excluded = [any(objection.certain for objection in against) for against in objections]
    is_out = all(excluded)
    against = objections[0] if is_out else [objection for against in objections for objection in against]
    whys = dict.fromkeys(objection.why for objection in against)
    remedies = dict.fromkeys(objection.settled_by for objection in against if objection.settled_by)
    if any(excluded) and not is_out:
        remedies[WHICH_KIND] = None
    return "; ".join([f"{' and '.join(whys)}: {'ruled out' if is_out else 'not sure'}", *remedies]), is_out


def _objections(tool: Tool, reading: Reading, contact_m: Floats, dangerous: frozenset[Kind]) -> Sequence[_Objection]:
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


def _kind(tool: Tool, reading: Reading) -> _Objection | None:
    """A cone that hardly tapers is as good as straight to a tool for what is straight."""
    solid = reading.solid
    if solid.kind in tool.takes:
        return None
    half_angle_rad = solid.half_angle_rad if isinstance(solid, Frustum) else 0.0
    taper_rad = reading.half_angle_rad or (half_angle_rad, half_angle_rad)
    if solid.kind != "cone" or not {"cylinder", "rod"} & set(tool.takes) or not _overlap(taper_rad, STRAIGHT_RAD):
        taper = f" of {degrees(abs(half_angle_rad)):.1f} degrees" if solid.kind == "cone" else ""
        return _Objection(f"does not take a {in_words(solid.kind)}{taper}")
    if _within(taper_rad, STRAIGHT_RAD):
        return None
    has = _range((degrees(taper_rad[0]), degrees(taper_rad[1])))
    why = f"takes a half angle up to {degrees(STRAIGHT_RAD[1]):.1f} degrees, the cone has {has} degrees"
    return _Objection(why, "draw more of its length", certain=False)


def _danger(tool: Tool, reading: Reading, dangerous: frozenset[Kind]) -> _Objection | None:
    kind = reading.solid.kind
    if tool.dangerous_ok or kind not in dangerous:
        return None
    return _Objection(f"may not be put to a {in_words(kind)}, which is marked dangerous")


def _diameter(tool: Tool, reading: Reading) -> _Objection | None:
    """A general solid of revolution must not be wider than the tool anywhere: how broad its jaws are is not known."""
    low, high = tool.diameter_mm
    middle_mm, most_mm = diameter_mm(reading), widest_mm(reading)
    if middle_mm[0] >= low and most_mm[1] <= high:
        return None
    at_widest = "" if most_mm == middle_mm else f" in the middle and {_range(most_mm)} mm where it is widest"
    why = f"takes {low:g} to {high:g} mm, the {in_words(reading.solid.kind)} has {_range(middle_mm)} mm{at_widest}"
    if middle_mm[1] < low or most_mm[0] > high:
        return _Objection(why)
    return _Objection(why, NEARER, certain=False)


def _depth(tool: Tool, reading: Reading) -> _Objection | None:
    """Jaws that do not get past the middle close in front of it, and push the object away."""
    if tool.depth_mm is None:
        return None
    low_mm, high_mm = (diameter / 2 for diameter in widest_mm(reading))
    if high_mm <= tool.depth_mm:
        return None
    middle = f"the middle of the {in_words(reading.solid.kind)} {_range((low_mm, high_mm))} mm"
    why = f"reaches {tool.depth_mm:g} mm deep, {middle}"
    if low_mm > tool.depth_mm:
        return _Objection(why)
    return _Objection(why, NEARER, certain=False)


def _length(tool: Tool, reading: Reading) -> _Objection | None:
    least = tool.min_length_over_diameter
    ratio = _length_over_diameter(reading)
    if ratio[0] >= least:
        return None
    has = f"at least {ratio[0]:.1f}" if ratio[1] == inf else _range(ratio)
    why = f"needs an object {least:g} times as long as thick, the {in_words(reading.solid.kind)} is {has} times"
    return _Objection(why, "draw more of its length if there is more", certain=ratio[1] < least)


def _reach(tool: Tool, contact_m: Floats) -> _Objection | None:
    distance_m = float(np.linalg.norm(contact_m))
    if tool.reach_m is None or distance_m <= tool.reach_m:
        return None
    return _Objection(f"reaches {tool.reach_m:g} m, the object is {distance_m:.2f} m away")


def diameter_mm(reading: Reading) -> Range:
    """Lowest and highest diameter in the middle."""
    low, high = reading.diameter_m or (2 * float(reading.solid.radius_at(0.0)),) * 2
    return 1000 * low, 1000 * high


def widest_mm(reading: Reading) -> Range:
    """Of a general solid of revolution where it is widest, off by as much as in the middle; of others in the middle."""
    low, high = diameter_mm(reading)
    solid = reading.solid
    more = 2000 * (float(solid.radii_m.max()) - solid.radius_m) if isinstance(solid, Revolution) else 0.0
    return low + more, high + more


def _length_over_diameter(reading: Reading) -> Range:
    """Between which limits it is, whatever diameter goes with which length; 1 for a sphere.

    The diameter is the widest: what is asked for is an object long enough to be held across its axis, and the part
    where that is least true decides.
    """
    low, high = reading.solid.ends
    if reading.solid.kind == "sphere":
        return 1.0, 1.0
    thin_mm, thick_mm = widest_mm(reading)
    short_m, long_m = reading.length_m or (high - low,) * 2
    return 1000 * short_m / thick_mm if thick_mm > 0 else inf, 1000 * long_m / thin_mm if thin_mm > 0 else inf


def _within(interval: Range, limits: Range) -> bool:
    return limits[0] <= interval[0] and interval[1] <= limits[1]


def _overlap(interval: Range, limits: Range) -> bool:
    return interval[0] <= limits[1] and limits[0] <= interval[1]


def _range(interval: Range) -> str:
    """An interval in words; one number where it is no wider than what is shown of it."""
    low, high = (f"{value:.1f}" for value in interval)
    return low if low == high else f"{low} to {high}"

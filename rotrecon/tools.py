"""Which tool fits an object, for all that it may be (paper table 1)."""

from collections.abc import Sequence
from dataclasses import dataclass

from rotrecon.arrays import Floats, freeze
from rotrecon.contact import PROPOSED, Place, contact_on
from rotrecon.objections import Objection, objections_to
from rotrecon.primitives import Kind
from rotrecon.reading import Reading
from rotrecon.tool_table import Tool, ToolTable

WHICH_KIND = "look at it from elsewhere, or choose its kind if you know it"
"""What settles which of the readings is the true one."""


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
    objections = [objections_to(tool, reading, contact_m, dangerous) for reading in readings]
    return Judged(*_verdict(objections)) if any(objections) else Judged("", False)


def _verdict(objections: Sequence[Sequence[Objection]]) -> tuple[str, bool]:
    """What speaks against a tool, for each reading, in words and with what settles it; and whether it is ruled out."""
    excluded = [any(objection.certain for objection in against) for against in objections]
    is_out = all(excluded)
    against = objections[0] if is_out else [objection for against in objections for objection in against]
    whys = dict.fromkeys(objection.why for objection in against)
    remedies = dict.fromkeys(objection.settled_by for objection in against if objection.settled_by)
    if any(excluded) and not is_out:
        remedies[WHICH_KIND] = None
    return "; ".join([f"{' and '.join(whys)}: {'ruled out' if is_out else 'not sure'}", *remedies]), is_out

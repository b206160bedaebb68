"""How much room each tool of the table leaves an object, or why it is ruled out (paper table 1)."""

from dataclasses import dataclass
from typing import Literal

from rotrecon.arrays import Floats
from rotrecon.outcome import Range
from rotrecon.primitives import Kind
from rotrecon.reading import Reading, diameter_mm, widest_mm
from rotrecon.tool_table import Tool, ToolTable
from rotrecon.tools import Judged, judge

Verdict = Literal["fits", "not sure", "ruled out"]


@dataclass(frozen=True)
class Clearance:
    """One tool beside one object; each interval is over all that the object may be, negative where there is no room."""

    tool: Tool
    verdict: Verdict
    why: str
    """What speaks against it and what settles that; empty for a tool that fits."""
    above_lowest_mm: Range
    """By how much the diameter is above the least that the tool takes."""
    below_highest_mm: Range
    """And below the most."""
    opening_mm: Range | None
    """Room left in the opening, both sides together; None where the table does not say how wide it opens."""
    depth_mm: Range | None
    """By how much the tips stand beyond the object when it touches the bottom of the mouth; None alike."""


def clearances(
    readings: tuple[Reading, ...],
    contact_m: Floats,
    concave: bool,
    tools: ToolTable,
    dangerous: frozenset[Kind] = frozenset(),
) -> tuple[Clearance, ...]:
    """Every tool of the table at a contact (3,), in the table's order; raises ValueError without a reading."""
    if not readings:
        raise ValueError("there is no reading to leave room for")
    thin = [diameter_mm(reading) for reading in readings]
    wide = [widest_mm(reading) for reading in readings]
    least, most = min(low for low, _ in thin), max(high for _, high in thin)
    widest = (min(low for low, _ in wide), max(high for _, high in wide))
    judged = [judge(tool, readings, contact_m, dangerous) for tool in tools]
    return tuple(_clearance(tool, one, concave, (least, most), widest) for tool, one in zip(tools, judged, strict=True))


def _clearance(tool: Tool, judged: Judged, concave: bool, middle: Range, widest: Range) -> Clearance:
    verdict: Verdict = "ruled out" if judged.is_out or concave else "fits" if judged.fits else "not sure"
    low, high = tool.diameter_mm
    return Clearance(
        tool,
        verdict,
        "the surface is seen from inside: ruled out" if concave else judged.why,
        (middle[0] - low, middle[1] - low),
        (high - widest[1], high - widest[0]),
        _room(tool.opening_mm, widest),
        _room(tool.depth_mm, widest),
    )


def _room(size_mm: float | None, widest: Range) -> Range | None:
    return None if size_mm is None else (size_mm - widest[1], size_mm - widest[0])

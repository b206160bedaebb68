"""Which tool fits which object: paper table 1 as a table that can be edited."""

import tomllib
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from math import isfinite
from pathlib import Path
from typing import Annotated, get_args

import msgspec
import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.primitives import Kind, Primitive

Positive = Annotated[float, msgspec.Meta(gt=0)]

REMEDY = (
    f"a tool has name, takes (of {', '.join(get_args(Kind))}), diameter_mm = [lowest, highest], and may have "
    "min_length_over_diameter, opening_mm, depth_mm, reach_m and dangerous_ok"
)


class ToolTableError(Exception):
    """A tool table that cannot be used; the message names the file, the tool, the field and the remedy."""


class Tool(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One tool and the objects it may be put to; lengths as a person reads them."""

    name: str
    takes: tuple[Kind, ...]
    diameter_mm: tuple[Positive, Positive]
    min_length_over_diameter: Annotated[float, msgspec.Meta(ge=0)] = 0.0
    opening_mm: Positive | None = None
    depth_mm: Positive | None = None
    reach_m: Positive | None = None
    dangerous_ok: bool = False


ToolTable = tuple[Tool, ...]


@dataclass(frozen=True, eq=False)
class ToolProposal:
    """The tool that fits, and how it would come to the object; base coordinates."""

    tool: Tool
    contact_point_m: Floats
    """(3,) on the surface, at the middle of the object, where it faces the camera."""
    approach: Floats
    """(3,) unit: the way the tool moves to get there, at right angles to the object's axis."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True)
class NoTool:
    """No tool can be named, and why: a sentence a tool."""

    reasons: tuple[str, ...]


def propose_tool(solid: Primitive, camera_center_m: Floats, concave: bool, tools: ToolTable) -> ToolProposal | NoTool:
    """The first tool of the table that fits a solid seen by a camera at `camera_center_m`, both in base coordinates."""
    if concave:
        return NoTool(("the surface is seen from inside, and no tool works there; draw an object seen from outside",))
    contact_m, approach = _contact(solid, camera_center_m)
    objections: list[str] = []
    for tool in tools:
        objection = _objection(tool, solid, contact_m)
        if objection is None:
            return ToolProposal(tool, contact_m, approach)
        objections.append(f"{tool.name}: {objection}")
    return NoTool(tuple(objections))


def _contact(solid: Primitive, camera_center_m: Floats) -> tuple[Floats, Floats]:
    """Contact point and approach (3,): toward the middle, square to the axis unless the camera looks along it."""
    sight = solid.center_m - camera_center_m
    approach = sight if solid.kind == "sphere" else sight - (sight @ solid.direction) * solid.direction
    length = float(np.linalg.norm(approach))
    approach = approach / length if length > 0 else np.array([0.0, 0.0, 1.0])
    return solid.center_m - float(solid.radius_at(0.0)) * approach, approach


def _objection(tool: Tool, solid: Primitive, contact_m: Floats) -> str | None:
    """Why a tool does not fit, or None."""
    diameter_mm = 2000 * float(solid.radius_at(0.0))
    length_mm = 1000 * (solid.ends[1] - solid.ends[0])
    low, high = tool.diameter_mm
    if solid.kind not in tool.takes:
        return f"does not take a {solid.kind}"
    if not low <= diameter_mm <= high:
        return f"takes {low:g} to {high:g} mm, the object has {diameter_mm:.1f} mm"
    if length_mm < tool.min_length_over_diameter * diameter_mm:
        return (
            f"needs an object {tool.min_length_over_diameter:g} times as long as thick, "
            f"this one is {length_mm / diameter_mm:.1f} times; draw more of its length if there is more"
        )
    distance_m = float(np.linalg.norm(contact_m))
    if tool.reach_m is not None and distance_m > tool.reach_m:
        return f"reaches {tool.reach_m:g} m, the object is {distance_m:.2f} m away"
    return None


@cache
def default_tools() -> ToolTable:
    """The table that ships with the program: the three tools of paper table 1."""
    return read_tools(Path(__file__).with_name("tools.toml"))


def read_tools(path: Path) -> ToolTable:
    """A tool table from a TOML file; raises ToolTableError naming file, tool, field and remedy."""
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ToolTableError(f"{path}: cannot be read ({error.strerror}); give the path of a tool table") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ToolTableError(f"{path}: is not TOML ({error}); correct it there") from error
    if not entries:
        raise ToolTableError(f"{path}: holds no tool; add a table such as [cutter]")
    tools = tuple(_tool(path, key, entry) for key, entry in entries.items())
    for first, second in combinations(tools, 2):
        if first.name == second.name:
            raise ToolTableError(f"{path}: two tools have the name '{first.name}'; give each a name of its own")
    return tools


def _tool(path: Path, key: str, entry: object) -> Tool:
    """One checked entry of the table."""
    try:
        tool = msgspec.convert(entry, Tool)
    except msgspec.ValidationError as error:
        raise ToolTableError(f"{path}: [{key}]: {error}; {REMEDY}") from error
    low, high = tool.diameter_mm
    if not tool.name.strip():
        raise ToolTableError(f"{path}: [{key}] has no name; give the tool the name an operator knows it by")
    if len(set(tool.takes)) != len(tool.takes) or not tool.takes:
        raise ToolTableError(f"{path}: [{key}] takes {list(tool.takes)}; name at least one kind of object, each once")
    if not all(isfinite(value) for value in msgspec.structs.asdict(tool).values() if isinstance(value, float)):
        raise ToolTableError(f"{path}: [{key}] holds a number that is not finite; leave a limit out that there is not")
    if not (low <= high and isfinite(high)):
        raise ToolTableError(f"{path}: [{key}] diameter_mm [{low:g}, {high:g}] is not a range; give [lowest, highest]")
    if tool.opening_mm is not None and tool.opening_mm < high:
        raise ToolTableError(
            f"{path}: [{key}] opening_mm {tool.opening_mm:g} is less than the {high:g} mm that diameter_mm allows; "
            "widen the opening or lower the diameter"
        )
    return tool

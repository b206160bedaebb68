"""The tools there are: paper table 1 as a table that can be edited."""

import tomllib
from functools import cache
from itertools import combinations
from math import isfinite
from pathlib import Path
from typing import Annotated, get_args

import msgspec

from rotrecon.primitives import Kind

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

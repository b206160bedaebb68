"""What is shown of a result beyond its numbers, worked out once for all pages and panels."""

from functools import lru_cache

from rotrecon.clearance import Clearance
from rotrecon.contact import Place
from rotrecon.free_contact import nearest_free
from rotrecon.grasp import Grasp, clearances_of, grasp_of, shown_tool
from rotrecon.line_stages import Line, line_of
from rotrecon.next_view import NextView, next_view
from rotrecon.overlay import first_cut_line
from rotrecon.reconstruction import Reconstruction
from rotrecon.residuals import Residuals, residuals_of
from rotrecon.tool_table import Tool
from rotrecon.tools import ToolProposal


@lru_cache(maxsize=2)
def clearances_in(result: Reconstruction) -> tuple[Clearance, ...]:
    """Every tool of the table beside the object."""
    return clearances_of(result)


def grasp_in(result: Reconstruction, tool: Tool | None = None) -> Grasp | None:
    """A tool, else the one that is proposed or may fit, at the place that the operator has chosen."""
    tool = tool or shown_tool(result)
    return None if tool is None else _grasp(result, tool)


@lru_cache(maxsize=8)
def _grasp(result: Reconstruction, tool: Tool) -> Grasp | None:
    return grasp_of(result, tool)


@lru_cache(maxsize=2)
def free_place_in(result: Reconstruction) -> Place | None:
    """The nearest place along the axis where the tool that is proposed is free; None where there is none."""
    return nearest_free(result, result.tool.tool) if isinstance(result.tool, ToolProposal) else None


@lru_cache(maxsize=2)
def next_view_in(result: Reconstruction) -> NextView | None:
    """Where the camera should go next."""
    return next_view(result)


@lru_cache(maxsize=2)
def residuals_in(result: Reconstruction) -> Residuals | None:
    """How far the object's pixels lie off the solid."""
    return residuals_of(result)


@lru_cache(maxsize=8)
def line_in(result: Reconstruction, section: int) -> Line | None:
    """The line of pixels that a section was made of, step by step; None if it has none."""
    row = first_cut_line(result, section)
    return None if row is None else line_of(result, row)

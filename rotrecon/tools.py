"""Which tool fits which object: paper table 1 as a table that can be edited."""

from dataclasses import dataclass

from rotrecon.primitives import Kind


@dataclass(frozen=True)
class Tool:
    """One tool and the objects it may be put to; lengths as a person reads them."""

    name: str
    takes: tuple[Kind, ...]
    diameter_mm: tuple[float, float]
    min_length_over_diameter: float = 0.0
    opening_mm: float | None = None
    depth_mm: float | None = None
    reach_m: float | None = None
    dangerous_ok: bool = False


ToolTable = tuple[Tool, ...]

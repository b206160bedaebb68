"""What a reconstruction says, as the one JSON object that every user of the program reads."""

from typing import Any

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.circles import SectionState
from rotrecon.outcome import Fit, FitFailure
from rotrecon.primitives import Frustum, Primitive
from rotrecon.reconstruct import Reconstruction
from rotrecon.tools import NoTool, ToolProposal


def answer(result: Reconstruction) -> dict[str, Any]:
    """Fields and units as the README lists them; lengths in base coordinates. Holds no NaN and no arrays."""
    if isinstance(result.fit, FitFailure) or result.solid is None:
        advice = result.fit.advice if isinstance(result.fit, FitFailure) else ""
        return cannot(advice, result.settings.method) | {"sections": _sections(result)}
    fit, solid = result.fit, result.solid
    return {
        "kind": solid.kind,
        "certain": False,
        "margin": None,
        "concave": fit.concave,
        "diameter_mm": _mm(2 * float(solid.radius_at(0.0))),
        "interval_mm": None,
        "length_mm": _mm(solid.ends[1] - solid.ends[0]) if isinstance(solid, Frustum) else None,
        "center_m": _plain(solid.center_m),
        "axis": _axis(solid),
        "half_angle_deg": round(float(np.degrees(solid.half_angle_rad)), 3) if solid.kind == "cone" else None,
        "profile": _profile(result, fit),
        "rms_mm": _mm(fit.rms_m),
        "arc_deg": round(float(np.degrees(fit.arc_rad)), 1),
        "sections": _sections(result),
        "tool": result.tool.tool.name if isinstance(result.tool, ToolProposal) else None,
        "contact": _contact(result.tool),
        "reasons": list(result.tool.reasons) if isinstance(result.tool, NoTool) else [],
        "candidates": _candidates(result),
        "frame": "base",
        "method": result.settings.method,
    }


def cannot(reason: str, method: str) -> dict[str, Any]:
    """The same object where nothing was measured."""
    nothing = dict.fromkeys(
        ["margin", "diameter_mm", "interval_mm", "length_mm", "center_m", "axis", "half_angle_deg", "rms_mm"]
    )
    return {
        "kind": None,
        "certain": False,
        "concave": False,
        **nothing,
        "profile": [],
        "arc_deg": None,
        "sections": {"used": 0, "dropped": {}},
        "tool": None,
        "contact": None,
        "reasons": [reason],
        "candidates": [],
        "frame": "base",
        "method": method,
    }


def _sections(result: Reconstruction) -> dict[str, Any]:
    """How many sections of the last cut count, and why the others do not."""
    if isinstance(result.fit, Fit):
        state = result.fit.section_state
    else:
        state = (result.second_cut or result.first_cut).circles.state
    count = np.bincount(state, minlength=len(SectionState))
    dropped = {s.name.lower(): int(count[s]) for s in SectionState if s != SectionState.USED and count[s]}
    return {"used": int(count[SectionState.USED]), "dropped": dropped}


def _profile(result: Reconstruction, fit: Fit) -> list[list[float | None]]:
    """Diameter of every used section against its position from `center_m` along the axis."""
    assert result.second_cut is not None
    used = fit.section_state == SectionState.USED
    radius = result.second_cut.circles.radius_m[used]
    return [[_mm(along), _mm(2 * r), None, None] for along, r in zip(fit.along_m[used], radius, strict=True)]


def _candidates(result: Reconstruction) -> list[dict[str, Any]]:
    """The kinds considered; the one that was chosen goes by its own name, rod rather than cylinder."""
    assert result.solid is not None
    is_rod = result.solid.kind == "rod"
    return [
        {
            "kind": "rod" if is_rod and candidate.kind == "cylinder" else candidate.kind,
            "diameter_mm": _mm(2 * candidate.radius_m),
            "score": round(candidate.score, 4),
        }
        for candidate in result.candidates
    ]


def _axis(solid: Primitive) -> dict[str, Any] | None:
    if solid.kind == "sphere":
        return None
    return {"point_m": _plain(solid.center_m), "direction": _plain(solid.direction)}


def _contact(tool: ToolProposal | NoTool) -> dict[str, Any] | None:
    if isinstance(tool, NoTool):
        return None
    return {"point_m": _plain(tool.contact_point_m), "approach": _plain(tool.approach)}


def _mm(metres: float) -> float:
    """Millimetres to the micrometre."""
    return round(float(metres) * 1000, 3)


def _plain(vector: Floats) -> list[float]:
    """A vector as JSON holds it, to a nanometre."""
    return [round(float(x), 9) for x in vector]

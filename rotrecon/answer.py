"""What a reconstruction says, as the one JSON object that every user of the program reads."""

from typing import Any

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.circles import SectionState
from rotrecon.frame import StereoEvidence
from rotrecon.outcome import Evidence, Fit, FitFailure, Intervals, PartOf
from rotrecon.primitives import Primitive, Sphere
from rotrecon.reconstruction import Reconstruction
from rotrecon.tools import NoTool, ToolProposal

NOTHING: dict[str, Any] = dict.fromkeys(
    [
        "margin", "diameter_mm", "interval_mm", "length_mm", "length_interval_mm", "ends", "center_m",
        "center_interval_mm", "axis", "axis_interval_deg", "half_angle_deg", "half_angle_interval_deg", "rms_mm",
        "arc_deg", "parts", "inlier_share", "sigma_over_radius", "noise", "stereo", "stroke_px", "tool", "contact",
    ]
)  # fmt: skip
"""The fields that are null where they are not known."""


def answer(result: Reconstruction) -> dict[str, Any]:
    """Fields and units as the README lists them; lengths in base coordinates. Holds no NaN and no arrays."""
    if isinstance(result.fit, FitFailure) or result.solid is None:
        advice = result.fit.advice if isinstance(result.fit, FitFailure) else ""
        known = {"sections": _sections(result), "stroke_px": _stroke(result)}
        return cannot(advice, result.settings.method) | known
    fit, solid = result.fit, result.solid
    return {
        **NOTHING,
        "kind": solid.kind,
        "certain": fit.evidence is not None and fit.evidence.certain,
        "concave": fit.concave,
        "diameter_mm": _mm(2 * float(solid.radius_at(0.0))),
        "length_mm": None if isinstance(solid, Sphere) else _mm(solid.ends[1] - solid.ends[0]),
        "center_m": _plain(solid.center_m),
        "axis": _axis(solid),
        "half_angle_deg": _degrees(solid.half_angle_rad) if solid.kind == "cone" else None,
        **_intervals(fit.intervals),
        **_evidence(fit.evidence),
        "stereo": _stereo(result.frame.stereo),
        "profile": _profile(result, fit),
        "rms_mm": _mm(fit.rms_m),
        "arc_deg": round(float(np.degrees(fit.arc_rad)), 1),
        "sections": _sections(result),
        "stroke_px": _stroke(result),
        "tool": result.tool.tool.name if isinstance(result.tool, ToolProposal) else None,
        "contact": _contact(result.tool),
        "reasons": list(result.tool.reasons if isinstance(result.tool, NoTool) else result.tool.unsure),
        "candidates": _candidates(result),
        "frame": "base",
        "method": result.settings.method,
    }


def cannot(reason: str, method: str) -> dict[str, Any]:
    """The same object where nothing was measured."""
    return {
        **NOTHING,
        "kind": None,
        "certain": False,
        "concave": False,
        "profile": [],
        "sections": {"used": 0, "dropped": {}},
        "reasons": [reason],
        "candidates": [],
        "frame": "base",
        "method": method,
    }


def _stroke(result: Reconstruction) -> list[list[float]]:
    """Start and end of what was measured along: the axis as it was drawn, put right or proposed."""
    stroke = result.drawing.stroke
    return [[float(value) for value in end] for end in (stroke.start_px, stroke.end_px)]


def _intervals(intervals: Intervals | None) -> dict[str, Any]:
    """95 % intervals: [low, high] of sizes, one radius about the middle and about the axis."""
    if intervals is None:
        return {}
    direction, angle, length = intervals.direction_rad, intervals.half_angle_rad, intervals.length_m
    return {
        "interval_mm": [_mm(value) for value in intervals.diameter_m],
        "length_interval_mm": None if length is None else [_mm(value) for value in length],
        "center_interval_mm": _mm(intervals.center_m),
        "axis_interval_deg": None if direction is None else _degrees(direction),
        "half_angle_interval_deg": None if angle is None else [_degrees(value) for value in angle],
    }


def _evidence(evidence: Evidence | None) -> dict[str, Any]:
    """What the robust method rests on."""
    if evidence is None:
        return {}
    ends, px = evidence.open_ends, evidence.noise_px
    return {
        "margin": round(evidence.margin, 4),
        "ends": None if ends is None else {"start": _end(ends[0]), "end": _end(ends[1])},
        "parts": [_part(part) for part in evidence.parts],
        "inlier_share": round(evidence.inlier_share, 4),
        "sigma_over_radius": round(evidence.sigma_over_radius, 6),
        "noise": {
            "sigma_mm": _mm(evidence.noise_m),
            "disparity_sigma_px": None if px is None else round(px, 4),
            "correlation_px": round(evidence.correlation_px, 2),
            "stated": evidence.noise_stated,
        },
    }


def _stereo(evidence: StereoEvidence | None) -> dict[str, Any] | None:
    """What the depth was matched from; views counted from 1, the first being the reference."""
    if evidence is None:
        return None
    error_px = evidence.epipolar_error_px
    return {
        "views": [1, *(number + 1 for number in evidence.pairs)],
        "left_out": list(evidence.left_out),
        "epipolar_error_px": None if error_px is None else round(error_px, 3),
        "valid_share": round(evidence.valid_share, 4),
        "window_px": evidence.window_px,
    }


def _part(part: PartOf) -> dict[str, Any]:
    """One of the pieces along the axis, positions from `center_m`."""
    angle = _degrees(part.half_angle_rad) if part.kind == "cone" else None
    return {
        "kind": part.kind,
        "from_mm": _mm(part.ends_m[0]),
        "to_mm": _mm(part.ends_m[1]),
        "diameter_mm": _mm(part.diameter_m),
        "interval_mm": [_mm(end) for end in part.diameter_interval_m],
        "half_angle_deg": angle,
    }


def _end(is_open: bool) -> str:
    return "open" if is_open else "closed"


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
    along, radius = fit.along_m[used], result.second_cut.circles.radius_m[used]
    if fit.evidence is None:
        return [[_mm(h), _mm(2 * r), None, None] for h, r in zip(along, radius, strict=True)]
    low, high = fit.evidence.radius_low_m[used], fit.evidence.radius_high_m[used]
    return [[_mm(h), *(_mm(2 * r) for r in of)] for h, *of in zip(along, radius, low, high, strict=True)]


def _candidates(result: Reconstruction) -> list[dict[str, Any]]:
    """The kinds considered; the one that was chosen goes by its own name, rod rather than cylinder."""
    assert result.solid is not None
    is_rod = result.solid.kind == "rod"
    return [
        {
            "kind": "rod" if is_rod and candidate.kind == "cylinder" else candidate.kind,
            "diameter_mm": _mm(2 * candidate.radius_m),
            "interval_mm": None if candidate.diameter_m is None else [_mm(end) for end in candidate.diameter_m],
            "half_angle_deg": _degrees(candidate.half_angle_rad) if candidate.kind == "cone" else None,
            "score": round(candidate.score, 4),
            "possible": candidate.possible,
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


def _degrees(radians: float) -> float:
    """Degrees to a thousandth."""
    return round(float(np.degrees(radians)), 3)


def _plain(vector: Floats) -> list[float]:
    """A vector as JSON holds it, to a nanometre."""
    return [round(float(x), 9) for x in vector]

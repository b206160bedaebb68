"""A decision as a file: report, everything as JSON, sections, points, or the solid."""

import json
from collections.abc import Callable
from dataclasses import asdict
from typing import Any, Literal, get_args

from app.record.entries import Written
from app.record.evidence import Decision
from app.report.points import points_ply
from app.report.report import report_html
from app.report.sections import sections_csv
from rotrecon.mesh import as_mesh
from rotrecon.primitives import Primitive

ExportFormat = Literal["html", "json", "csv", "ply", "glb", "stl"]
FORMAT = 1
"""Of the JSON file."""


class NothingToExport(Exception):
    """The decision has nothing of the kind that was asked for; the message says why."""


def export_decision(decision: Decision, kind: ExportFormat) -> bytes:
    """The content of a file of one of the formats; lengths in metres, base coordinates, unless a name says otherwise.

    Raises NothingToExport for the solid or the sections of a measurement that has none.
    """
    writers: dict[ExportFormat, Callable[[Decision], bytes]] = {
        "html": lambda decision: report_html(decision).encode(),
        "json": decision_json,
        "csv": _csv,
        "ply": lambda decision: points_ply(decision.replay.result),
        "glb": lambda decision: _mesh(decision, "glb"),
        "stl": lambda decision: _mesh(decision, "stl"),
    }
    return writers[kind](decision)


def file_name(number: int, kind: str) -> str:
    """What an export is called where nobody says otherwise."""
    assert kind in get_args(ExportFormat)
    return f"rotrecon-{number}.{kind}"


def decision_json(decision: Decision) -> bytes:
    """The entry and those of the same evidence as they were written, the head, and what computing it again gave."""
    replay = decision.replay
    content = {
        "format": FORMAT,
        "head": str(decision.head),
        "entry": _entry(decision.entry),
        "trail": [_entry(entry) for entry in decision.trail],
        "replay": {
            "same": replay.same,
            "numbers": replay.numbers,
            "differences": [asdict(one) for one in replay.differences],
            "versions": [asdict(one) for one in replay.versions],
        },
    }
    return json.dumps(content, indent=1, allow_nan=False).encode()


def _entry(written: Written) -> dict[str, Any]:
    return {"hash": written.hash, **written.content}


def _csv(decision: Decision) -> bytes:
    result = decision.replay.result
    if result.second_cut is None or result.sections is None:
        raise NothingToExport(f"entry {decision.entry.id} has no sections: {decision.evidence.answer['reasons'][0]}")
    return sections_csv(result, result.sections, result.second_cut.circles)


def _mesh(decision: Decision, kind: Literal["glb", "stl"]) -> bytes:
    solid: Primitive | None = decision.replay.result.solid
    if solid is None:
        raise NothingToExport(f"entry {decision.entry.id} has no solid: {decision.evidence.answer['reasons'][0]}")
    content = as_mesh(solid).export(file_type=kind)
    assert isinstance(content, bytes)
    return content

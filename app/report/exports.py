"""A decision as a file: report, everything as JSON, sections, points, or the solid."""

import json
from typing import Any, Literal, get_args

from app.record.entries import Written
from app.record.evidence import Decision, decision_of
from app.record.store import Record
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


def export_entry(record: Record, number: int, kind: ExportFormat) -> bytes:
    """The content of a file of one of the formats; lengths in metres, base coordinates, unless a name says otherwise.

    All but JSON are made by computing the entry again. Raises NoSuchEntry, NothingToExport for the solid or the
    sections of a measurement that has none, DrawingError for one that is refused today, and StoreError.
    """
    return entry_json(record, number) if kind == "json" else export_decision(decision_of(record, number), kind)


def export_decision(decision: Decision, kind: Literal["html", "csv", "ply", "glb", "stl"]) -> bytes:
    """The same of a decision that was read."""
    match kind:
        case "html":
            return report_html(decision).encode()
        case "csv":
            return _csv(decision)
        case "ply":
            return points_ply(decision.replay.result)
        case "glb" | "stl":
            return _mesh(decision, kind)


def file_name(number: int, kind: str) -> str:
    """What an export is called where nobody says otherwise."""
    assert kind in get_args(ExportFormat)
    return f"rotrecon-{number}.{kind}"


def entry_json(record: Record, number: int) -> bytes:
    """An entry and all of the same evidence as they were written, and the head; raises NoSuchEntry."""
    written = record.entry(number)
    digest = written.content["digest"]
    trail = (written,) if digest is None else record.entries(digest=digest)
    content = {
        "format": FORMAT,
        "head": str(record.head),
        "entry": _as_exported(written),
        "trail": [_as_exported(entry) for entry in trail],
    }
    return json.dumps(content, indent=1, allow_nan=False).encode()


def _as_exported(written: Written) -> dict[str, Any]:
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

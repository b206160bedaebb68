"""The result as HTML: its numbers are those of `rotrecon.answer`, and every text from outside is escaped."""

from collections.abc import Sequence
from html import escape
from typing import Any

from app.answers import answer_of
from app.hints import hint, warning
from app.origins import field_named, from_
from app.session import Session, sentence
from app.wording import candidate_row, certainty, from_to, measured, open_ends, rests_on
from rotrecon.outcome import Fit
from rotrecon.primitives import in_words
from rotrecon.reconstruction import Reconstruction
from rotrecon.tool_table import Tool
from rotrecon.tools import NoTool, ToolProposal

REASONS = {
    "empty": "no pixel segmented",
    "too_few_pixels": "too few pixels",
    "collinear": "flat",
    "excluded": "excluded by hand",
    "odd_radius": "odd radius",
}
"""Why a section was dropped, as a person says it."""
FIELD = '<div class="rr-field" {origin}><span>{name}</span><b data-field="{key}" data-value="{exact}">{text}</b></div>'


def hint_html(session: Session, led: str | None = None, progress: str = "") -> str:
    """What to do next; amber when something is wrong with what is shown.

    `led` is what a tour says, and follows a warning about a result that is there all the same; `progress` is its HTML.
    """
    warned = warning(session)
    text = hint(session, led)
    if led is not None and warned is not None and session.reconstruction and session.reconstruction.solid:
        text = f"{warned} {led}"
    style = "rr-hint" if warned is None else "rr-hint rr-amber"
    return f'<div class="{style}" data-testid="hint" {from_("reasons")}>{escape(text)}</div>{progress}'


def result_html(session: Session) -> str:
    """The result in numbers: class, diameter, size, quality and the tool; dimmed while a new one is on its way."""
    result = session.reconstruction
    if result is None or result.solid is None:
        nothing = "Nothing measured yet." if session.measured is None else "Not measured"
        return (
            '<div class="rr-result" data-testid="result" data-revision="-1">'
            '<div class="rr-big rr-dim">&oslash; &ndash; mm</div>'
            f'<div class="rr-small">{nothing}</div></div>'
        )
    content = answer_of(result)
    revision = session.measured.revision if session.measured is not None else -1
    dim = "" if session.up_to_date else " rr-dim"
    concave = ", seen from inside" if content["concave"] else ""
    return (
        f'<div class="rr-result{dim}" data-testid="result" data-revision="{revision}">'
        f'<div class="rr-head"><div class="rr-big" data-field="diameter_mm" data-value="{content["diameter_mm"]}" '
        f"{from_('diameter_mm', 'interval_mm')}>"
        f"&oslash; {measured(content['diameter_mm'], content['interval_mm'], ' mm')}</div>"
        f'<div class="rr-kind" data-field="kind" data-value="{content["kind"]}">'
        f"{in_words(content['kind'])}{concave}</div></div>"
        f"{_certainty(content)}"
        f'<div class="rr-grid">{_fields(content)}</div>{_tool(session, result, content)}</div>'
    )


def _certainty(content: dict[str, Any]) -> str:
    """The interval by its ends, and whether the kind is certain: amber where it is not."""
    text, interval = escape(certainty(content)), content["interval_mm"]
    if interval is None:
        return f'<div {from_("certain")} class="rr-small" data-field="certain" data-value="false">{text}</div>'
    style = "rr-sure" if content["certain"] else "rr-unsure"
    return (
        f'<div class="rr-doubt"><span data-field="interval_mm" data-value="{interval}" {from_("interval_mm")}>'
        f"{from_to(interval, ' mm')} (95 %)</span>"
        f'<span {from_("certain")} class="{style}" data-field="certain" '
        f'data-value="{str(content["certain"]).lower()}">{text}</span></div>'
    )


def _tool(session: Session, result: Reconstruction, content: dict[str, Any]) -> str:
    """The tool, or whether it is the size or the choice that is doubtful."""
    tool = content["tool"]
    if tool and not session.proposal_told:
        return '<div class="rr-tool rr-dim" data-field="tool" data-value="">Tool: see &ldquo;Decision&rdquo;</div>'
    unsure = "not sure, " if isinstance(result.tool, NoTool) and result.tool.unsure else ""
    doubt = "doubtful, " if _doubts(result) else unsure
    text = f"<b>{escape(tool)}</b>" if tool else f"<b>No tool</b> &ndash; {doubt}see &ldquo;Why&rdquo;"
    exact = escape(tool or "")
    return f'<div class="rr-tool" data-field="tool" data-value="{exact}" {from_("tool")}>Tool: {text}</div>'


def why_html(session: Session) -> str:
    """What the result rests on: candidates, noise, dropped sections, every tool, and the paper's two cuts."""
    result = session.reconstruction
    if result is None:
        text = escape(warning(session) or "Draw an area and an axis first.")
        return f'<div class="rr-why rr-dim" {from_("reasons")}>{text}</div>'
    content = answer_of(result)
    doubts = _doubts(result)
    blocks = [("Why not", _list(content["reasons"]))] if content["kind"] is None else []
    if doubts:
        blocks.append(("Doubts", _list([sentence(doubt) for doubt in doubts])))
    if content["kind"] is not None:
        blocks += _evidence(result, content)
    dropped = content["sections"]["dropped"].items()
    rows = [("used", str(content["sections"]["used"]))] + [(REASONS.get(str(k), str(k)), str(n)) for k, n in dropped]
    blocks.append(("Sections", _table(rows, "sections_used")))
    if content["kind"] is not None and not doubts and (session.proposal_told or content["tool"] is None):
        blocks.append(("Tools", _tools(result, content["reasons"])))
    return '<div class="rr-why" data-testid="why">' + "".join(f"<h4>{n}</h4>{body}" for n, body in blocks) + "</div>"


def _evidence(result: Reconstruction, content: dict[str, Any]) -> list[tuple[str, str]]:
    """What the diameter rests on: the paper's other cut, the kinds considered, and how well it is known."""
    margin = "" if content["margin"] is None else f" <span {from_('margin')}>(margin {content['margin']:.2g})</span>"
    candidates = _table([candidate_row(one) for one in content["candidates"]], "kind", "diameter_mm", "score", "margin")
    blocks = [*_by_cut(result, content["diameter_mm"]), (f"Candidates, by score{margin}", candidates)]
    known = "".join(_table([row], field_named(row[0])) for row in rests_on(content))
    return [*blocks, ("How well it is known", known)] if known else blocks


def _by_cut(result: Reconstruction, diameter_mm: float) -> list[tuple[str, str]]:
    """The paper's two cuts side by side; nothing where there are none."""
    if result.first_cut_radius_m is None:
        return []
    cuts = {"Across the drawn axis": 2000 * result.first_cut_radius_m, "Across the axis in space": diameter_mm}
    return [("Diameter by the cut", _table([(name, f"{value:.1f} mm") for name, value in cuts.items()], "by_cut"))]


def _doubts(result: Reconstruction) -> tuple[str, ...]:
    return result.fit.doubts if isinstance(result.fit, Fit) else ()


def _fields(content: dict[str, Any]) -> str:
    """The smaller numbers, exact values beside the rounded ones."""
    dropped = sum(content["sections"]["dropped"].values())
    at_least, length = ("&ge; ", None) if open_ends(content) else ("", content["length_interval_mm"])
    fields = [
        ("Length", "length_mm", at_least, length, " mm", 0),
        ("Half angle", "half_angle_deg", "", content["half_angle_interval_deg"], "&deg;", 1),
        ("RMS", "rms_mm", "", None, " mm", 2),
        ("Arc seen", "arc_deg", "", None, "&deg;", 0),
    ]
    cells = [
        FIELD.format(
            name=name,
            key=key,
            exact=content[key],
            text=before + measured(content[key], interval, unit, decimals),
            origin=from_(key),
        )
        for name, key, before, interval, unit, decimals in fields
        if content[key] is not None
    ]
    sections = f"{content['sections']['used']} of {content['sections']['used'] + dropped}"
    exact = content["sections"]["used"]
    origin = from_("sections_used")
    return "".join(cells) + FIELD.format(
        name="Sections", key="sections_used", exact=exact, text=sections, origin=origin
    )


def _tools(result: Reconstruction, reasons: list[str]) -> str:
    """The tool that fits, with those before it that may fit too; or why none does."""
    if isinstance(result.tool, ToolProposal):
        reasons = [f"{_name(result.tool.tool)} fits: it takes {', '.join(result.tool.tool.takes)}.", *reasons]
    return _list(reasons)


def _name(tool: Tool) -> str:
    low, high = tool.diameter_mm
    return f"{tool.name} ({low:g} to {high:g} mm)"


def _list(items: list[str]) -> str:
    return f"<ul {from_('reasons')}>" + "".join(f"<li>{escape(item)}</li>" for item in items) + "</ul>"


def _table(rows: Sequence[tuple[str, ...]], *fields: str) -> str:
    """Rows of numbers that come from these fields."""
    cells = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows)
    return f"<table {from_(*fields)}>" + "".join(f"<tr>{row}</tr>" for row in cells) + "</table>"

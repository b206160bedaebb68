"""The result as HTML: its numbers are those of `rotrecon.answer`, and every text from outside is escaped."""

from collections.abc import Sequence
from functools import lru_cache
from html import escape
from typing import Any

from app.hints import hint, warning
from app.session import Session, sentence
from rotrecon.answer import answer
from rotrecon.outcome import Fit
from rotrecon.reconstruct import Reconstruction
from rotrecon.tool_table import Tool
from rotrecon.tools import ToolProposal

REASONS = {
    "empty": "no pixel segmented",
    "too_few_pixels": "too few pixels",
    "collinear": "flat",
    "excluded": "excluded by hand",
    "odd_radius": "odd radius",
}
"""Why a section was dropped, as a person says it."""
FIELD = '<div class="rr-field"><span>{name}</span><b data-field="{key}" data-value="{exact}">{text}</b></div>'


def hint_html(session: Session) -> str:
    """What to do next; amber when something is wrong with what is shown."""
    style = "rr-hint" if warning(session) is None else "rr-hint rr-amber"
    return f'<div class="{style}" data-testid="hint">{escape(hint(session))}</div>'


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
    content = _answer(result)
    revision = session.measured.revision if session.measured is not None else -1
    dim = "" if session.up_to_date else " rr-dim"
    concave = ", seen from inside" if content["concave"] else ""
    tool = content["tool"]
    doubtful = "doubtful, " if _doubts(result) else ""
    tool_text = f"<b>{escape(tool)}</b>" if tool else f"<b>No tool</b> &ndash; {doubtful}see &ldquo;Why&rdquo;"
    return (
        f'<div class="rr-result{dim}" data-testid="result" data-revision="{revision}">'
        f'<div class="rr-head"><div class="rr-big" data-field="diameter_mm" data-value="{content["diameter_mm"]}">'
        f"&oslash; {content['diameter_mm']:.1f} mm</div>"
        f'<div class="rr-kind" data-field="kind" data-value="{content["kind"]}">{content["kind"]}{concave}</div></div>'
        f'<div class="rr-small">{_interval(content)}</div>'
        f'<div class="rr-grid">{_fields(content)}</div>'
        f'<div class="rr-tool" data-field="tool" data-value="{escape(tool or "")}">Tool: {tool_text}</div></div>'
    )


def why_html(session: Session) -> str:
    """What the result rests on: first cut beside second cut, candidates, dropped sections, and every tool."""
    result = session.reconstruction
    if result is None:
        return f'<div class="rr-why rr-dim">{escape(warning(session) or "Draw an area and an axis first.")}</div>'
    content = _answer(result)
    doubts = _doubts(result)
    blocks = [("Why not", _list(content["reasons"]))] if content["kind"] is None else []
    if doubts:
        blocks.append(("Doubts", _list([sentence(doubt) for doubt in doubts])))
    if content["kind"] is not None:
        first_mm = 0.0 if result.first_cut_radius_m is None else 2000 * result.first_cut_radius_m
        cuts = [("Across the drawn axis", first_mm), ("Across the axis in space", content["diameter_mm"])]
        blocks.append(("Diameter by the cut", _table([(name, f"{value:.1f} mm") for name, value in cuts if value])))
        rows = [(c["kind"], f"{c['diameter_mm']:.1f} mm", f"{c['score']:.2f}") for c in content["candidates"]]
        blocks.append(("Candidates, by score", _table(rows)))
    dropped = content["sections"]["dropped"].items()
    rows = [("used", str(content["sections"]["used"]))] + [(REASONS.get(str(k), str(k)), str(n)) for k, n in dropped]
    blocks.append(("Sections", _table(rows)))
    if content["kind"] is not None and not doubts:
        blocks.append(("Tools", _tools(result, content["reasons"])))
    return '<div class="rr-why" data-testid="why">' + "".join(f"<h4>{n}</h4>{body}" for n, body in blocks) + "</div>"


@lru_cache(maxsize=2)
def _answer(result: Reconstruction) -> dict[str, Any]:
    """The answer, worked out once for all texts that are made of it."""
    return answer(result)


def _doubts(result: Reconstruction) -> tuple[str, ...]:
    return result.fit.doubts if isinstance(result.fit, Fit) else ()


def _interval(content: dict[str, Any]) -> str:
    if content["interval_mm"] is None:
        return "not certain, no interval: the paper&rsquo;s method has no measure of either"
    low, high = content["interval_mm"]
    return f"{low:.1f} to {high:.1f} mm (95 %)"


def _fields(content: dict[str, Any]) -> str:
    """The smaller numbers, exact values beside the rounded ones."""
    dropped = sum(content["sections"]["dropped"].values())
    fields = [
        ("Length", "length_mm", "{:.0f} mm"),
        ("Half angle", "half_angle_deg", "{:.1f}&deg;"),
        ("RMS", "rms_mm", "{:.2f} mm"),
        ("Arc seen", "arc_deg", "{:.0f}&deg;"),
    ]
    cells = [
        FIELD.format(name=name, key=key, exact=content[key], text=form.format(content[key]))
        for name, key, form in fields
        if content[key] is not None
    ]
    sections = f"{content['sections']['used']} of {content['sections']['used'] + dropped}"
    exact = content["sections"]["used"]
    return "".join(cells) + FIELD.format(name="Sections", key="sections_used", exact=exact, text=sections)


def _tools(result: Reconstruction, reasons: list[str]) -> str:
    """The tool that fits, or why each does not."""
    if isinstance(result.tool, ToolProposal):
        return _list([f"{_name(result.tool.tool)} fits: it takes {', '.join(result.tool.tool.takes)}."])
    return _list(reasons)


def _name(tool: Tool) -> str:
    low, high = tool.diameter_mm
    return f"{tool.name} ({low:g} to {high:g} mm)"


def _list(items: list[str]) -> str:
    return "<ul>" + "".join(f"<li>{escape(item)}</li>" for item in items) + "</ul>"


def _table(rows: Sequence[tuple[str, ...]]) -> str:
    cells = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows)
    return "<table>" + "".join(f"<tr>{row}</tr>" for row in cells) + "</table>"

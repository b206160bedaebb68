"""The report of a decision: one HTML file that needs nothing else."""

from functools import cache
from math import degrees
from typing import Any

import jinja2
from markupsafe import Markup

from app.charts import section_count
from app.inspection import clearances_in
from app.record.evidence import Decision, said_with
from app.report.chart import sections_svg
from app.report.doings import decided_tool, doing
from app.report.pictures import report_pictures
from app.section_drawing import section_svg, section_text
from app.static_files import static_text
from app.tool_text import clearance_text
from app.wording import candidate_row, certainty, from_to, measured, open_ends, rests_on
from rotrecon.contact import PROPOSED, Place
from rotrecon.outcome import Fit
from rotrecon.primitives import in_words
from rotrecon.reconstruction import Reconstruction

TITLES = {
    "proposal": "Proposal, not confirmed",
    "refusal": "No tool",
    "armed": "Armed, not confirmed",
    "disarmed": "Disarmed, not confirmed",
    "confirmed": "Confirmed",
    "rejected": "Rejected",
    "overridden": "Confirmed against the program's answer",
    "voided": "Void",
    "declined": "An action that was not accepted",
}


def report_html(decision: Decision) -> str:
    """Pictures, sections, numbers with intervals and doubts, candidates, tools, who, when, digest and versions.

    Numbers are the recorded ones; pictures and sections are drawn from the measurement computed again, and where that
    came out another way the report begins with it.
    """
    result, answer, content = decision.replay.result, decision.evidence.answer, decision.entry.content
    tool = decided_tool(decision.entry, answer)
    return _template().render(
        title=TITLES[content["kind"]],
        decision=decision,
        content=content,
        answer=answer,
        numbers=[*_numbers(answer), *_placed(decision.evidence.drawing.contact)],
        doubts=result.fit.doubts if isinstance(result.fit, Fit) else (),
        tool=tool,
        words=doing(decision.entry),
        in_the_way=said_with(decision.evidence.entry).get("in_the_way"),
        pictures=[(caption, Markup(url)) for caption, url in report_pictures(result, tool)],
        chart=Markup(sections_svg(result)),
        section=_section(result),
        candidates=[candidate_row(one) for one in answer["candidates"]],
        tools=_tools(result, answer),
        trail=[(entry, entry.content, doing(entry)) for entry in decision.trail],
    )


@cache
def _template() -> jinja2.Template:
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    return environment.from_string(static_text("report.html"))


def _numbers(answer: dict[str, Any]) -> list[tuple[str, str]]:
    """Names with values and their 95 % intervals, without those that are not known."""
    if answer["kind"] is None:
        return []
    interval, angle = answer["interval_mm"], answer["half_angle_deg"]
    rows = [
        ("kind", in_words(answer["kind"]) + (", seen from inside" if answer["concave"] else "")),
        ("how sure the kind is", certainty(answer)),
        ("diameter", measured(answer["diameter_mm"], interval, " mm")),
        ("diameter, 95 %", None if interval is None else from_to(interval, " mm")),
        ("length", _length(answer)),
        ("half angle", None if angle is None else measured(angle, answer["half_angle_interval_deg"], "°")),
        ("middle", _vector(answer["center_m"], " m in base coordinates")),
        ("axis", None if answer["axis"] is None else _vector(answer["axis"]["direction"], " in base coordinates")),
        (
            "contact point",
            answer["contact"] and _vector(answer["contact"]["point_m"], " m in base coordinates"),
        ),
        ("approach", answer["contact"] and _vector(answer["contact"]["approach"], " in base coordinates")),
        ("arc seen", f"{answer['arc_deg']:.0f}°"),
        ("pixels lie off it (RMS)", f"{answer['rms_mm']:.2f} mm"),
        *rests_on(answer),
    ]
    return [(name, text) for name, text in rows if text is not None]


def _placed(place: Place) -> list[tuple[str, str]]:
    """How the operator has moved the contact; nothing where it is the proposed one."""
    if place == PROPOSED:
        return []
    along_mm = 1000 * place.along_m
    return [("contact as placed", f"turned by {degrees(place.angle_rad):.0f}°, {along_mm:+.0f} mm along the axis")]


def _length(answer: dict[str, Any]) -> str | None:
    if answer["length_mm"] is None:
        return None
    beyond = open_ends(answer)
    if beyond:
        return f"at least {answer['length_mm']:.0f} mm: it goes on beyond the area at its {' and its '.join(beyond)}"
    return measured(answer["length_mm"], answer["length_interval_mm"], " mm", 0)


def _vector(numbers: list[float], of: str) -> str:
    return ", ".join(f"{number:.4f}" for number in numbers) + of


def _section(result: Reconstruction) -> tuple[str, Markup] | None:
    """The section in the middle, in words and in its own plane."""
    middle = section_count(result) // 2
    drawn = section_svg(result, middle)
    return (section_text(result, middle), Markup(drawn)) if drawn else None


def _tools(result: Reconstruction, answer: dict[str, Any]) -> list[tuple[str, str, str, str]]:
    """Every tool of the table: its name, what it takes, what was said of it, and the room that it leaves."""
    judged = {one.tool.name: one for one in clearances_in(result)}
    rows: list[tuple[str, str, str, str]] = []
    for tool in result.settings.tools:
        takes = f"{', '.join(map(in_words, tool.takes))} of {tool.diameter_mm[0]:g} to {tool.diameter_mm[1]:g} mm"
        one = judged.get(tool.name)
        if one is None:
            rows.append((tool.name, takes, "nothing was measured", ""))
            continue
        verdict = one.why or ("fits, proposed" if tool.name == answer["tool"] else "fits")
        rows.append((tool.name, takes, verdict, "" if one.verdict == "ruled out" else clearance_text(one)))
    return rows

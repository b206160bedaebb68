"""The report of a decision: one HTML file that needs nothing else."""

from functools import cache
from typing import Any

import jinja2
from markupsafe import Markup

from app.record.entries import Written
from app.record.evidence import Decision, said_with
from app.report.chart import sections_svg
from app.report.pictures import report_pictures
from app.static_files import static_text
from app.wording import candidate_row, certainty, from_to, measured, open_ends, rests_on
from rotrecon.outcome import Fit
from rotrecon.primitives import in_words
from rotrecon.settings import Settings

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
    return _template().render(
        title=TITLES[content["kind"]],
        decision=decision,
        content=content,
        answer=answer,
        numbers=_numbers(answer),
        doubts=result.fit.doubts if isinstance(result.fit, Fit) else (),
        pictures=[(caption, Markup(url)) for caption, url in report_pictures(result)],
        chart=Markup(sections_svg(result)),
        candidates=[candidate_row(one) for one in answer["candidates"]],
        tools=_tools(decision.evidence.settings, answer),
        trail=[(entry, entry.content, _said(entry)) for entry in decision.trail],
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
        ("whether it is", certainty(answer)),
        ("diameter", measured(answer["diameter_mm"], interval, " mm")),
        ("diameter, 95 %", None if interval is None else from_to(interval, " mm")),
        ("length", _length(answer)),
        ("half angle", None if angle is None else measured(angle, answer["half_angle_interval_deg"], "°")),
        ("middle", _vector(answer["center_m"], " m in base coordinates")),
        ("axis", None if answer["axis"] is None else _vector(answer["axis"]["direction"], " in base coordinates")),
        ("contact point", answer["contact"] and _vector(answer["contact"]["point_m"], " m in base coordinates")),
        ("approach", answer["contact"] and _vector(answer["contact"]["approach"], " in base coordinates")),
        ("arc seen", f"{answer['arc_deg']:.0f}°"),
        ("pixels lie off it (RMS)", f"{answer['rms_mm']:.2f} mm"),
        *rests_on(answer),
    ]
    return [(name, text) for name, text in rows if text is not None]


def _length(answer: dict[str, Any]) -> str | None:
    if answer["length_mm"] is None:
        return None
    beyond = open_ends(answer)
    if beyond:
        return f"at least {answer['length_mm']:.0f} mm: it goes on beyond the area at its {' and its '.join(beyond)}"
    return measured(answer["length_mm"], answer["length_interval_mm"], " mm", 0)


def _vector(numbers: list[float], of: str) -> str:
    return ", ".join(f"{number:.4f}" for number in numbers) + of


def _tools(settings: Settings, answer: dict[str, Any]) -> list[tuple[str, str, str]]:
    """Every tool of the table: its name, what it takes, and what was said of it."""
    said = {tool.name: reason for tool in settings.tools for reason in answer["reasons"] if _is_of(reason, tool.name)}
    rows: list[tuple[str, str, str]] = []
    for tool in settings.tools:
        verdict = said[tool.name].removeprefix(f"{tool.name}: ") if tool.name in said else "not asked"
        takes = f"{', '.join(tool.takes)} of {tool.diameter_mm[0]:g} to {tool.diameter_mm[1]:g} mm"
        rows.append((tool.name, takes, "fits" if tool.name == answer["tool"] else verdict))
    return rows


def _is_of(reason: str, name: str) -> bool:
    return reason.startswith(f"{name}: ")


def _said(entry: Written) -> str:
    """What a person said with an entry, or the program."""
    return "; ".join(f"{name}: {value}" for name, value in said_with(entry).items())

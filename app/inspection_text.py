"""Residuals, candidates and distances in words, as HTML."""

from collections.abc import Sequence
from html import escape
from typing import Any

from app.answers import answer_of
from app.object_drawing import Pixel
from app.origins import from_
from app.wording import candidate_name, measured
from rotrecon.distance import distance_between
from rotrecon.frame import Frame
from rotrecon.reconstruction import Reconstruction
from rotrecon.residuals import BEFORE, BEHIND, BETWEEN, Residuals

LARGEST_ODDS = 1000
EXCLUDED_TIMES = 99.0
"""How much less credible an excluded kind is: `Settings.excluded_cost` as odds. What is excluded by less makes no
difference."""


def residuals_html(residuals: Residuals | None) -> str:
    """The scale of the residuals' colours; nothing where none are shown."""
    if residuals is None:
        return ""
    end_mm = f"{1000 * residuals.scale_m:g} mm"
    colors = ", ".join(f"rgb{color}" for color in (BEHIND, BETWEEN, BEFORE))
    off_mm = 1000 * float((residuals.off_m**2).mean() ** 0.5)
    return (
        f'<div class="rr-caption" data-testid="residuals" {from_("residuals", "rms_mm")}>'
        f'<div class="rr-bar" style="background: linear-gradient(to right, {colors})"></div>'
        f'<div class="rr-ends"><span>{end_mm} inside</span><span>on the solid</span><span>{end_mm} outside</span></div>'
        f"{len(residuals.off_m)} pixels, {off_mm:.2f} mm off (RMS).</div>"
    )


def candidates_html(result: Reconstruction | None) -> str:
    """The kinds considered, side by side, with what speaks for and against each."""
    content = {} if result is None else answer_of(result)
    candidates: list[dict[str, Any]] = content.get("candidates", [])
    if not candidates:
        return ""
    rows = [("", [escape(candidate_name(one)) for one in candidates])]
    rows.append(("diameter", [escape(measured(one["diameter_mm"], one["interval_mm"], " mm")) for one in candidates]))
    rows.append(("score", [f"{one['score']:.2f}" for one in candidates]))
    rows.append(("", [escape(speaks(one, candidates)) for one in candidates]))
    cells = "".join(f"<tr><th>{name}</th>{''.join(f'<td>{text}</td>' for text in texts)}</tr>" for name, texts in rows)
    return (
        f'<div class="rr-why" data-testid="candidates" {from_("diameter_mm", "score")}><h4>Candidates</h4>'
        f'<table class="rr-side">{cells}</table></div>'
    )


def speaks(one: dict[str, Any], candidates: Sequence[dict[str, Any]]) -> str:
    """What speaks for or against one of the candidates, the first of which was chosen."""
    chosen = candidates[0]
    if one is chosen:
        others = [other["score"] for other in candidates[1:]]
        return (
            f"chosen: {odds(one['score'], max(others))} as credible as the next" if others else "chosen: the only one"
        )
    against = odds(chosen["score"], one["score"])
    if one["possible"] is None:
        return f"{against} less credible; the paper's method excludes none"
    if one["possible"]:
        return f"cannot be excluded: {against} less credible only; the tool must fit it too"
    if one["score"] * EXCLUDED_TIMES > chosen["score"] and one["kind"] == "cone":
        return "excluded as another kind: it tapers too little to differ"
    return f"excluded: {against} less credible"


def odds(more: float, less: float) -> str:
    """How many times as much, in words."""
    if less <= 0 or more / less > LARGEST_ODDS:
        return f"more than {LARGEST_ODDS} times"
    return f"{more / less:.2g} times"


def distance_html(frame: Frame, measuring: bool, ends_px: tuple[Pixel, ...]) -> str:
    """The distance between two clicked points, or what to click next; nothing while none is asked for."""
    if not measuring:
        return ""
    if len(ends_px) < 2:
        text, exact = f"Click the {('first', 'second')[len(ends_px)]} point on the picture.", ""
    else:
        found = distance_between(frame, ends_px[0], ends_px[1])
        if isinstance(found, str):
            text, exact = found[:1].upper() + found[1:] + ".", ""
        else:
            off_mm = None if found.sigma_m is None else 1960 * found.sigma_m
            length_mm = 1000 * found.length_m
            interval = None if off_mm is None else (length_mm - off_mm, length_mm + off_mm)
            text, exact = f"{measured(length_mm, interval, ' mm')} between the two points.", f"{length_mm:.3f}"
    origin = from_("distance")
    return f'<div class="rr-caption" data-testid="distance" data-value="{exact}" {origin}>{escape(text)}</div>'

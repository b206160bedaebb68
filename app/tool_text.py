"""The tools beside an object, the one that is shown checked at its place, and the next view, as HTML."""

from html import escape
from math import degrees

from app.inspection import clearances_in, free_place_in, grasp_in, next_view_in
from app.origins import from_
from app.wording import from_to
from rotrecon.clearance import Clearance
from rotrecon.contact import PROPOSED, Place
from rotrecon.grasp import Grasp, Hits
from rotrecon.next_view import NextView, ViewFrom
from rotrecon.outcome import Fit
from rotrecon.reconstruction import Reconstruction
from rotrecon.tool_table import Tool
from rotrecon.tools import ToolProposal

STYLES = {"fits": "rr-sure", "not sure": "rr-unsure", "ruled out": "rr-out"}
BEWARE = "At the noise of this frame. Smeared limbs, or an edge that is seen here and not from there, make it wider."
NOTHING = '<div class="rr-why rr-dim" data-testid="tools">Measure an object first.</div>'


def tools_html(result: Reconstruction | None) -> str:
    """Every tool of the table: fits, not sure or ruled out, why, and how much room it leaves."""
    found = () if result is None else clearances_in(result)
    if result is None or not found:
        return NOTHING
    doubts = result.fit.doubts if isinstance(result.fit, Fit) else ()
    doubtful = '<div class="rr-unsure">No tool is proposed: the size is doubtful, see &ldquo;Why&rdquo;.</div>'
    rows = "".join(_tool(one, result) for one in found)
    return f'<div class="rr-why" data-testid="tools">{doubtful if doubts else ""}{rows}</div>'


def _tool(one: Clearance, result: Reconstruction) -> str:
    name, verdict = escape(one.tool.name), one.verdict
    reason = "" if not one.why else f'<div class="rr-small" {from_("reasons")}>{escape(one.why)}</div>'
    view = next_view_in(result) if verdict == "not sure" else None
    if view is not None:
        settles = escape(next_view_text(view))
        reason += f'<div {from_("next_view")} class="rr-small" data-testid="settles">{settles}</div>'
    free = f'<div class="rr-small" data-field="clearance" {from_("clearance")}>{clearance_text(one)}</div>'
    room = "" if verdict == "ruled out" else free
    return (
        f'<div class="rr-tool" data-tool="{name}" data-verdict="{verdict}"><div class="rr-head"><b>{name}</b>'
        f'<span class="{STYLES[verdict]}">{verdict}</span></div>{room}{reason}</div>'
    )


def clearance_text(one: Clearance) -> str:
    """The room that a tool leaves, over the whole interval."""
    low, high = one.tool.diameter_mm
    above, below = one.above_lowest_mm[0], one.below_highest_mm[0]
    parts = (
        [] if one.opening_mm is None else [f"{from_to(one.opening_mm, ' mm')} free in its {one.tool.opening_mm:g} mm"]
    )
    parts.append(
        f"{_margin(above)} above the least it takes ({low:g} mm), {_margin(below)} below the most ({high:g} mm)"
    )
    return "; ".join(parts)


def _margin(value_mm: float) -> str:
    return f"{value_mm:.1f} mm"


UNBOUNDED = "The scene states no limits of the arm: whether it gets there is not checked"


def place_html(result: Reconstruction | None, tool: Tool | None = None) -> str:
    """A tool at its place: what it would hit, and whether the arm gets there; by default the one that is proposed."""
    grasp = None if result is None else grasp_in(result, tool)
    if result is None or grasp is None:
        return '<div class="rr-why" data-testid="place"></div>'
    is_proposed = isinstance(result.tool, ToolProposal) and result.tool.tool == grasp.tool
    unproposed = "" if is_proposed else ", which is not proposed,"
    limits = result.frame.workspace
    bounded = limits.reach_m is not None or limits.box_m is not None
    checks = [*hit_lines(grasp), *(reach_lines(grasp) if bounded else ())]
    rows = "".join(f'<li class="{"rr-good" if good else "rr-bad"}">{escape(text)}</li>' for good, text in checks)
    if is_proposed and not all(good for good, _ in checks):
        rows += f"<li>{escape(free_text(result))}</li>"
    if not bounded:
        rows += f'<li class="rr-dim">{UNBOUNDED}</li>'
    return (
        f'<div class="rr-why" data-testid="place" data-clear="{str(all(good for good, _ in checks)).lower()}">'
        f"<h4 {from_('place')}>{escape(grasp.tool.name)}{unproposed} {place_text(grasp.place)}</h4>"
        f"<ul {from_('hits', 'reach')}>{rows}</ul></div>"
    )


def trouble(result: Reconstruction) -> str | None:
    """Why the tool that is proposed cannot be where it is placed, and what to do; None where nothing is in its way."""
    grasp = grasp_in(result) if isinstance(result.tool, ToolProposal) else None
    if grasp is None:
        return None
    bad = against(grasp)
    return f"{bad[0]} {free_text(result)} See \u201cTool\u201d" if bad else None


def free_instead(result: Reconstruction | None) -> Place | None:
    """Where the tool that is proposed would be free, when it is not where it is placed."""
    grasp = grasp_in(result) if result is not None and isinstance(result.tool, ToolProposal) else None
    return None if result is None or grasp is None or not against(grasp) else free_place_in(result)


def free_text(result: Reconstruction) -> str:
    """The nearest contact that is free instead of one that is not, or that there is none: a sentence."""
    free = free_instead(result)
    if free is None:
        return "No contact along the axis is free from this side."
    return f"The nearest free contact is {1000 * free.along_m:+.0f} mm along the axis."


def tools_in_the_way(result: Reconstruction) -> dict[str, tuple[str, ...]]:
    """Of each tool that cannot be at the place of the contact why: a sentence each."""
    grasps = (grasp_in(result, tool) for tool in result.settings.tools)
    found = {grasp.tool.name: against(grasp) for grasp in grasps if grasp is not None}
    proposed = result.tool.tool.name if isinstance(result.tool, ToolProposal) else None
    return {name: (*lines, free_text(result)) if name == proposed else lines for name, lines in found.items() if lines}


def against(grasp: Grasp) -> tuple[str, ...]:
    """Why a tool cannot be where it is placed: a sentence each."""
    return tuple(f"{text}." for good, text in (*reach_lines(grasp), *hit_lines(grasp)) if not good)


def place_text(place: Place) -> str:
    """Where it touches."""
    if place == PROPOSED:
        return "where it is proposed"
    return f"turned by {degrees(place.angle_rad):.0f}&deg;, {1000 * place.along_m:+.0f} mm along the axis"


def hit_lines(grasp: Grasp) -> list[tuple[bool, str]]:
    """Whether the envelope is free, at the object and on the way there, and in words what is in it."""
    return [
        _hits("At the object", "nothing of the cloud is in its jaws, mouth or body", grasp.at_contact),
        _hits("On the last part of the way", "nothing of the cloud is in it", grasp.on_way),
    ]


def _hits(where: str, free: str, hits: Hits) -> tuple[bool, str]:
    if hits.nearest_m is None:
        return True, f"{where} {free}"
    count = len(hits.pixel)
    points = "1 point" if count == 1 else f"{count} points"
    return (
        False,
        f"{where} it would hit {points} of the cloud, the nearest {1000 * hits.nearest_m:.0f} mm from the object",
    )


def reach_lines(grasp: Grasp) -> list[tuple[bool, str]]:
    """Whether the arm gets there."""
    if not grasp.unreachable:
        return [(True, "The arm reaches contact and approach")]
    return [(False, f"Out of reach: {why}") for why in grasp.unreachable]


def next_view_html(result: Reconstruction | None) -> str:
    """Where the camera should go, in words and numbers."""
    found = None if result is None else next_view_in(result)
    if found is None:
        return '<div class="rr-why rr-dim" data-testid="next-view">Nothing can be said of other views.</div>'
    place = ", ".join(f"{value:.3f}" for value in found.best.T_base_camera[:3, 3])
    told = [(way(view), view.distance_m, view.half_width_m) for view in found.by_distance]
    others = "".join(
        f"<tr><td>{escape(going)}</td><td>{away_m:.2f} m</td><td>&plusmn; {1000 * off_m:.2f} mm</td></tr>"
        for going, away_m, off_m in told
    )
    return (
        f'<div class="rr-why" data-testid="next-view" data-value="{1000 * found.best.half_width_m:.3f}" '
        f"{from_('next_view')}>"
        f"<p>{escape(next_view_text(found))}</p>"
        f"<p>Camera at {place} m in base coordinates.</p>"
        f'<p class="rr-small">{BEWARE}</p>'
        f'<h4>The best at each distance</h4><table class="rr-whole">{others}</table></div>'
    )


def next_view_text(found: NextView) -> str:
    """The best view in a sentence."""
    best = found.best
    beyond = f" {found.beyond_reach} other places are beyond the arm's limits." if found.beyond_reach else ""
    if best.half_width_m >= found.now_m:
        return f"No other view promises more: the diameter is known to ± {1000 * found.now_m:.2f} mm.{beyond}"
    going = way(best)
    return (
        f"Go {going}: from {best.distance_m:.2f} m the diameter should be known to ± {1000 * best.half_width_m:.2f} mm "
        f"instead of ± {1000 * found.now_m:.2f} mm.{beyond}"
    )


def way(view: ViewFrom) -> str:
    """A change of place in words."""
    share = 100 * abs(1 - view.nearness)
    parts = [] if view.nearness == 1 else [f"{share:.0f} % {'nearer' if view.nearness < 1 else 'farther away'}"]
    if view.angle_rad:
        side = f"to the {view.toward}" if view.toward in ("left", "right") else view.toward
        parts.append(f"{abs(degrees(view.angle_rad)):.0f} degrees round the axis {side}".strip())
    return " and ".join(parts) or "as now"

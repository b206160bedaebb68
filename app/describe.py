"""An answer in words, for a person at a terminal."""

from typing import Any

from rotrecon.answer import answer as answer_of
from rotrecon.outcome import Fit
from rotrecon.reconstruct import Reconstruction


def describe_result(result: Reconstruction) -> str:
    """What `describe` says, and beside it what the paper's other ways to the same diameter give."""
    text = describe(answer_of(result))
    if result.first_cut_radius_m is not None:
        text += f"\n  for comparison: the first cut alone gives {2000 * result.first_cut_radius_m:.1f} mm"
    if isinstance(result.fit, Fit) and result.fit.axis_length_radius_m is not None:
        text += f", half the axis length (16) {2000 * result.fit.axis_length_radius_m:.1f} mm"
    return text


def describe(answer: dict[str, Any]) -> str:
    """A few lines that say what was measured and which tool fits, or why not."""
    if answer["kind"] is None:
        return "\n".join(["No result:", *(f"  {reason}" for reason in answer["reasons"])])
    lines = [
        f"{'inside of a ' if answer['concave'] else ''}{answer['kind']}, {answer['diameter_mm']:.1f} mm in diameter",
        "  not certain, and without an interval: the paper's method has no measure of either",
        *_geometry(answer),
        f"  {answer['arc_deg']:.0f} degrees of it are visible; its pixels lie {answer['rms_mm']:.2f} mm off it (RMS)",
        f"  {_sections(answer['sections'])}",
        f"  candidates: {_candidates(answer['candidates'])}",
        f"  tool: {answer['tool'] or 'none'}",
        *(f"    {reason}" for reason in answer["reasons"]),
    ]
    return "\n".join(lines)


def _geometry(answer: dict[str, Any]) -> list[str]:
    lines = [f"  middle at {_vector(answer['center_m'])} m in base coordinates"]
    if answer["length_mm"] is not None:
        lines.insert(0, f"  {answer['length_mm']:.0f} mm long where it was drawn")
    if answer["axis"] is not None:
        lines.append(f"  axis along {_vector(answer['axis']['direction'])}")
    if answer["half_angle_deg"] is not None:
        lines.append(f"  half angle {answer['half_angle_deg']:.1f} degrees")
    return lines


def _sections(sections: dict[str, Any]) -> str:
    dropped = ", ".join(f"{count} {reason.replace('_', ' ')}" for reason, count in sections["dropped"].items())
    return f"{sections['used']} sections used" + (f"; dropped: {dropped}" if dropped else "")


def _candidates(candidates: list[dict[str, Any]]) -> str:
    return ", ".join(f"{c['kind']} {c['diameter_mm']:.1f} mm (score {c['score']:.2f})" for c in candidates)


def _vector(numbers: list[float]) -> str:
    return ", ".join(f"{number:.3f}" for number in numbers)

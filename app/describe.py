"""An answer in words, for a person at a terminal."""

from typing import Any

from app.wording import candidate_row, certainty, from_to, measured, open_ends, rests_on
from rotrecon.answer import answer as answer_of
from rotrecon.frame import Frame
from rotrecon.outcome import Fit
from rotrecon.primitives import in_words
from rotrecon.reconstruction import Reconstruction


def describe_result(result: Reconstruction) -> str:
    """What `describe` says, and beside it what the paper's other ways to the same diameter give."""
    text = describe(answer_of(result))
    if result.first_cut_radius_m is not None:
        text += f"\n  for comparison: the first cut alone gives {2000 * result.first_cut_radius_m:.1f} mm"
    if isinstance(result.fit, Fit) and result.fit.axis_length_radius_m is not None:
        text += f", half the axis length (16) {2000 * result.fit.axis_length_radius_m:.1f} mm"
    return text


def describe(answer: dict[str, Any]) -> str:
    """A few lines that say what was measured, how sure it is and which tool fits, or why not."""
    if answer["kind"] is None:
        return "\n".join(["No result:", *(f"  {reason}" for reason in answer["reasons"])])
    lines = [
        f"{'inside of a ' if answer['concave'] else ''}{in_words(answer['kind'])}, {_diameter(answer)}",
        f"  {certainty(answer)}",
        *_geometry(answer),
        f"  {answer['arc_deg']:.0f} degrees of it are visible; its pixels lie {answer['rms_mm']:.2f} mm off it (RMS)",
        *(f"  {name}: {text}" for name, text in rests_on(answer)),
        f"  {_sections(answer['sections'])}",
        f"  candidates: {_candidates(answer['candidates'])}",
        f"  tool: {answer['tool'] or 'none'}",
        *(f"    {reason}" for reason in answer["reasons"]),
    ]
    return "\n".join(lines)


def matching_notes(frame: Frame) -> tuple[str, ...]:
    """What an operator should know of a frame that was matched from views."""
    stereo = frame.stereo
    if stereo is None:
        return ()
    error = stereo.epipolar_error_px
    check = "too few features to check the poses" if error is None else f"features lie {error:.2f} px off their rows"
    share = f"{100 * stereo.valid_share:.0f} % of its pixels have depth"
    return (f"Matched from {len(stereo.pairs) + 1} views, coarsely: {share}, {check}.", *stereo.left_out)


def _diameter(answer: dict[str, Any]) -> str:
    interval = answer["interval_mm"]
    ends = "" if interval is None else f" (95 %: {from_to(interval, ' mm')})"
    return f"{measured(answer['diameter_mm'], interval, ' mm')} in diameter{ends}"


def _geometry(answer: dict[str, Any]) -> list[str]:
    lines = [] if answer["length_mm"] is None else [f"  {_length(answer)}"]
    lines.append(f"  middle at {_vector(answer['center_m'])} m in base coordinates")
    if answer["axis"] is not None:
        lines.append(f"  axis along {_vector(answer['axis']['direction'])}")
    if answer["half_angle_deg"] is not None:
        angle = measured(answer["half_angle_deg"], answer["half_angle_interval_deg"], " degrees")
        lines.append(f"  half angle {angle}")
    return lines


def _length(answer: dict[str, Any]) -> str:
    """Of an object that ends in the area, or of the part of it that was drawn."""
    beyond = open_ends(answer)
    if beyond:
        return f"at least {answer['length_mm']:.0f} mm long: beyond the area at its {' and its '.join(beyond)}"
    length = measured(answer["length_mm"], answer["length_interval_mm"], " mm", 0)
    return f"{length} long" if answer["ends"] else f"{length} long where it was drawn"


def _sections(sections: dict[str, Any]) -> str:
    dropped = ", ".join(f"{count} {reason.replace('_', ' ')}" for reason, count in sections["dropped"].items())
    return f"{sections['used']} sections used" + (f"; dropped: {dropped}" if dropped else "")


def _candidates(candidates: list[dict[str, Any]]) -> str:
    return ", ".join(f"{name} {diameter} (score {score})" for name, diameter, score in map(candidate_row, candidates))


def _vector(numbers: list[float]) -> str:
    return ", ".join(f"{number:.3f}" for number in numbers)

"""How numbers, their 95 % intervals and doubts about the kind are said, on the page and at a terminal."""

from collections.abc import Sequence
from math import ceil, log10
from typing import Any

from rotrecon.primitives import in_words

LOPSIDED = 0.2
"""Share by which the two halves of an interval may differ and still be said as one plus-minus, the larger of them."""
MOST_DECIMALS = 3
"""Answers are given to the micrometre and the thousandth of a degree."""


def measured(value: float, interval: Sequence[float] | None, unit: str, decimals: int = 1) -> str:
    """A number with its unit and, where it has an interval about its middle, plus-minus: `66.8 ± 0.9 mm`.

    As many decimals as the interval needs, `decimals` at least.
    """
    off = None if interval is None else plus_minus(value, interval)
    decimals = decimals if interval is None else decimals_for(interval, decimals)
    return f"{value:.{decimals}f}{unit}" if off is None else f"{value:.{decimals}f} ± {off:.{decimals}f}{unit}"


def from_to(interval: Sequence[float], unit: str, decimals: int = 1) -> str:
    """An interval by its ends: `65.9 to 67.7 mm`."""
    decimals = decimals_for(interval, decimals)
    low, high = (f"{end:.{decimals}f}" for end in interval)
    return f"{low} to {high}{unit}"


def plus_minus(value: float, interval: Sequence[float]) -> float | None:
    """Half the width of an interval, or None when the number is not in its middle."""
    below, above = value - interval[0], interval[1] - value
    return max(below, above) if abs(above - below) <= LOPSIDED * max(below, above) else None


def decimals_for(interval: Sequence[float], least: int) -> int:
    """Decimals that show one digit of half an interval."""
    half = (interval[1] - interval[0]) / 2
    return least if half <= 0 else min(max(least, ceil(-log10(half))), MOST_DECIMALS)


def certainty(answer: dict[str, Any]) -> str:
    """Whether the kind is certain, and what else it may be; the paper's method has no measure of it."""
    if answer["certain"]:
        return "certain"
    names = [candidate_name(candidate) for candidate in answer["candidates"] if candidate["possible"]]
    if len(names) > 1:
        return f"not certain: {', '.join(names[:-1])} or {names[-1]}"
    if answer["method"] == "paper":
        return "not certain, no interval: the paper's method has no measure of either"
    if answer["kind"] == "revolution":
        return "not certain: a solid of revolution may be anything round"
    return "not certain" if answer["tool"] is None else "not certain: the interval is wide"


def candidate_name(candidate: dict[str, Any]) -> str:
    """A kind that was considered; of a cone how much it tapers."""
    angle = candidate["half_angle_deg"]
    return in_words(candidate["kind"]) if angle is None else f"{candidate['kind']} of {abs(angle):.1f}°"


def candidate_row(candidate: dict[str, Any]) -> tuple[str, str, str]:
    """A kind that was considered, its diameter and its score."""
    score = f"{candidate['score']:.2f}" + (", excluded" if candidate["possible"] is False else "")
    return candidate_name(candidate), measured(candidate["diameter_mm"], candidate["interval_mm"], " mm"), score


def open_ends(answer: dict[str, Any]) -> list[str]:
    """Those of start and end, along the stroke, that lie beyond the area."""
    return [end for end in ("start", "end") if (answer["ends"] or {}).get(end) == "open"]


def rests_on(answer: dict[str, Any]) -> list[tuple[str, str]]:
    """What the intervals rest on and how well the place is known: names with values, without those that are null."""
    place, turn, share, sigma = (
        answer[name] for name in ("center_interval_mm", "axis_interval_deg", "inlier_share", "sigma_over_radius")
    )
    rows: list[tuple[str, str | None]] = [
        ("middle known within", None if place is None else f"{place:.{decimals_for((-place, place), 1)}f} mm"),
        ("axis known within", None if turn is None else f"{turn:.{decimals_for((-turn, turn), 1)}f} degrees"),
        ("pixels that agree", None if share is None else f"{100 * share:.0f} %"),
        ("standard error of the radius", None if sigma is None else f"{100 * sigma:.2f} %"),
        *_noise(answer["noise"] or {}, matched=answer["stereo"] is not None),
        *matching(answer["stereo"]),
    ]
    return [(name, text) for name, text in rows if text is not None]


def matching(stereo: dict[str, Any] | None) -> list[tuple[str, str | None]]:
    """What depth that was matched from views rests on; nothing for depth that was recorded."""
    if stereo is None:
        return []
    error = stereo["epipolar_error_px"]
    return [
        ("depth matched from views", " and ".join(map(str, stereo["views"]))),
        ("area with depth", f"{100 * stereo['valid_share']:.0f} %"),
        ("features off their rows by", "too few to say" if error is None else f"{error:.2f} px"),
        ("views left out", "; ".join(stereo["left_out"]) or None),
    ]


def _noise(noise: dict[str, Any], *, matched: bool) -> list[tuple[str, str | None]]:
    """What the depth errs by, and who says so."""
    if not noise:
        return []
    disparity = noise["disparity_sigma_px"]
    return [
        ("depth errs by", f"{noise['sigma_mm']:.2f} mm" + ("" if disparity is None else f", {disparity:.2f} px")),
        ("correlated over", f"{noise['correlation_px']:.1f} px"),
        ("this noise is", _says_so(noise["stated"], matched)),
    ]


def _says_so(stated: bool, matched: bool) -> str:
    if matched:
        return "told from the pictures"
    return "stated by the scene" if stated else "estimated from the frame"

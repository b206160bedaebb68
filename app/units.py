"""Lengths as a person wants to read them: everything else in the program is in metres, texts and tables in mm."""

import re
from collections.abc import Collection, Sequence
from math import floor, log10
from typing import Any, Literal

Unit = Literal["mm", "inch"]
MM_PER: dict[Unit, float] = {"mm": 1.0, "inch": 25.4}
MORE_DECIMALS = 2
"""A hundredth of an inch is a quarter of a millimetre: so many more say no less."""
INCH_DECIMALS = 4
"""Of an input: 2.5 micrometres."""
NUMBER = r"[+-]?\d+(?:\.\d+)?"
MM = re.compile(r"\bmm\b")
IN_MM = rf"(?:between {NUMBER} and |(?:{NUMBER} (?:±|&plusmn;|to|or) )*){NUMBER} mm\b"
"""A length, or several that share a unit: `3 mm`, `65.9 to 67.7 mm`, `66.8 ± 0.9 mm`."""


def from_mm(length_mm: float, unit: Unit) -> float:
    """A length as it is typed in a unit."""
    return length_mm if unit == "mm" else round(length_mm / MM_PER[unit], INCH_DECIMALS)


def to_mm(typed: float, unit: Unit) -> float:
    """A length that was typed in a unit; `from_mm` gives back what was typed."""
    return typed if unit == "mm" else round(typed * MM_PER[unit], INCH_DECIMALS)


def decimals_of(step_mm: float, unit: Unit) -> int:
    """Digits after the point of an input whose steps are whole multiples of that."""
    return INCH_DECIMALS if unit == "inch" else max(0, -floor(log10(step_mm)))


def in_unit(text: str, unit: Unit, names: Collection[str] = ()) -> str:
    """A text or HTML with every length that it says in mm in that unit, but for the names, which stay as they are."""
    if unit == "mm":
        return text
    kept = "|".join(re.escape(name) for name in sorted(names, key=len, reverse=True) if name)
    lengths = re.compile(f"(?P<kept>{kept})|{IN_MM}" if kept else IN_MM)
    return lengths.sub(_in_inches, text)


def labels_in(parts: Sequence[dict[str, Any]], unit: Unit) -> tuple[Any, ...]:
    """Axes or series of a chart, with the unit in their labels where mm stood."""
    return tuple(part | {"label": MM.sub(unit, part["label"])} if "label" in part else part for part in parts)


def scales_in(scales: dict[str, Any], lengths: Collection[str], unit: Unit) -> dict[str, Any]:
    """Scales of a chart, those of lengths from mm to a unit."""
    scaled = {name: tuple(end / MM_PER[unit] for end in scales[name]["range"]) for name in lengths}
    return scales | {name: scales[name] | {"range": ends} for name, ends in scaled.items()}


def _in_inches(found: re.Match[str]) -> str:
    if found.groupdict().get("kept") is not None:
        return found.group()
    return re.sub(NUMBER, _number, found.group().removesuffix("mm")) + "inch"


def _number(found: re.Match[str]) -> str:
    digits = found.group()
    decimals = len(digits.partition(".")[2]) + MORE_DECIMALS
    sign = "+" if digits.startswith("+") else ""
    return f"{sign}{float(digits) / MM_PER['inch']:.{decimals}f}"

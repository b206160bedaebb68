"""Lengths as a person wants to read them: everything else in the program is in metres, texts and tables in mm."""

import re
from typing import Literal

Unit = Literal["mm", "inch"]
MM_PER_INCH = 25.4
PER_MM: dict[Unit, float] = {"mm": 1.0, "inch": 1 / MM_PER_INCH}
MORE_DECIMALS = 2
"""A hundredth of an inch is a quarter of a millimetre: so many more say no less."""
NUMBER = r"[+-]?\d+(?:\.\d+)?"
IN_MM = re.compile(rf"(?:between {NUMBER} and |(?:{NUMBER} (?:±|&plusmn;|to|or) )*){NUMBER} mm\b")
"""A length, or several that share a unit: `3 mm`, `65.9 to 67.7 mm`, `66.8 ± 0.9 mm`."""


def in_unit(text: str, unit: Unit) -> str:
    """A text or HTML with every length that it says in mm in that unit."""
    return text if unit == "mm" else IN_MM.sub(_in_inches, text)


def _in_inches(length: re.Match[str]) -> str:
    return re.sub(NUMBER, _number, length.group().removesuffix("mm")) + "inch"


def _number(found: re.Match[str]) -> str:
    digits = found.group()
    decimals = len(digits.partition(".")[2]) + MORE_DECIMALS
    sign = "+" if digits.startswith("+") else ""
    return f"{sign}{float(digits) * PER_MM['inch']:.{decimals}f}"

"""Tables and text that read the same at a terminal and in a Markdown document."""

import textwrap
from collections.abc import Sequence

import numpy as np

from rotrecon.arrays import Floats

NONE = "-"
LINE_LENGTH = 120


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table whose columns are aligned; all but the first to the right."""
    widths = [max(len(row[column]) for row in (header, *rows)) for column in range(len(header))]

    def line(cells: Sequence[str]) -> str:
        first, *others = zip(cells, widths, strict=True)
        aligned = [first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in others)]
        return "| " + " | ".join(aligned) + " |"

    rule = "| " + " | ".join(["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])]) + " |"
    return "\n".join([line(header), rule, *map(line, rows)])


def wrapped(text: str) -> str:
    """Markdown whose paragraphs and list items are filled anew, after numbers were put into them."""
    return "\n\n".join(_filled(block) for block in text.split("\n\n"))


def _filled(block: str) -> str:
    if block.startswith(("|", "#")):
        return block
    items = [" ".join(item.split()) for item in block.replace("\n- ", "\n\n- ").split("\n\n")]
    return "\n".join(
        textwrap.fill(item, LINE_LENGTH, subsequent_indent="  " * item.startswith("- "), break_on_hyphens=False)
        for item in items
    )


def mean_text(values: Floats) -> str:
    """Mean of what is a number, with its sign; a dash where nothing is."""
    known = values[np.isfinite(values)]
    return f"{_without_minus_zero(known.mean()):+.1f}" if len(known) else NONE


def median_text(values: Floats) -> str:
    """Median of what is a number, with its sign; a dash where nothing is."""
    known = values[np.isfinite(values)]
    return f"{_without_minus_zero(np.median(known)):+.1f}" if len(known) else NONE


def spread_text(values: Floats) -> str:
    """Standard deviation of what is a number; a dash where nothing is."""
    known = values[np.isfinite(values)]
    return f"{known.std():.1f}" if len(known) else NONE


def share_text(flags: Sequence[bool]) -> str:
    """Share of the true ones, in percent."""
    return f"{100 * float(np.mean(flags)):.0f} %"


def verdict(figure: float, limit: float, unit: str) -> str:
    """The target, and whether a figure meets it."""
    return f"< {limit:g} {unit}: {'met' if figure < limit else 'MISSED'}"


def _without_minus_zero(value: float) -> float:
    return float(np.round(value, 1)) + 0.0

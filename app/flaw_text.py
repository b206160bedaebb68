"""Flaws of simulated pictures as the command line takes them: "blur=1.5", "occluder"."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import typer

from rotrecon.simulation.flaws import Flaws

AMOUNTS = {
    "noise": ("noise_levels", 1.0, "grey levels"),
    "blur": ("blur_px", 1.0, "px"),
    "gain": ("gain", 1.0, "from view to view"),
    "glare": ("glare", 1.0, "where 1 is white"),
    "shift": ("pose_error_m", 1e-3, "mm off the stated poses"),
    "turn": ("pose_error_deg", 1.0, "degrees off them"),
    "focal": ("focal_error", 1e-2, "% off the stated focal lengths"),
    "principal": ("principal_error_px", 1.0, "px off the principal points"),
}
"""Field of `Flaws`, what one unit of the amount is there, and the unit in words."""
THINGS = ("occluder", "neighbour")
"""Flaws that are there or not."""
_UNITS = ", ".join(f"{name} ({unit})" for name, (_, _, unit) in AMOUNTS.items())
FLAW_HELP = f"What is wrong with the views, once for each: {_UNITS}; or a thing: {', '.join(THINGS)}."


def parse_flaws(words: Sequence[str]) -> Flaws:
    """The flaws that are named, the others as usual; BadParameter says what is not understood."""
    amounts: dict[str, Any] = {}
    for word in words:
        name, stated, amount = word.partition("=")
        if name in THINGS and not stated:
            amounts[name] = True
        elif name in AMOUNTS:
            field, unit, _ = AMOUNTS[name]
            amounts[field] = unit * _number(name, word, amount)
        else:
            raise typer.BadParameter(
                f"--flaw {word} is not known; write one of {', '.join(AMOUNTS)} with an amount, as "
                f"blur=1.5, or one of {', '.join(THINGS)}"
            )
    try:
        return replace(Flaws(), **amounts)
    except ValueError as error:
        raise typer.BadParameter(f"--flaw: {error}") from error


def _number(name: str, word: str, amount: str) -> float:
    try:
        return float(amount)
    except ValueError as error:
        raise typer.BadParameter(f"--flaw {word} has no amount; write it as {name}=2") from error

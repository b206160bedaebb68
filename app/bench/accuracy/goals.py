"""A figure beside what is asked of it."""

from dataclasses import dataclass

import numpy as np

from app.bench.table import NONE, table


@dataclass(frozen=True)
class Goal:
    """One figure of those to reach."""

    what: str
    found: str
    asked: str
    met: bool

    @property
    def verdict(self) -> str:
        """One word."""
        return "reached" if self.met else "NOT REACHED"


def goal_table(goals: list[Goal]) -> str:
    """All goals, one a row."""
    rows = [(goal.what, goal.found, goal.asked, goal.verdict) for goal in goals]
    return table(("figure", "measured", "asked", ""), rows)


def number(value: float, sign: bool = False) -> str:
    """A percentage or a ratio to two digits after the point, or three where it is small; a dash for NaN."""
    if not np.isfinite(value):
        return NONE
    digits = 3 if abs(value) < 0.1 else 2
    rounded = round(value, digits) + 0.0
    return f"{rounded:{'+' if sign else ''}.{digits}f}"


def share(value: float) -> str:
    """A share as a percentage; a dash for NaN."""
    return f"{100 * value:.1f} %" if np.isfinite(value) else NONE


def mark(met: bool) -> str:
    """What stands beside a figure in a table."""
    return "yes" if met else "NO"

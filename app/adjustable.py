"""The settings that an operator may change on the page: each with its unit, its range, and why it is among them."""

from dataclasses import dataclass, field, replace
from math import isfinite, radians
from typing import Any, Literal, get_args

from app.deciding.settings import DecisionSettings
from rotrecon.settings import Method, Settings

Value = float | str
UNITS = Literal["", "mm", "°", "s", "min", "σ"]
SI = {"": 1.0, "mm": 0.001, "°": radians(1.0), "s": 1.0, "min": 60.0, "σ": 1.0}
"""What one of a unit is in the units of the settings."""
DECIMALS, SI_DECIMALS = 6, 12
"""That a value is rounded to as it is shown and as it is used, so that it comes back as it was typed."""


@dataclass(frozen=True)
class Adjustable:
    """A number; `low`, `high` and `step` are in its unit."""

    key: str
    """Field of `Settings` or `DecisionSettings`."""
    label: str
    why: str
    """When one would change it."""
    low: float
    high: float
    step: float
    unit: UNITS = ""

    def shown(self, value: float) -> float:
        """A setting in the unit that it is shown in."""
        return round(value / SI[self.unit], DECIMALS)

    def setting(self, shown: float) -> float:
        """The setting that is meant by a number as it is shown."""
        return round(shown * SI[self.unit], SI_DECIMALS)


METHOD = "method"
METHODS: tuple[Method, ...] = get_args(Method)
MEASURING = (
    Adjustable("layers", "Objects in front of each other", "As many as overlap in depth in the area.", 1, 9, 1),
    Adjustable("sigma_factor", "Depths belong together within", "Less where things lie close behind.", 2, 5, 0.1, "σ"),
    Adjustable("rod_diameter_m", "A rod is at most as thick as", "What your clipper is meant for.", 5, 60, 1, "mm"),
    Adjustable("rod_length_over_diameter", "A rod is longer than thick by a factor of", "Or more.", 2, 30, 0.5),
    Adjustable("cone_half_angle_rad", "A cone tapers to a side by", "Less is a cylinder.", 0.5, 10, 0.01, "°"),
)
"""What a class is depends on what the cell handles and with which tools; how depths are told apart on what lies about.
The other settings are thresholds that were measured over thousands of scenes, and nobody sees on one what they do."""
DECIDING = (
    Adjustable("arm_s", "Armed for", "More for a slow hand, or a tablet.", 5, 30, 1, "s"),
    Adjustable("valid_s", "A confirmation is good for", "The way of your arm.", 10, 600, 10, "s"),
    Adjustable("max_age_s", "Oldest frame to decide on", "How long nothing moves in your cell.", 1, 60, 1, "min"),
)
"""Times of this cell. How long a button is held, and what makes a camera stall, guard against slips: they stay."""


@dataclass(frozen=True)
class Chosen:
    """All settings of a session."""

    measuring: Settings = field(default_factory=Settings)
    deciding: DecisionSettings = field(default_factory=DecisionSettings)

    def __getitem__(self, key: str) -> Any:
        """The value of an adjustable setting."""
        return getattr(self.measuring if key in MEASURED else self.deciding, key)


MEASURED = {METHOD, *(one.key for one in MEASURING)}
NUMBERS = {one.key: one for one in (*MEASURING, *DECIDING)}
KEYS = (METHOD, *NUMBERS)


def with_value(chosen: Chosen, key: str, value: Value) -> Chosen | None:
    """The settings with one that is another; None for a value that is out of range, or no setting of this list."""
    if key == METHOD:
        return replace(chosen, measuring=replace(chosen.measuring, method=value)) if value in METHODS else None
    one = NUMBERS.get(key)
    if one is None or isinstance(value, str) or not isfinite(value) or not one.low <= one.shown(value) <= one.high:
        return None
    whole = isinstance(chosen[key], int)
    if whole and value != int(value):
        return None
    value = int(value) if whole else float(value)
    part = "measuring" if key in MEASURED else "deciding"
    return replace(chosen, **{part: replace(getattr(chosen, part), **{key: value})})

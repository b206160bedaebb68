"""Every time and limit of the decision, with its unit and the reason for its value."""

from dataclasses import dataclass

from rotrecon.primitives import Kind


@dataclass(frozen=True)
class DecisionSettings:
    """What may be decided, and how fast it goes stale."""

    arm_s: float = 10.0
    """Armed for so long: enough to move a hand to the other button and hold it, too short to be forgotten."""
    hold_s: float = 1.0
    """A slip or a bump is shorter."""
    hold_ticks: int = 6
    """Of the 10 a second that a held button sends; two that are a second apart are no hold."""
    hold_gap_s: float = 0.4
    """Longest time without a tick: four of them are missing, the finger has been off or the line is down."""
    valid_s: float = 120.0
    """How long a confirmed decision may be acted on: the way of an arm to an object within its reach."""
    max_age_s: float = 600.0
    """Oldest frame that can be decided on: time to draw and inspect, while nothing else should move in the cell."""
    clock_skew_s: float = 2.0
    """A frame may be so far in the future: clocks kept by NTP agree better, and an hour off is no longer an age."""
    missing_frames: float = 3.0
    """Frames of a source with a stated rate that may be missing before its sequence has stalled."""
    answer_s: float = 15.0
    """Whoever is in control and does not answer for so long when asked for it is not there, and loses it."""
    silent_s: float = 20.0
    """A page in control that nothing is heard of for so long hangs, or its network is dead, and loses control. It is
    asked several times meanwhile; one that draws slowly answers within some seconds."""
    quiet_s: float = 5.0
    """The same refusal to the same page is told and recorded once in so long: a held button is one action."""
    least_reason: int = 8
    """Characters of a typed reason: fewer are none."""
    dangerous: frozenset[Kind] = frozenset()
    """Classes that are marked dangerous: the operator names the class before the proposal is shown."""

"""The watch over the frame that is held: too old, out of a camera that stands still, or from a clock that is wrong."""

from dataclasses import dataclass, replace
from typing import Literal

from app.deciding.settings import DecisionSettings

Source = Literal["recorded", "live"]
MINUTE_S = 60.0


@dataclass(frozen=True)
class FrameFacts:
    """What is known of a frame beside its content."""

    fingerprint: str
    """Of its pixels: equal for identical ones."""
    source: Source = "recorded"
    sequence: int | None = None
    """The source's own count, if it has one."""
    captured_s: float | None = None
    """When it was taken, Unix time; None where that is not stated."""
    every_s: float | None = None
    """The stated time from one frame of a live source to the next."""


@dataclass(frozen=True)
class Watched:
    """The frame that is held, and what its source has sent since."""

    held: FrameFacts
    opened: float
    """When it was opened here."""
    age_s: float
    """How old it was then; a recording is as new as its opening."""
    ahead_s: float
    """How far it, or the latest since, lies in the future of this machine's clock."""
    latest: FrameFacts
    arrived: float
    """When the latest came."""
    stalled: bool = False
    identical: bool = False
    changed: bool = False
    """A newer frame shows something else in the area."""


def opened(facts: FrameFacts, at: float, wall_s: float) -> Watched:
    """The watch over a frame that was just opened, at `wall_s` by this machine's clock."""
    ahead_s = 0.0 if facts.captured_s is None else facts.captured_s - wall_s
    age_s = max(-ahead_s, 0.0) if facts.source == "live" else 0.0
    return Watched(facts, at, age_s, ahead_s, facts, at)


def arrived(watched: Watched, facts: FrameFacts, at: float, wall_s: float, changed: bool) -> Watched:
    """The watch after a newer frame has come, which is not the one that is held."""
    before = watched.latest
    counted = facts.sequence is not None and before.sequence is not None
    return replace(
        watched,
        latest=facts,
        arrived=at,
        ahead_s=watched.ahead_s if facts.captured_s is None else facts.captured_s - wall_s,
        stalled=counted and (facts.sequence or 0) <= (before.sequence or 0),
        identical=facts.fingerprint == before.fingerprint,
        changed=changed,
    )


def age_s(watched: Watched, now: float) -> float:
    """How old the frame that is held is."""
    return watched.age_s + max(now - watched.opened, 0.0)


def problems(watched: Watched | None, settings: DecisionSettings, now: float) -> tuple[str, ...]:
    """What forbids to decide on the frame that is held, and what to do about it: a sentence each."""
    if watched is None:
        return ("No frame is held: open one.",)
    found: list[str] = []
    if age_s(watched, now) > settings.max_age_s:
        remedy = "open it again" if watched.held.source == "recorded" else "take a new one, which the robot pushes in"
        found.append(f"The frame is more than {settings.max_age_s / MINUTE_S:g} minutes old: {remedy}.")
    if watched.ahead_s > settings.clock_skew_s:
        found.append(
            f"The frame is {watched.ahead_s:.0f} s ahead of this machine's clock: set the clocks, and take a new one."
        )
    every_s = watched.latest.every_s
    silent = every_s is not None and now - watched.arrived > settings.missing_frames * every_s
    if watched.stalled or silent:
        found.append("The camera's sequence has stalled: see to the camera, and take a new frame.")
    if watched.identical:
        found.append("The camera sends identical pixels: see to the camera, and take a new frame.")
    if watched.changed:
        found.append("A newer frame shows a change in the area: take that one.")
    return tuple(found)

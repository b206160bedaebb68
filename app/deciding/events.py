"""What can happen to a decision; every event says when, by one clock that does not stop and is not set."""

from dataclasses import dataclass

from app.deciding.states import Offer
from app.deciding.watchdog import FrameFacts
from app.record.entries import Entry
from rotrecon.primitives import Kind


@dataclass(frozen=True)
class Timed:
    """Anything that happens."""

    at: float
    """Seconds."""


@dataclass(frozen=True)
class FromPage(Timed):
    """Anything that is done on a page, or happens to it."""

    page: int


@dataclass(frozen=True)
class OnProposal(FromPage):
    """Anything that is done with a proposal, by the number that the control was made for."""

    number: int


@dataclass(frozen=True)
class PageCame(FromPage):
    """A page was opened; it watches."""

    name: str


@dataclass(frozen=True)
class PageWent(FromPage):
    """A page was closed, or its connection has ended."""


@dataclass(frozen=True)
class PageHeard(FromPage):
    """A page has said something, or has answered that it is there."""


@dataclass(frozen=True)
class ControlTaken(FromPage):
    """Control that nobody has is taken."""


@dataclass(frozen=True)
class ControlGiven(FromPage):
    """The one in control gives it back."""


@dataclass(frozen=True)
class ControlAsked(FromPage):
    """A watcher asks the one in control for it."""


@dataclass(frozen=True)
class HandoverAnswered(FromPage):
    """The one in control says yes or no to the page that asks."""

    granted: bool


@dataclass(frozen=True)
class Offered(Timed):
    """A drawing was measured; `entry` is what the record says of it."""

    offer: Offer
    entry: Entry


@dataclass(frozen=True)
class Unmeasured(Timed):
    """A drawing led to no solid that anything could be decided on; `entry` is what the record says of it."""

    entry: Entry


@dataclass(frozen=True)
class Voided(Timed):
    """Something of the evidence has changed."""

    what: str


@dataclass(frozen=True)
class PicturesSent(OnProposal):
    """All that shows a proposal is on its way to a page."""


@dataclass(frozen=True)
class ClassNamed(OnProposal):
    """The operator says what the object is, before the proposal is shown."""

    kind: Kind


@dataclass(frozen=True)
class OverrideTyped(OnProposal):
    """Another tool than the proposed one is to be confirmed, for a reason."""

    tool: str
    reason: str


@dataclass(frozen=True)
class OverrideDropped(OnProposal):
    """The proposed tool is to be confirmed after all."""


@dataclass(frozen=True)
class ArmPressed(OnProposal):
    """The first of the two actions."""


@dataclass(frozen=True)
class HoldTicked(OnProposal):
    """The button of the second action is down; ten of these come in a second."""


@dataclass(frozen=True)
class RejectPressed(OnProposal):
    """The proposal, or what was confirmed, is rejected."""

    reason: str


@dataclass(frozen=True)
class FrameOpened(Timed):
    """A frame is held from now on."""

    facts: FrameFacts
    wall_s: float
    """By this machine's clock, Unix time."""


@dataclass(frozen=True)
class FrameReopened(FromPage):
    """The recorded frame that is held is opened again."""

    wall_s: float


@dataclass(frozen=True)
class FrameArrived(Timed):
    """A newer frame than the one that is held."""

    facts: FrameFacts
    wall_s: float
    changed: bool = False
    """Whether it shows something else in the area."""


@dataclass(frozen=True)
class AreaCompared(Timed):
    """The area, drawn anew, was compared with the newest frame."""

    changed: bool


@dataclass(frozen=True)
class Written(Timed):
    """The first so many entries of the outbox are on disk."""

    count: int


@dataclass(frozen=True)
class NotWritten(Timed):
    """The outbox cannot be written."""

    why: str


@dataclass(frozen=True)
class ClockTicked(Timed):
    """Time has passed."""


DecisionEvent = (
    PageCame
    | PageWent
    | PageHeard
    | ControlTaken
    | ControlGiven
    | ControlAsked
    | HandoverAnswered
    | Offered
    | Unmeasured
    | Voided
    | PicturesSent
    | ClassNamed
    | OverrideTyped
    | OverrideDropped
    | ArmPressed
    | HoldTicked
    | RejectPressed
    | FrameOpened
    | FrameReopened
    | FrameArrived
    | AreaCompared
    | Written
    | NotWritten
    | ClockTicked
)

"""A decision that is told of events, with a clock of its own."""

from dataclasses import replace
from math import inf

from app.deciding.events import (
    ArmPressed,
    ControlTaken,
    DecisionEvent,
    FrameOpened,
    HoldTicked,
    Offered,
    PageCame,
    PicturesSent,
    Written,
)
from app.deciding.settings import DecisionSettings
from app.deciding.states import Deciding, Offer
from app.deciding.step import decide
from app.deciding.watchdog import FrameFacts
from app.record.entries import Entry

WHY = "the cutter is blunt today"
ANN, BOB = 1, 2
WALL_S = 1.8e9
TICK_S = 0.1
OFFER = Offer(0, "digest 0", "cylinder", "cutter", ("cutter", "clipper", "grip"), frozenset({"grip"}))
FRAME = FrameFacts("pixels")
ALWAYS_THERE = DecisionSettings(silent_s=inf)
"""Nobody falls silent, however long a test waits."""


class Table:
    """Ann is in control, Bob watches, and a cutter is proposed for a cylinder."""

    def __init__(
        self, settings: DecisionSettings | None = None, offer: Offer = OFFER, frame: FrameFacts = FRAME
    ) -> None:
        self.deciding, self.now = Deciding(settings or ALWAYS_THERE), 100.0
        self.written: list[Entry] = []
        self.do(
            FrameOpened(self.now, frame, WALL_S),
            PageCame(self.now, ANN, "Ann"),
            PageCame(self.now, BOB, "Bob"),
            ControlTaken(self.now, ANN),
        )
        self.propose(offer)

    @property
    def number(self) -> int:
        """Of the present proposal."""
        assert self.deciding.case is not None
        return self.deciding.case.number

    @property
    def state(self) -> str:
        case = self.deciding.case
        return "nothing" if case is None else type(case.stage).__name__.lower()

    @property
    def kinds(self) -> list[str]:
        return [entry.kind for entry in self.written]

    def do(self, *events: DecisionEvent) -> None:
        """Let events happen, and have them written."""
        for event in events:
            self.now = max(self.now, event.at)
            self.deciding = decide(self.deciding, event)
            self.written += self.deciding.outbox
            self.deciding = decide(self.deciding, Written(self.now, len(self.deciding.outbox)))

    def propose(self, offer: Offer = OFFER, page: int = ANN) -> None:
        self.do(Offered(self.now, offer, Entry("proposal", "Ann", offer.digest)))
        self.do(PicturesSent(self.now, page, self.number))

    def arm(self, page: int = ANN) -> None:
        self.do(ArmPressed(self.now, page, self.number))

    def hold(self, seconds: float = 1.3, page: int = ANN, every_s: float = TICK_S, number: int | None = None) -> None:
        """Ticks of a held button, from now on."""
        number, start = self.number if number is None else number, self.now
        for count in range(round(seconds / every_s) + 1):
            self.do(HoldTicked(start + count * every_s, page, number))

    def later(self, seconds: float) -> float:
        self.now += seconds
        return self.now

    def said_to(self, page: int) -> str:
        return next((said.text for said in self.deciding.said if said.page == page), "")


def offer(digest: str, **changes: object) -> Offer:
    return replace(OFFER, digest=digest, **changes)

"""A decision under watch: whatever happens to it, nothing is armed or confirmed that should not be."""

from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize

from app.deciding.events import (
    ArmPressed,
    ControlTaken,
    DecisionEvent,
    FrameOpened,
    HoldTicked,
    PageCame,
    PageWent,
    PicturesSent,
)
from app.deciding.settings import DecisionSettings
from app.deciding.states import Armed, Decided, Deciding
from app.deciding.step import decide
from app.deciding.watchdog import FrameFacts
from tests.deciding.desk import WALL_S

LIMITS = DecisionSettings(arm_s=10.0, answer_s=3.0, silent_s=20.0, valid_s=30.0, max_age_s=200.0)


class Watched(RuleBasedStateMachine):
    """A decision, and beside it what was done and may therefore be true of it."""

    @initialize(dangerous=st.booleans())
    def start(self, dangerous: bool) -> None:
        """The program starts."""
        limits = DecisionSettings(**{**vars(LIMITS), "dangerous": frozenset({"cylinder"} if dangerous else ())})
        self.deciding, self.now, self.count, self.digest = Deciding(limits), 0.0, 0, ""
        self.confirmed = 0
        self._forget()
        self.do(FrameOpened(self.now, FrameFacts("held"), WALL_S))
        self.do(PageCame(self.now, 0, "page 0"))
        self.do(ControlTaken(self.now, 0))

    def _forget(self) -> None:
        self.presses: set[tuple[int, int, float]] = set()
        """Page, proposal and time of every press of ARM."""
        self.ticks: list[tuple[int, int, float]] = []
        self.came: dict[int, float] = {}
        self.pictured: set[tuple[int, int]] = set()

    def do(self, event: DecisionEvent) -> None:
        before = self.deciding
        self._note(event)
        self.deciding = decide(before, event)
        self._check(before, event, self.deciding)

    def _note(self, event: DecisionEvent) -> None:
        match event:
            case ArmPressed():
                self.presses.add((event.page, event.number, event.at))
            case HoldTicked():
                self.ticks.append((event.page, event.number, event.at))
            case PicturesSent():
                self.pictured.add((event.page, event.number))
            case PageCame():
                self.came.setdefault(event.page, event.at)
            case PageWent():
                self.came.pop(event.page, None)
            case _:
                pass

    def _check(self, before: Deciding, event: DecisionEvent, after: Deciding) -> None:
        assert after.control.holder is None or after.now - after.control.heard <= LIMITS.silent_s
        was = None if before.case is None else before.case.stage
        now = None if after.case is None else after.case.stage
        if isinstance(now, Armed):
            self._check_armed(before, event, after, now, fresh=now != was)
        if isinstance(now, Decided) and now != was:
            self._check_decided(before, event, after, now)

    def _check_armed(self, before: Deciding, event: DecisionEvent, after: Deciding, now: Armed, fresh: bool) -> None:
        assert after.case is not None
        page = now.page
        assert (page, after.case.number, now.since) in self.presses
        assert page == after.control.holder
        assert page in self.came, "the page that armed it is open"
        assert now.since >= self.came[page], "and has been since"
        assert after.now <= now.since + LIMITS.arm_s
        assert after.case.offer.digest == self.digest
        assert after.fault is None
        assert (page, after.case.number) in self.pictured
        assert after.case.override is not None or not after.case.in_the_way
        assert not fresh or isinstance(event, ArmPressed)

    def _check_decided(self, before: Deciding, event: DecisionEvent, after: Deciding, now: Decided) -> None:
        assert isinstance(event, HoldTicked)
        assert before.case is not None
        assert after.case is not None
        assert isinstance(before.case.stage, Armed), "what is confirmed was armed"
        assert before.control.holder == before.case.stage.page == event.page == now.page
        assert before.case.number == after.case.number == event.number
        assert after.case.offer.digest == self.digest, "on the evidence as it is"
        assert (now.how == "overridden") == (after.case.override is not None)
        since = before.case.stage.since
        assert (event.page, event.number, since) in self.presses
        assert event.at <= since + LIMITS.arm_s, "within its time"
        run = [event.at]
        for by, number, then in reversed(self.ticks[:-1]):
            if (by, number) != (event.page, event.number) or run[-1] - then > LIMITS.hold_gap_s or then < since:
                break
            run.append(then)
        assert len(run) >= LIMITS.hold_ticks
        assert run[0] - run[-1] >= LIMITS.hold_s
        assert after.outbox[-1].kind == now.how, "to be written before anybody is told"
        assert after.outbox[-1].digest == self.digest
        self.confirmed += 1

    def _number(self, back: int) -> int:
        return max(self.deciding.count - back, 1)

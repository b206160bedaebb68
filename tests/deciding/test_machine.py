"""Whatever happens in whatever order: nothing is confirmed that was not armed and held, and nothing stays armed."""

from dataclasses import replace

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import rule

from app.deciding.events import (
    AreaCompared,
    ArmPressed,
    ClassNamed,
    ClockTicked,
    ControlAsked,
    ControlGiven,
    ControlTaken,
    FrameArrived,
    FrameOpened,
    FrameReopened,
    HandoverAnswered,
    HoldTicked,
    NotWritten,
    Offered,
    OverrideDropped,
    OverrideTyped,
    PageCame,
    PageHeard,
    PageWent,
    PicturesSent,
    RejectPressed,
    Voided,
    Written,
)
from app.deciding.states import Deciding
from app.deciding.watchdog import FrameFacts
from app.record.entries import Entry
from tests.deciding.desk import OFFER, WALL_S, offer
from tests.deciding.watched import Watched

FEW = settings(max_examples=150, stateful_step_count=40, deadline=None)
REASON = "a hand is in the way"
PAGES = st.integers(0, 2)
MOSTLY_0 = st.sampled_from([0, 0, 0, 0, 1, 2])
UPSETS = ("nothing", "nothing", "redrawn", "gone", "handed over", "and back", "another tool", "full disk", "pause")
BACK = st.integers(0, 2)
"""How many proposals ago."""


class Machine(Watched):
    """Pages, a camera, a disk and a clock that do what they like."""

    @rule(page=PAGES)
    def comes(self, page: int) -> None:
        self.do(PageCame(self.now, page, f"page {page}"))

    @rule(page=PAGES, again=st.booleans())
    def goes(self, page: int, again: bool) -> None:
        self.do(PageWent(self.now, page))
        if again:
            self.do(PageCame(self.now, page, f"page {page}"))
            assert self.deciding.control.holder != page, "whoever comes back watches"

    @rule(page=PAGES)
    def is_heard(self, page: int) -> None:
        self.do(ClockTicked(self.now))
        before = self.deciding.control
        self.do(PageHeard(self.now, page))
        heard = self.now if before.holder == page else before.heard
        assert self.deciding.control == replace(before, heard=heard), "nothing else comes of it"

    @rule(page=PAGES, kind=st.sampled_from([ControlTaken, ControlTaken, ControlGiven, ControlAsked]))
    def control(self, page: int, kind: type[ControlTaken] | type[ControlGiven] | type[ControlAsked]) -> None:
        self.do(kind(self.now, page))

    @rule(page=PAGES, granted=st.booleans())
    def answers(self, page: int, granted: bool) -> None:
        self.do(HandoverAnswered(self.now, page, granted))

    @rule(
        tool=st.sampled_from(["grip", "grip", "cutter", None]),
        sent=st.sampled_from([True, True, False]),
        hits=st.sampled_from([False, True]),
    )
    def measured(self, tool: str | None, sent: bool, hits: bool = False) -> None:
        self.count += 1
        self.digest = f"digest {self.count}"
        made = offer(self.digest, tool=tool, in_the_way={"grip": ("It would hit a pipe.",)} if hits else {})
        self.do(Offered(self.now, made, Entry("proposal", "somebody", self.digest)))
        if sent:
            self.pictures(0)

    @rule(back=BACK)
    def pictures(self, back: int) -> None:
        holder = self.deciding.control.holder
        if holder is not None:
            self.do(PicturesSent(self.now, holder, self._number(back)))

    @rule()
    def drawn(self) -> None:
        self.digest = ""
        self.do(Voided(self.now, "the drawing was changed"))
        assert self.deciding.case is None

    @rule(page=PAGES, back=BACK, kind=st.sampled_from(["cylinder", "cylinder", "sphere"]))
    def names(self, page: int, back: int, kind: str) -> None:
        self.do(ClassNamed(self.now, page, self._number(back), kind))

    @rule(page=PAGES, back=BACK, tool=st.sampled_from(["grip", "clipper", "-"]), drop=st.booleans())
    def overrides(self, page: int, back: int, tool: str, drop: bool) -> None:
        number = self._number(back)
        self.do(
            OverrideDropped(self.now, page, number) if drop else OverrideTyped(self.now, page, number, tool, REASON)
        )

    @rule(page=PAGES, back=BACK)
    def arms_it(self, page: int, back: int) -> None:
        self.do(ArmPressed(self.now, page, self._number(back)))

    @rule(page=PAGES, back=BACK)
    def rejects(self, page: int, back: int) -> None:
        self.do(RejectPressed(self.now, page, self._number(back), REASON))

    @rule(page=PAGES, back=BACK, count=st.integers(1, 16), every_s=st.sampled_from([0.1, 0.1, 0.2, 0.35, 0.45, 1.0]))
    def holds(self, page: int, back: int, count: int, every_s: float) -> None:
        number = self._number(back)
        for _ in range(count):
            self.do(HoldTicked(self.now, page, number))
            self.now += every_s

    @rule(
        armer=MOSTLY_0,
        holder=MOSTLY_0,
        arm_back=MOSTLY_0,
        hold_back=MOSTLY_0,
        every_s=st.sampled_from([0.1, 0.1, 0.1, 0.17, 0.45]),
        wait_s=st.sampled_from([0.0, 0.0, 0.0, 9.3]),
        upset=st.sampled_from(UPSETS),
        when=st.integers(0, 12),
    )
    def decides(
        self,
        armer: int,
        holder: int,
        arm_back: int,
        hold_back: int,
        every_s: float,
        wait_s: float,
        upset: str,
        when: int,
    ) -> None:
        """The whole way to a confirmation, by and large, with one thing on it that may go wrong."""
        page = self._all_is_well()
        self.do(ArmPressed(self.now, (page + armer) % 3, self._number(arm_back)))
        self.now += wait_s
        for count in range(14):
            if count == when:
                self._upset(upset, page)
            self.do(HoldTicked(self.now, (page + holder) % 3, self._number(hold_back)))
            self.now += every_s

    def _all_is_well(self) -> int:
        """Somebody is in control of a proposal that can be armed."""
        if self.deciding.control.holder is None:
            self.do(PageCame(self.now, 0, "page 0"))
            self.do(ControlTaken(self.now, 0))
        page = self.deciding.control.holder or 0
        self.do(FrameOpened(self.now, FrameFacts("held"), WALL_S))
        self.do(Written(self.now, len(self.deciding.outbox)))
        self.measured("grip", True)
        self.do(ClassNamed(self.now, page, self.deciding.count, "cylinder"))
        return page

    def _upset(self, upset: str, page: int) -> None:
        other = (page + 1) % 3
        match upset:
            case "redrawn":
                self.measured("grip", True)
            case "gone":
                self.goes(page, True)
                self.do(ControlTaken(self.now, page))
                self.pictures(0)
            case "handed over":
                self.do(PageCame(self.now, other, "another"))
                self.do(ControlAsked(self.now, other))
                self.do(HandoverAnswered(self.now, page, True))
                self.pictures(0)
            case "and back":
                self._upset("handed over", page)
                self.do(ControlGiven(self.now, self.deciding.control.holder or 0))
                self.do(ControlTaken(self.now, page))
                self.pictures(0)
            case "another tool":
                self.overrides(page, 0, "clipper", False)
            case "full disk":
                self.disk(False)
            case "pause":
                self.now += 0.5
            case _:
                pass

    @rule(seconds=st.sampled_from([0.05, 0.5, 2.0, 4.0, 15.0, 90.0]), told=st.booleans())
    def later(self, seconds: float, told: bool) -> None:
        self.now += seconds
        if told:
            self.do(ClockTicked(self.now))

    @rule(works=st.sampled_from([True, True, True, False]))
    def disk(self, works: bool) -> None:
        count = len(self.deciding.outbox)
        self.do(Written(self.now, count) if works else NotWritten(self.now, "the disk is full"))
        assert works or self.deciding.armed is None, "nothing is armed while nothing can be recorded"

    @rule(
        pixels=st.sampled_from(["held", "other", "another"]),
        sequence=st.integers(1, 5),
        ahead_s=st.sampled_from([0.0, 9.0]),
        changed=st.booleans(),
    )
    def newer(self, pixels: str, sequence: int, ahead_s: float, changed: bool) -> None:
        facts = FrameFacts(pixels, "live", sequence, WALL_S + ahead_s)
        self.do(FrameArrived(self.now, facts, WALL_S, changed))
        assert not (changed and self.deciding.armed)

    @rule(changed=st.booleans())
    def drawn_elsewhere(self, changed: bool) -> None:
        self.do(AreaCompared(self.now, changed))
        assert not (changed and self.deciding.armed)

    @rule(page=PAGES, again=st.booleans())
    def frame(self, page: int, again: bool) -> None:
        if again:
            self.do(FrameReopened(self.now, page, WALL_S))
        else:
            self.digest = ""
            self.do(FrameOpened(self.now, FrameFacts(OFFER.digest), WALL_S))
            assert self.deciding.case is None

    @rule()
    def restarts(self) -> None:
        """The program ends and starts again: all that it knew is gone."""
        self.deciding, self.digest = Deciding(self.deciding.settings), ""
        self._forget()
        assert self.deciding.armed is None
        self.do(FrameOpened(self.now, FrameFacts("held"), WALL_S))


TestMachine = Machine.TestCase
TestMachine.settings = FEW

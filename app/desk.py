"""Where decisions are prepared and put on disk: beside the console's queue, on which it posts what has come of it."""

import asyncio
import logging
from collections.abc import Callable, Collection
from dataclasses import dataclass

from app.clock import seconds
from app.deciding.events import ClockTicked, Offered, PicturesSent, Unmeasured, Written
from app.digest import evidence_digest
from app.proposing import Evidence, evidence_shown, offered
from app.record.entries import Entry
from app.record.store import Record
from app.recording import write
from app.session import Session, step
from rotrecon.frame import Frame
from rotrecon.settings import Settings

TICK_S = 0.5
"""How often time is looked at: a countdown in seconds, and a retry of a disk that did not obey."""
log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Proposable:
    """What was shown is ready to be proposed, unless that has failed."""

    evidence: Evidence
    event: Offered | Unmeasured | None


Posted = Proposable | ClockTicked | PicturesSent


class Desk:
    """Everything but `write` runs in the console's event loop."""

    def __init__(self, record: Record | None, post: Callable[[Posted], None]) -> None:
        self._record, self._post = record, post
        self._evidence: Evidence | None = None
        self._measured_in: dict[str | None, Frame] = {}
        """Frames by the digest of entries that are not yet on disk: views have another one for every area, and the
        frame that is held may be another one by then."""
        self._preparing: asyncio.Task[None] | None = None
        self.written = 0
        """How many times something was put on disk."""

    @property
    def busy(self) -> bool:
        """Whether a proposal is being prepared."""
        return self._preparing is not None

    async def tick(self) -> None:
        """Tell again and again that time has passed."""
        while True:
            await asyncio.sleep(TICK_S)
            self._post(ClockTicked(seconds()))

    def prepare(self, session: Session) -> None:
        """Start preparing what is shown as a proposal, once, and one after the other."""
        evidence = evidence_shown(session)
        if evidence is None or self.busy or evidence == self._evidence:
            return
        self._evidence = evidence
        control = session.decision.control
        self._preparing = asyncio.create_task(self._prepare(evidence, control.name(control.holder)))

    def taken(self, session: Session, item: Proposable) -> Session:
        """The session with a proposal that was prepared, if it is still of what is shown."""
        self._preparing = None
        if item.event is None or evidence_shown(session) != item.evidence:
            return session
        self._measured_in[item.event.entry.digest] = item.evidence.result.frame
        return step(session, item.event)

    async def recorded(self, session: Session, again: bool) -> Session:
        """The session as it may be told: all of it on disk, or what is not has not happened.

        After a failure it is tried `again` only when that is asked for.
        """
        decision, evidence, settings = session.decision, self._evidence, session.settings
        if not decision.outbox or (decision.fault is not None and not again):
            return session
        for event in await asyncio.to_thread(
            write, self._record, decision.outbox, self._frame_of, lambda: _digest(evidence, settings)
        ):
            session = step(session, event)
            self.written += 1 if isinstance(event, Written) else 0
        waiting = {entry.digest for entry in session.decision.outbox}
        self._measured_in = {digest: frame for digest, frame in self._measured_in.items() if digest in waiting}
        if session.decision.fault not in (None, decision.fault):
            log.error("nothing can be decided: %s", session.decision.fault)
        return session

    def shown(self, session: Session, pages: Collection[int]) -> None:
        """Let a proposal be armed now that all that shows it is on its way to the page in control."""
        case, holder = session.decision.case, session.decision.control.holder
        if case is not None and not case.ready and holder is not None and holder in pages:
            self._post(PicturesSent(seconds(), holder, case.number))

    def stop(self) -> tuple[asyncio.Task[None], ...]:
        """Give up what is being prepared; the tasks to wait for."""
        if self._preparing is None:
            return ()
        self._preparing.cancel()
        return (self._preparing,)

    def _frame_of(self, entry: Entry) -> Frame:
        return self._measured_in[entry.digest]

    async def _prepare(self, evidence: Evidence, who: str) -> None:
        event: Offered | Unmeasured | None = None
        try:
            event = await asyncio.to_thread(offered, evidence, who)
        except Exception:
            log.exception("the measurement cannot be proposed")
        finally:
            self._post(Proposable(evidence, event))


def _digest(evidence: Evidence | None, settings: Settings) -> str | None:
    """Of the evidence as it is at this moment."""
    if evidence is None:
        return None
    return evidence_digest(evidence.result.frame, evidence.drawing, settings, evidence.result)

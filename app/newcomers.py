"""Brings what has come after the held frame into the session, and makes a frame of what is taken, beside the queue."""

import asyncio
import logging
from collections.abc import Callable

from app.clock import seconds, wall_s
from app.deciding.events import AreaCompared
from app.describe import matching_notes
from app.held import Held, Newer
from app.newer_frames import shows_change
from app.newer_steps import NewerCame, NewerPrepared, NewerReady, NewerUnusable
from app.session import Session, step
from rotrecon.capture import Capture
from rotrecon.frame import FrameUnavailable

OWN_MISTAKE = "the program failed on it, which is its own mistake; push in another one"
log = logging.getLogger(__name__)

Posted = NewerPrepared | NewerReady | NewerUnusable


class Newcomers:
    """Runs in the console's event loop, on whose queue it posts what has come of it."""

    def __init__(self, post: Callable[[Posted], None]) -> None:
        self._post = post
        self._matching: asyncio.Task[None] | None = None
        self._compared: object = None

    @property
    def busy(self) -> bool:
        """Whether a frame is being made."""
        return self._matching is not None

    def came(self, session: Session, newer: Newer) -> Session:
        """The session after a recording has arrived."""
        self._compared = _compared(session, newer)
        return step(session, NewerCame(seconds(), newer, wall_s(), _changed(session, newer)))

    def taken_in(self, session: Session, item: Posted) -> Session:
        """The session with what has come of one that is being taken; one that came meanwhile is newer than it too."""
        if not isinstance(item, NewerPrepared):
            self._matching = None
        after = step(session, item)
        if after.held is not session.held and after.newer is not None:
            return self.came(after, after.newer)
        return after

    def compared(self, session: Session) -> Session:
        """The session that knows whether the newest frame shows a change in the area as it is drawn now."""
        newer = session.newer
        if newer is None or self._compared == _compared(session, newer):
            return session
        self._compared = _compared(session, newer)
        return step(session, AreaCompared(seconds(), _changed(session, newer)))

    def prepare(self, session: Session) -> None:
        """Start to make a frame of what is taken, once, and one after the other."""
        if session.taking is not None and not self.busy:
            self._matching = asyncio.create_task(self._match(session.taking.newer))

    def stop(self) -> tuple[asyncio.Task[None], ...]:
        """Give up what is being made; the tasks to wait for."""
        if self._matching is None:
            return ()
        self._matching.cancel()
        return (self._matching,)

    async def _match(self, newer: Newer) -> None:
        item: NewerReady | NewerUnusable = NewerUnusable(newer.number, OWN_MISTAKE)
        try:
            await asyncio.to_thread(_prepare, newer.capture)
            self._post(NewerPrepared(newer.number))
            frame = await asyncio.to_thread(newer.capture.frame)
            if isinstance(frame, FrameUnavailable):
                item = NewerUnusable(newer.number, frame.reason)
            else:
                notes = (*newer.capture.notes, *matching_notes(frame))
                held = Held(frame, newer.capture.name, newer.capture, notes)
                item = NewerReady(seconds(), newer.number, held, wall_s())
        except Exception:
            log.exception("no frame can be made of %s", newer.capture.name)
        finally:
            self._post(item)


def _prepare(capture: Capture) -> None:
    """Find out about views what the capture keeps for later; of a recorded frame there is nothing to find out."""
    if capture.views:
        _ = capture.prepared


def _changed(session: Session, newer: Newer) -> bool:
    area = session.objects[session.selected].area
    return session.held is None or shows_change(session.held.frame, newer.capture, area)


def _compared(session: Session, newer: Newer) -> object:
    """What the comparison depends on."""
    return (newer.number, session.held, session.objects[session.selected].area)

"""Measurements under way: the newest drawing's first, in threads, and few at once."""

import asyncio
from collections.abc import Callable

from app.clock import seconds
from app.events import Reconstructed
from app.held import Held
from app.measuring import measure, measure_finely
from app.session import Session
from rotrecon.drawing import Drawing
from rotrecon.settings import Settings

MOST_MEASUREMENTS = 2
"""Under way at once: the newest drawing need not wait for an older one, and a drag does not pile them up."""
MOST_LIVE_S = 0.2
"""Where a measurement takes longer, nothing is measured in the middle of a drag: its end would have to wait for it."""


class Measurements:
    """Runs in the console's event loop; what comes of a measurement is posted there."""

    def __init__(self, post: Callable[[Reconstructed], None]) -> None:
        self._post = post
        self._running: dict[int, asyncio.Task[None]] = {}
        self._took_s = 0.0

    @property
    def busy(self) -> bool:
        """Whether anything is being measured."""
        return bool(self._running)

    def start(self, session: Session) -> None:
        """Measure the drawing as it is now, unless that is done, under way, or has to wait for its turn."""
        drawing, held = session.shown.complete, session.held
        if drawing is None or held is None or session.up_to_date or session.revision in self._running:
            return
        if session.drag == "running" and self._took_s > MOST_LIVE_S:
            return
        if len(self._running) < MOST_MEASUREMENTS:
            measuring = self._measure(session.revision, drawing, session.settings, held, session.measured_once)
            self._running[session.revision] = asyncio.create_task(measuring)

    def done(self, revision: int) -> None:
        """That of a revision has come back."""
        del self._running[revision]

    def stop(self) -> tuple[asyncio.Task[None], ...]:
        """Give up what is under way; the tasks to wait for."""
        for task in self._running.values():
            task.cancel()
        return tuple(self._running.values())

    async def _measure(self, revision: int, drawing: Drawing, settings: Settings, held: Held, finely: bool) -> None:
        views, begun_s = held.finely, seconds()
        if views is not None and finely:
            outcome = await asyncio.to_thread(measure_finely, views, drawing, settings)
        else:
            outcome = await asyncio.to_thread(measure, held.frame, drawing, settings)
        self._took_s = seconds() - begun_s
        self._post(Reconstructed(revision, outcome, coarse=views is not None and not finely))

"""The operator's console: one queue of events into the session, measurements beside it, and pages that show it."""

import asyncio
import io
import logging
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import replace

from viser import ClientHandle, ViserServer

from app.adjustable import Chosen
from app.archive import Archive, Exported, Fetched, Listed, Told
from app.browsing import Asked
from app.clock import seconds, wall_s
from app.console_items import CameraMoved, FromPage, Item, PageClosed, PageOpened, Stopped
from app.deciding.events import (
    ClockTicked,
    DecisionEvent,
    FrameOpened,
    PageCame,
    PageHeard,
    PageWent,
    PicturesSent,
    Voided,
)
from app.deciding.settings import DecisionSettings
from app.deciding.states import Deciding
from app.decision_text import face
from app.desk import Desk, Proposable
from app.events import Event, Reconstructed
from app.heartbeat import Heartbeat
from app.held import Held, Newer
from app.last_session import LastSessions
from app.measurements import Measurements
from app.mishaps import logged
from app.newcomers import Newcomers
from app.newer_frames import facts_of
from app.newer_steps import NewerPrepared, NewerReady, NewerUnusable
from app.page_view import BRAND_COLOR, PageView
from app.pages import Pages
from app.panels import Panels
from app.record.store import Record
from app.reopening import BroughtBack
from app.session import Done, Session, step
from rotrecon.capture import Capture
from rotrecon.frame import Frame
from rotrecon.settings import Settings

CLOUD_POINTS = 40_000
"""Points of the cloud that are sent to a page: half a megabyte."""
SOMEBODY = "operator"
"""Who is at a page when nobody had to log in."""
CLOSED = "the console was closed"
log = logging.getLogger(__name__)


class Console:
    """One frame, shown to any number of pages, until the one in control takes a newer one.

    Everything that happens is put on one queue, in viser's event loop; there it steps the session, starts a
    measurement in a thread, and is shown. `idle` tells when nothing of that is left to do.
    """

    def __init__(
        self,
        frame: Frame,
        name: str,
        settings: Settings,
        host: str = "127.0.0.1",
        port: int = 8080,
        *,
        notes: tuple[str, ...] = (),
        cloud_points: int = CLOUD_POINTS,
        open_viser: Callable[[], ViserServer] | None = None,
        record: Record | None = None,
        deciding: DecisionSettings | None = None,
        name_of: Callable[[int], str | None] = lambda client_id: SOMEBODY,
        capture: Capture | None = None,
        last: LastSessions | None = None,
        tour: bool = False,
    ) -> None:
        """Without a `record` nothing can be decided; `name_of` says who is behind one of viser's clients.

        `open_viser` starts the server that its pages are on; without, one listens on `host` and `port` itself. What was
        drawn and set in the `last` session on this frame is there again. A `tour` leads every page that is opened.
        """
        deciding = deciding or DecisionSettings()
        chosen = Chosen(replace(settings, dangerous=deciding.dangerous), deciding)
        held = Held(frame, name, capture or Capture(name, recorded=frame), notes)
        self.session = Session(
            held.size_px, decision=Deciding(deciding), held=held, settings=chosen.measuring, defaults=chosen
        )
        self._last, self._tour = last, tour
        if last is not None:
            self.session = last.resumed(self.session)
            told = () if last.problem is None else (last.problem,)
            self.session = replace(self.session, held=replace(held, notes=(*notes, *told)))
        self.told = self.session
        """What pages and robots are told, all of it on disk; read it from any thread."""
        self._name_of = name_of
        self._heartbeat, self._archive = Heartbeat(deciding.silent_s), Archive(record, self.post)
        self._desk, self._newcomers = Desk(record, self.post), Newcomers(self.post)
        self._measurements = Measurements(self.post)
        self._host, self._port, self._cloud_points = host, port, cloud_points
        self._open_viser = open_viser or self._open_server
        self._listeners: dict[object, Callable[[], object]] = {}

    @property
    def held(self) -> Held:
        """What everybody is told that is drawn on and measured in."""
        assert self.told.held is not None
        return self.told.held

    @property
    def frame(self) -> Frame:
        """The frame of that."""
        return self.held.frame

    @property
    def pages(self) -> dict[int, PageView]:
        """The open pages, by their clients' numbers."""
        return self._shown.views

    @property
    def panels(self) -> Panels:
        """What all of them share."""
        return self._shown.panels

    @property
    def address(self) -> str:
        """The address that was really got, which is another port when the one asked for is taken."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"http://{host}:{self.server.get_port()}"

    def start(self) -> None:
        """Open the server and show the frame; returns when pages can be opened."""
        self.server = self._open_viser()
        self.server.request_share_url = _refuse_to_share
        self._loop = self.server.get_event_loop()
        self._queue: asyncio.Queue[Item] = asyncio.Queue()
        self._settled = asyncio.Event()
        self.server.gui.configure_theme(
            dark_mode=True, show_logo=False, show_share_button=False, brand_color=BRAND_COLOR
        )
        self._shown = Pages(self.server, self.held, self._cloud_points, self.post, tour=self._tour)
        self.session = step(self.session, FrameOpened(seconds(), facts_of(self.frame), wall_s()))
        self.panels.show(self.session)
        self._running = asyncio.run_coroutine_threadsafe(self._run(), self._loop)
        self.server.on_client_connect(self._page_opened)
        self.server.on_client_disconnect(self._page_closed)

    def _open_server(self) -> ViserServer:
        with redirect_stdout(io.StringIO()):
            return ViserServer(self._host, self._port, verbose=False)

    def end(self) -> None:
        """Take in nothing more: what was decided counts no more, which is recorded and told before this returns."""
        self._loop.call_soon_threadsafe(self.post, Stopped())
        self._running.result()

    def stop(self) -> None:
        """Close the server and every page, when what is being shown is shown; measurements are given up."""
        self.end()
        with redirect_stdout(io.StringIO()):
            self.server.stop()

    def newer(self, newer: Newer) -> None:
        """Announce a recording that came after the frame that is held; of any thread."""
        self._loop.call_soon_threadsafe(self.post, newer)

    def subscribe(self, changed: Callable[[], object]) -> Callable[[], object]:
        """Call `changed`, quickly done, after the session may have changed; returns what ends that. Of any thread."""
        listener = object()
        self._listeners[listener] = changed
        return lambda: self._listeners.pop(listener, None)

    async def idle(self) -> None:
        """Return, in viser's event loop, when the queue is empty, nothing is measured, and all is shown and flushed."""
        await self._settled.wait()

    def wait_until_idle(self, timeout_s: float = 30.0) -> None:
        """`idle` for other threads."""
        asyncio.run_coroutine_threadsafe(self.idle(), self._loop).result(timeout_s)

    def post(self, item: Item) -> None:
        """Put something on the queue; only in viser's event loop."""
        self._settled.clear()
        self._queue.put_nowait(item)

    async def _run(self) -> None:
        """Take what has happened, as much as there is, then show what has become of it."""
        ticking = asyncio.create_task(self._desk.tick())
        while True:
            items = [await self._queue.get()]
            while not self._queue.empty():
                items.append(self._queue.get_nowait())
            if Stopped() in items:
                break
            for item in items:
                with logged("what happened was not taken in"):
                    self._take(item)
            self.session = self._newcomers.compared(self.session)
            self._measurements.start(self.session)
            self._desk.prepare(self.session)
            self._newcomers.prepare(self.session)
            browsing = {client_id: page.state.browsing for client_id, page in self.pages.items()}
            self._archive.look(browsing, self._desk.written, self.session.decision.veiled, seconds())
            only_time = all(isinstance(item, ClockTicked | PageHeard) for item in items)
            with logged("what happened was not recorded"):
                await self._tell(not only_time, any(isinstance(item, ClockTicked) for item in items))
            beside = (self._measurements, self._desk, self._newcomers, self._archive)
            if self._queue.empty() and not any(one.busy for one in beside):
                self._settled.set()
        self.session = step(self.session, Voided(seconds(), CLOSED))
        with logged("the end was not recorded"):
            await self._tell(happened=True, ticked=True)
        ticking.cancel()
        beside = (self._measurements, self._desk, self._newcomers, self._archive)
        tasks = (ticking, *(task for one in beside for task in one.stop()))
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _tell(self, happened: bool, ticked: bool) -> None:
        """Put on disk what has become of it, then tell pages and listeners, if there is anything that they can see."""
        before = self.told
        self.session = await self._desk.recorded(self.session, again=ticked)
        self.told = self.session
        if not happened and face(before.decision) == face(self.told.decision):
            return
        for changed in list(self._listeners.values()):
            with logged("a listener was not told"):
                changed()
        await asyncio.to_thread(self._show)
        self._desk.shown(self.told, self.pages)

    def _take(self, item: Item) -> None:
        match item:
            case FromPage(client_id, event):
                self.session = step(self.session, PageHeard(seconds(), client_id))
                if isinstance(event, Event):
                    self.session = step(self.session, Done(client_id, event))
                elif isinstance(event, DecisionEvent | BroughtBack):
                    self.session = step(self.session, event)
                elif isinstance(event, Asked):
                    self._archive.ask(client_id, event, self.session.decision.veiled)
                elif client_id in self.pages:
                    self.pages[client_id].take(event, self.session.visible)
            case Reconstructed(revision):
                self._measurements.done(revision)
                self.session = step(self.session, item)
            case Proposable():
                self.session = self._desk.taken(self.session, item)
            case Fetched():
                self.session = step(self.session, item.opening(seconds(), wall_s()))
            case Listed() | Told() | Exported():
                for client_id in set(item.pages) & set(self.pages):
                    self.pages[client_id].told(item)
            case Newer():
                self.session = self._newcomers.came(self.session, item)
            case NewerPrepared() | NewerReady() | NewerUnusable():
                self.session = self._newcomers.taken_in(self.session, item)
            case ClockTicked(at):
                self.session = step(self.session, item)
                self._heartbeat.ask(self.session.decision.control.holder, at, self.server.get_clients())
            case PicturesSent() | PageHeard():
                self.session = step(self.session, item)
            case PageOpened(client):
                self._shown.opened(client)
                name = self._name_of(client.client_id) or SOMEBODY
                self.session = step(self.session, PageCame(seconds(), client.client_id, name))
            case PageClosed(client_id):
                self._shown.closed(client_id)
                self.session = step(self.session, PageWent(seconds(), client_id))
            case CameraMoved() | Stopped():
                pass

    def _show(self) -> None:
        """Show the session on every page, and keep what is drawn and set; runs in a thread, and only one at a time."""
        self._shown.show(self.told.visible, self.held)
        if self._last is not None:
            self._last.keep(self.told)

    async def _page_opened(self, client: ClientHandle) -> None:
        self.post(PageOpened(client))

    async def _page_closed(self, client: ClientHandle) -> None:
        self.post(PageClosed(client.client_id))


def _refuse_to_share(verbose: bool = True) -> None:
    """Viser's public tunnel would show a robot's cell to the world."""
    log.warning("a page asked for a public share link and was refused")

"""Every open page, and what they share: the panels, the scene, and the pictures of the frame that is held."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from viser import CameraHandle, ClientHandle, ViserServer

from app.browsing import Asked
from app.clock import seconds
from app.console_items import CameraMoved, FromPage, Item
from app.deciding.events import DecisionEvent, PageHeard
from app.events import Event
from app.held import Held
from app.mishaps import logged
from app.page import PageEvent
from app.page_view import PageView
from app.panels import Panels
from app.pictures import Pictures
from app.reopening import BroughtBack
from app.scene_view import SceneView
from app.session import Session


class Pages:
    """What happens on a page is posted; `show` runs in a thread of its own, the rest in viser's event loop."""

    def __init__(
        self, server: ViserServer, held: Held, cloud_points: int, post: Callable[[Item], None], *, tour: bool
    ) -> None:
        self._server, self._held, self._post, self._tour = server, held, post, tour
        self._pictures = Pictures(held.frame)
        self.views: dict[int, PageView] = {}
        self._opened: dict[int, ClientHandle] = {}
        self.panels = Panels(server, held, self._post_from)
        television = self._pictures.television(None, "picture")
        self._scene = SceneView(server, held.frame, television, cloud_points, self._post_from)

    def opened(self, client: ClientHandle) -> None:
        """A page that is shown something from now on."""
        self._opened[client.client_id] = client

    def closed(self, client_id: int) -> None:
        """A page that is not there any more."""
        self._opened.pop(client_id, None)
        self.views.pop(client_id, None)

    def show(self, session: Session, held: Held) -> None:
        """Show a session on every page; only once at a time."""
        if held is not self._held:
            with logged("the newer frame cannot be shown"):
                self._hold(held)
        with self._server.atomic():
            with logged("the panels cannot be shown"):
                self.panels.show(session)
            with logged("the scene cannot be shown"):
                self._scene.show(session.reconstruction, session.overriding, faint=not session.up_to_date)
        self._server.flush()
        while self._opened:
            client_id, client = self._opened.popitem()
            with self._unless_gone(client_id):
                self.views[client_id] = self._new_view(client)
        for client_id, page in list(self.views.items()):
            with self._unless_gone(client_id):
                with page.client.atomic():
                    page.show(session)
                page.client.flush()

    def _hold(self, held: Held) -> None:
        """Put another frame in the place of the one that is shown."""
        self._held, self._pictures = held, Pictures(held.frame)
        self.panels.hold(held)
        self._scene.hold(held.frame, self._pictures.television(None, "picture"))
        for client_id, page in list(self.views.items()):
            with self._unless_gone(client_id):
                page.hold(self._pictures)

    @contextmanager
    def _unless_gone(self, client_id: int) -> Iterator[None]:
        """Drop a page that was closed while something was done with it; log what goes wrong with an open one."""
        with logged(f"page {client_id} cannot be shown"):
            try:
                yield
            except Exception:
                if client_id in self._server.get_clients():
                    raise
                self.views.pop(client_id, None)

    def _new_view(self, client: ClientHandle) -> PageView:
        client.camera.on_update(self._camera_moved)
        return PageView(
            client,
            self._pictures,
            self.panels,
            self._scene,
            lambda event: self._post_from(client.client_id, event),
            self._tour,
        )

    def _post_from(self, client_id: int, event: Event | DecisionEvent | PageEvent | Asked | BroughtBack) -> None:
        self._post(FromPage(client_id, event))

    async def _camera_moved(self, camera: CameraHandle) -> None:
        client_id = camera.client.client_id
        self._post(PageHeard(seconds(), client_id))
        page = self.views.get(client_id)
        if page is not None and page.state.view == "camera":
            self._post(CameraMoved())

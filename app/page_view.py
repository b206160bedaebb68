"""One open page: what it shows of the session, its own choices, and what is done on its picture."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from viser import ClientHandle, NotificationHandle, SceneNodeDragEvent, SceneNodePointerEvent

from app.archive import Exported, Listed, Told
from app.browsing import Asked
from app.camera_view import CameraView
from app.charts import section_count
from app.covering import Covering
from app.deciding.events import DecisionEvent
from app.deciding.states import Said
from app.decision_panel import DecisionPanel
from app.events import Event, HandleMoved, PointerDragged, VertexClicked
from app.hint_panel import HintPanel
from app.history_panel import HistoryPanel, Looked
from app.inspection import residuals_in
from app.inspection_panel import InspectionPanel
from app.newer_panel import NewerPanel
from app.object_drawing import Part, Pixel, on_frame
from app.page import (
    EndPointed,
    PageEvent,
    PageState,
    PointTouched,
    SectionChosen,
    SectionPointed,
    ViewChosen,
    Zoomed,
    page_step,
    section_shown,
)
from app.page_panels import PagePanels
from app.panels import Panels
from app.pictures import Pictures
from app.pointer import PixelFinder
from app.reopening import BroughtBack
from app.scene_view import SceneView
from app.session import Notice, Session
from app.showing import in_session_unit
from app.tour import ticked
from rotrecon.reconstruction import Reconstruction

NOTICE_SECONDS = 10.0
BRAND_COLOR = (60, 147, 208)


class PageView:
    """The handles of one page; everything it shows is told to it."""

    def __init__(
        self,
        client: ClientHandle,
        pictures: Pictures,
        shared: Panels,
        scene: SceneView,
        post: Callable[[Event | DecisionEvent | PageEvent | Asked | BroughtBack], None],
        tour: bool = False,
    ) -> None:
        self.client, self.state = client, PageState(tour=0 if tour else None)
        self._pictures, self._scene, self._post = pictures, scene, post
        self._pixels = PixelFinder(pictures.frame)
        self._hint = HintPanel(client, shared.help, post)
        self._panels = PagePanels(client, shared, pictures, post)
        self._newer = NewerPanel(client, shared.decision, post)
        self._history = HistoryPanel(client, shared.history, post)
        self.looked = Looked()
        """What this page was told of the record."""
        self._decision = DecisionPanel(client, shared.decision, post)
        self._inspection = InspectionPanel(client.gui, shared.stages, pictures, post)
        self._camera_view = CameraView(
            client, pictures.frame, pictures.frame.image, self._handle_dragged, self._dragged
        )
        self._covering = Covering(self._camera_view, pictures)
        self._world = client.scene.add_frame("/world", show_axes=False)
        self._drag_start_px: Pixel = (0.0, 0.0)
        self._lit: object = None
        self._view = ""
        self._dark = True
        self._notice: Notice | None = None
        self._said: Said | None = None
        self._notification: NotificationHandle | None = None
        self._world_pose: tuple[np.ndarray, ...] | None = None
        picture = self._camera_view.picture
        picture.on_click(self._clicked)
        picture.on_click(modifier="cmd/ctrl")(self._pointed)
        picture.on_drag("left")(self._dragged)
        picture.on_drag("left", modifier="shift")(self._dragged)

    def take(self, event: PageEvent, session: Session) -> None:
        """Follow a choice made on this page; what would move the picture away under a drag has to wait for its end."""
        if session.drag == "running" and isinstance(event, ViewChosen | Zoomed):
            return
        result = session.reconstruction
        if isinstance(event, SectionPointed):
            section = self._section_under(event, result)
            if section is None:
                return
            event = SectionChosen(section)
        middle_px = session.shown.middle_px if not session.vertices_px else None
        self.state = page_step(self.state, event, section_count(result), middle_px)

    def told(self, item: Listed | Told | Exported) -> None:
        """Take what this page has asked of the record."""
        match item:
            case Listed(listing=listing, problem=problem):
                self.looked = replace(self.looked, listing=listing, problem=problem)
            case Told(number=number, text=text, good=good):
                self.looked = replace(self.looked, number=number, told=text, good=good)
            case Exported(number=number, name=name, content=content):
                self.client.send_file_download(name, content)
                told = f"{name} is ready: save it from the notification."
                self.looked = replace(self.looked, number=number, told=told, good=True)

    def hold(self, pictures: Pictures) -> None:
        """Show another frame; where this page looked is kept when the picture has the same size."""
        before = self._pictures.frame.image.shape
        self._pictures, self._pixels = pictures, PixelFinder(pictures.frame)
        self.state = replace(self.state, ends_px=())
        if pictures.frame.image.shape != before:
            self.state = replace(self.state, zoom=1.0, center_px=None, last_point_px=None)
        self._lit = None
        self._covering.hold(pictures)
        self._camera_view.hold(pictures.frame)
        self._panels.hold(pictures)
        self._inspection.hold(pictures)

    def _section_under(self, pointed: SectionPointed, result: Reconstruction | None) -> int | None:
        if result is None or result.sections is None:
            return None
        origin_m, direction = self._pixels.sight_line(pointed.origin_m, pointed.direction)
        return result.sections.section_at(origin_m, direction)

    def show(self, session: Session) -> None:
        """Bring everything on this page up to date."""
        self.state = ticked(self.state, session, self.client.client_id)
        result, page = session.reconstruction, self.state
        section = section_shown(page, section_count(result))
        moving = session.preview is not None or not session.up_to_date
        self._hint.show(session, page)
        self._show_notice(session)
        self._show_view()
        if page.view == "camera":
            self._camera_view.look(page)
        self._camera_view.show(session.shown, session.vertices_px, page)
        self._covering.show(page, result, section, session.overriding, moving)
        if page.view == "3D":
            self._show_own_in_scene(result if session.up_to_date else None, section)
        self._panels.show(session, page, section, moving)
        self._newer.show(session)
        self._history.show(session, self.looked, page.browsing)
        self._decision.show(session)
        self._say(session)
        if not moving:
            self._inspection.show(result, page, section, session.unit)

    def _show_own_in_scene(self, result: Reconstruction | None, section: int) -> None:
        """What this page alone has in the 3D scene: a section lit, and residuals."""
        key = (result, section, self.state.overlay)
        if self._lit == key:
            return
        self._lit = key
        self._scene.light_section(self.client, result, section)
        is_colored = result is not None and self.state.overlay == "residuals"
        self._scene.color_residuals(self.client, residuals_in(result) if result is not None and is_colored else None)

    def _show_view(self) -> None:
        """Change the standpoint, and what is seen from it, when the other view was chosen."""
        page = self.state
        if page.dark != self._dark:
            self._dark = page.dark
            self.client.gui.configure_theme(
                dark_mode=page.dark, show_logo=False, show_share_button=False, brand_color=BRAND_COLOR
            )
        if page.view == self._view:
            return
        in_camera, camera = page.view == "camera", self.client.camera
        if in_camera and self._view:
            self._world_pose = (camera.up_direction, camera.position, camera.look_at)
        self._view = page.view
        self._camera_view.set_visible(in_camera)
        self._world.visible = not in_camera
        if in_camera:
            self._lit = None
            self._scene.hide_own(self.client)
        else:
            self._scene.look(self.client, self._world_pose)

    def _show_notice(self, session: Session) -> None:
        """Tell of a failure, and take that away when it is no longer one of what is shown."""
        if session.notice == self._notice:
            return
        if self._notification is not None:
            self._notification.remove()
            self._notification = None
        self._notice = session.notice
        if self._notice is not None:
            self._notification = self.client.add_notification(
                self._notice.title,
                in_session_unit(self._notice.text, session),
                color="orange",
                auto_close_seconds=NOTICE_SECONDS,
            )

    def _say(self, session: Session) -> None:
        """Tell why what was done on this page did nothing."""
        said = next((said for said in session.decision.said if said.page == self.client.client_id), None)
        if said is not None and said != self._said:
            self.client.add_notification("Not done", said.text, color="orange", auto_close_seconds=NOTICE_SECONDS)
        self._said = said

    async def _clicked(self, event: SceneNodePointerEvent) -> None:
        point = self._pixels.clicked(event)
        self._touched(point)
        if self.state.measuring:
            self._post(EndPointed(point))
            return
        self._post(VertexClicked(point, self._camera_view.closing_reach_px(self.state)))

    async def _pointed(self, event: SceneNodePointerEvent) -> None:
        self._post(SectionPointed(event.ray_origin, event.ray_direction))

    async def _dragged(self, event: SceneNodeDragEvent) -> None:
        start, end = self._pixels.dragged(event)
        if event.phase == "start":
            self._drag_start_px = start  # of a drag from a handle, it moves along with that
        else:
            if event.phase == "end":
                self._touched(end)
            reach_px = self._camera_view.closing_reach_px(self.state)
            self._post(
                PointerDragged(self._drag_start_px, end, event.modifier == "shift", event.phase == "end", reach_px)
            )

    def _handle_dragged(self, part: Part, index: int, event: SceneNodeDragEvent) -> None:
        _, end = self._pixels.dragged(event)
        if event.phase != "start":
            if event.phase == "end":
                self._touched(end)
            self._post(HandleMoved(part, index, end, event.phase == "end"))

    def _touched(self, point: Pixel) -> None:
        camera = self._pictures.frame.camera
        on_picture = on_frame(point, (camera.width, camera.height))
        if on_picture is not None:
            self._post(PointTouched(on_picture))

"""One page's picture and what lies over it: faint while another drawing is made or measured, as it is not of that."""

from app.camera_view import CameraView
from app.encoded import put
from app.object_drawing import Pixel
from app.page import OverlayName, PageState
from app.pictures import Pictures
from rotrecon.reconstruction import Reconstruction
from rotrecon.tool_table import Tool

Composed = tuple[Reconstruction | None, float, int, OverlayName, tuple[Pixel, ...], Tool | None]
"""What a layer is made of: the result, opacity of the depth, section, overlay, ends of a distance, tool."""
NOTHING: Composed = (None, 0.0, 0, "nothing", (), None)


class Covering:
    """Sends the picture and the layer when they change; while something moves they stay what they were."""

    def __init__(self, camera_view: CameraView, pictures: Pictures) -> None:
        self._camera_view, self._pictures = camera_view, pictures
        self._picture_of: float | None = 0.0
        self._composed: Composed | None = NOTHING
        self._covered: tuple[Composed, bool] | None = (NOTHING, False)

    def hold(self, pictures: Pictures) -> None:
        """The pictures of another frame."""
        self._pictures = pictures
        self._picture_of = self._composed = self._covered = None

    def show(
        self, page: PageState, result: Reconstruction | None, section: int, tool: Tool | None, moving: bool
    ) -> None:
        """Show the frame with what was found in it, or, while something is `moving`, leave a trace of that."""
        if not moving:
            if page.depth_opacity != self._picture_of:
                self._picture_of = page.depth_opacity
                put(self._camera_view.picture, self._pictures.sent_picture(page.depth_opacity))
            shown = 0 if result is None else section
            self._composed = (result, page.depth_opacity, shown, page.overlay, page.ends_px, tool)
        if self._composed is None:
            return
        covered = (self._composed, moving and self._composed[0] is not None)
        if covered != self._covered:
            self._covered = covered
            self._camera_view.cover(self._pictures.sent_layer(*covered[0], faint=covered[1]))

"""The frame as the sensor saw it, to be drawn on: one page's picture, lines and handles."""

from collections.abc import Callable, Coroutine
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from viser import ClientHandle, IcosphereHandle, SceneNodeDragEvent
from viser import transforms as tf

from app.encoded import Layer, put
from app.object_drawing import ObjectDrawing, Part, Pixel
from app.page import PageState
from app.pictures import PICTURE_QUALITY
from rotrecon.arrays import Bytes, Floats
from rotrecon.camera import rotate
from rotrecon.frame import Frame

PICTURE_M, LAYER_M, LINES_M, HANDLES_M, BACKDROP_M = 1.0, 0.995, 0.99, 0.98, 1.02
"""Depths of the nodes before the camera; the handles come first, so that they win over the picture."""
BACKDROP_SIZE_M = 40.0
HANDLE_RADIUS_PX = 9.0
POSE_TOLERANCE = 1e-5
"""Metres and radians that a page's camera may be off: a hundredth of a pixel."""
USUAL_HANDLES = 6
"""Of a rectangle and an axis; a polygon of more corners gets more when it is drawn."""
CLOSING_REACH_PX = 12.0
"""On the screen; of a click that closes a polygon on its first corner."""
AREA_COLOR, AXIS_COLOR, CORNER_COLOR = (255, 176, 0), (0, 200, 255), (255, 255, 255)
CLOSING_COLOR = (128, 88, 0)
"""Of the line that would close a polygon that is still open."""
MARGIN = 1.04
"""Room round the picture, so that a corner on its border can be seen and grabbed."""
NOTHING = np.zeros((2, 2, 4), dtype=np.uint8)
"""A layer that shows nothing."""
KEY_MODIFIERS = ("cmd/ctrl", "alt", "cmd/ctrl+alt", "cmd/ctrl+shift", "alt+shift", "cmd/ctrl+alt+shift")

HandleDragged = Callable[[Part, int, SceneNodeDragEvent], None]
PictureDragged = Callable[[SceneNodeDragEvent], Coroutine[Any, Any, None]]


async def _nothing(_: SceneNodeDragEvent) -> None:
    """Taking a drag and doing nothing with it keeps the camera where it is."""


class CameraView:
    """Nodes of one page, named the same for as long as it is open, in camera coordinates under `/view`."""

    def __init__(
        self, client: ClientHandle, frame: Frame, picture: Bytes, on_handle: HandleDragged, on_picture: PictureDragged
    ) -> None:
        self._client, self._frame, self._on_handle, self._on_picture = client, frame, on_handle, on_picture
        scene = client.scene
        self._root = scene.add_frame("/view", show_axes=False)
        self.picture = self._add_image("picture", picture, "jpeg")
        self._layer = self._add_image("layer", NOTHING, "png")
        """What is drawn over the picture: it takes no clicks, and is small where the picture is not."""
        self.hold(frame)
        backdrop = scene.add_image(
            "/view/backdrop",
            np.full((2, 2, 3), 24, dtype=np.uint8),
            BACKDROP_SIZE_M,
            BACKDROP_SIZE_M,
            position=(0.0, 0.0, BACKDROP_M),
            cast_shadow=False,
            receive_shadow=False,
        )
        for modifier in (None, "shift"):
            backdrop.on_drag("left", modifier=modifier)(_nothing)
        for node in (backdrop, self.picture):
            _block(node)
        self._area = self._add_lines("area", AREA_COLOR)
        self._closing = self._add_lines("closing", CLOSING_COLOR)
        self._axis = self._add_lines("axis", AXIS_COLOR)
        self._parts: list[Part] = []
        self._handles = [self._add_handle(number) for number in range(USUAL_HANDLES)]

    def hold(self, frame: Frame) -> None:
        """Stand where a frame was taken, with room for a picture of its size."""
        self._frame, T = frame, frame.T_base_camera
        self._drawn: object = None
        self._root.wxyz, self._root.position = tf.SO3.from_matrix(T[:3, :3]).wxyz, T[:3, 3]
        self._place(self.picture, (0, 0, frame.camera.width, frame.camera.height), PICTURE_M)

    def cover(self, layer: Layer) -> None:
        """Lay something over the picture."""
        self._place(self._layer, layer.box_px, LAYER_M)
        put(self._layer, layer.picture)

    def show(self, drawn: ObjectDrawing, vertices_px: tuple[Pixel, ...], page: PageState) -> None:
        """Draw area, axis, the open polygon and their handles, unless they are drawn so already."""
        drawing = (drawn.area, drawn.axis, vertices_px, self._screen_px(1, page))
        if drawing == self._drawn:
            return
        self._drawn = drawing
        corners = () if drawn.area is None else drawn.area.vertices_px
        pieces = list(zip(corners, (*corners[1:], *corners[:1]), strict=True))
        if vertices_px:
            pieces = [*pairwise(vertices_px)]
            pieces += [piece for vertex in vertices_px for piece in _cross(vertex, self._screen_px(6, page))]
        self._set_lines(self._area, pieces)
        self._set_lines(self._closing, [(vertices_px[-1], vertices_px[0])] if len(vertices_px) >= 3 else [])
        ends = () if drawn.axis is None else (drawn.axis.start_px, drawn.axis.end_px)
        self._set_lines(self._axis, [] if not ends else _arrow(ends[0], ends[1], self._screen_px(16, page)))
        places: list[tuple[Part, Pixel]] = []
        if not vertices_px:
            places.extend(("area", corner) for corner in corners)
        places.extend(("axis", end) for end in ends)
        self._place_handles(places, page)

    def look(self, page: PageState) -> None:
        """Put this page's camera where the sensor is, and fit the picture to the canvas; a pose that fits is kept."""
        camera, T = self._client.camera, self._frame.T_base_camera
        position, direction = T[:3, 3], self._sight(page)
        up = -T[:3, 1]
        fov_rad = 2 * np.arctan(self._half_height(page))
        with self._client.atomic():
            if _is_off(camera.up_direction, up):
                camera.up_direction = up
            if _is_off(camera.position, position):
                camera.position = position
            if _is_off(camera.look_at, position + direction):
                camera.look_at = position + direction
            if abs(camera.fov - fov_rad) > POSE_TOLERANCE:
                camera.fov = float(fov_rad)
            camera.min_orbit_distance = min(1.0, camera.max_orbit_distance)
            camera.max_orbit_distance = 1.0

    def set_visible(self, visible: bool) -> None:
        """Show the camera view's nodes, or hide all of them."""
        if self._root.visible != visible:
            self._root.visible = visible

    def closing_reach_px(self, page: PageState) -> float:
        """How near to the first corner a click closes a polygon, in pixels of the frame."""
        return self._screen_px(CLOSING_REACH_PX, page)

    def _sight(self, page: PageState) -> Floats:
        """Unit vector in base coordinates from the sensor to what is looked at."""
        ray = self._frame.camera.unproject(self._center_px(page), 1.0)
        return rotate(self._frame.T_base_camera, ray / np.linalg.norm(ray))

    def _center_px(self, page: PageState) -> Pixel:
        camera = self._frame.camera
        return page.center_px or (float(camera.K[0, 2]), float(camera.K[1, 2]))

    def _half_height(self, page: PageState) -> float:
        """Tangent of half the vertical field of view that shows the whole picture, over the zoom."""
        camera, aspect = self._frame.camera, self._client.camera.aspect
        (focal_u, focal_v), (u, v) = np.diag(camera.K)[:2], camera.K[:2, 2]
        by_height = max(v + 0.5, camera.height - 0.5 - v) / focal_v
        by_width = max(u + 0.5, camera.width - 0.5 - u) / focal_u / aspect
        return float(max(by_height, by_width)) * MARGIN / page.zoom

    def _screen_px(self, size_px: float, page: PageState) -> float:
        """Pixels of the frame that a size on the screen covers."""
        per_pixel = 2 * self._half_height(page) / self._client.camera.image_height
        return size_px * per_pixel * float(self._frame.camera.K[1, 1])

    def _at(self, pixels: object, depth_m: float) -> Floats:
        points = np.asarray(pixels, dtype=np.float64)
        return self._frame.camera.unproject(points, np.full(points.shape[:-1], depth_m))

    def _add_image(self, name: str, image: Bytes, form: Literal["jpeg", "png"]) -> Any:
        """An image whose place and size are not known yet."""
        return self._client.scene.add_image(
            f"/view/{name}",
            image,
            1.0,
            1.0,
            format=form,
            jpeg_quality=PICTURE_QUALITY,
            cast_shadow=False,
            receive_shadow=False,
        )

    def _place(self, image: Any, box_px: tuple[int, int, int, int], depth_m: float) -> None:
        """Put an image at a depth where it covers a box (left, top, width, height) of the frame."""
        left, top, width, height = box_px
        corners = self._at([[left - 0.5, top - 0.5], [left + width - 0.5, top + height - 0.5]], depth_m)
        image.render_width, image.render_height, _ = (corners[1] - corners[0]).tolist()
        image.position = corners.mean(axis=0)

    def _add_lines(self, name: str, color: tuple[int, int, int]) -> Any:
        return self._client.scene.add_line_segments(
            f"/view/{name}", np.zeros((1, 2, 3)), color, thickness=2.5, thickness_units="screen", visible=False
        )

    def _set_lines(self, lines: Any, pieces: list[tuple[Pixel, Pixel]]) -> None:
        """Show pieces of line, or hide the node when there are none."""
        if pieces:
            points = self._at(pieces, LINES_M).astype(np.float32)
            if points.shape != lines.points.shape or not np.array_equal(points, lines.points):
                lines.points = points
        if lines.visible != bool(pieces):
            lines.visible = bool(pieces)

    def _place_handles(self, places: list[tuple[Part, Pixel]], page: PageState) -> None:
        """Put the pool's handles to their places; corners come first in it, the axis's two ends last."""
        while len(self._handles) < len(places):
            self._handles.append(self._add_handle(len(self._handles)))
        radius_m = self._screen_px(HANDLE_RADIUS_PX, page) / float(self._frame.camera.K[1, 1]) * HANDLES_M
        self._parts = [part for part, _ in places]
        for handle, (part, place) in zip(self._handles, places, strict=False):
            position = self._at(place, HANDLES_M)
            if _is_off(handle.position, position):
                handle.position = position
            if handle.scale != radius_m:
                handle.scale = radius_m
            color = AXIS_COLOR if part == "axis" else CORNER_COLOR
            if tuple(handle.color) != color:
                handle.color = color
            if not handle.visible:
                handle.visible = True
        for handle in self._handles[len(places) :]:
            if handle.visible:
                handle.visible = False

    def _add_handle(self, number: int) -> IcosphereHandle:
        handle = self._client.scene.add_icosphere(
            f"/view/handle{number}", 1.0, subdivisions=2, visible=False, cast_shadow=False, receive_shadow=False
        )
        handle.on_drag("left")(self._handle_callback(number))
        handle.on_drag("left", modifier="shift")(self._on_picture)  # an axis may begin where another one ends
        return handle

    def _handle_callback(self, number: int) -> Callable[[SceneNodeDragEvent], Coroutine[Any, Any, None]]:
        async def dragged(event: SceneNodeDragEvent) -> None:
            if number < len(self._parts):
                part = self._parts[number]
                self._on_handle(part, number - self._parts.index(part), event)

        return dragged


def _is_off(place: Floats, wanted: Floats) -> bool:
    """Whether it can be seen that a place or a direction is not the one that is wanted; np.allclose takes ten times as
    long, on every page for every change."""
    return bool(np.abs(place - wanted).max() > POSE_TOLERANCE)


def _block(node: Any) -> None:
    """Take every drag that means nothing here, so that none of them moves the camera."""
    for button in ("middle", "right"):
        for modifier in (None, "shift", *KEY_MODIFIERS):
            node.on_drag(button, modifier=modifier)(_nothing)
    for modifier in KEY_MODIFIERS:
        node.on_drag("left", modifier=modifier)(_nothing)


def _cross(center: Pixel, size_px: float) -> list[tuple[Pixel, Pixel]]:
    """A small upright cross on a corner of a polygon that is still open."""
    (u, v), half = center, size_px / 2
    return [((u - half, v), (u + half, v)), ((u, v - half), (u, v + half))]


def _arrow(start: Pixel, end: Pixel, head_px: float) -> list[tuple[Pixel, Pixel]]:
    """The stroke of an axis, with a head that shows its direction halfway along."""
    start_px, end_px = np.array(start), np.array(end)
    length = float(np.linalg.norm(end_px - start_px))
    if length < 1e-6:
        return [(start, end)]
    along = (end_px - start_px) / length
    across = np.array([-along[1], along[0]])
    tip = (start_px + end_px) / 2 + along * head_px / 2
    wings = [tuple(tip - along * head_px + side * across * head_px / 2) for side in (-1, 1)]
    return [(start, end), *((tuple(tip), wing) for wing in wings)]

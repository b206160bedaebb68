"""The pictures a page shows, composed of the frame, its depth and a reconstruction by the library's overlays."""

from functools import cached_property, lru_cache

import cv2
import numpy as np

from app.encoded import Encoded, Layer, as_jpeg, as_layer
from app.inspection import grasp_in, line_in, residuals_in
from app.object_drawing import Pixel
from app.page import LayerName, OverlayName
from rotrecon.arrays import Bytes
from rotrecon.frame import Frame
from rotrecon.grasp_overlay import with_grasp
from rotrecon.outcome import Fit
from rotrecon.overlay import (
    Stage,
    blend,
    depth_colors,
    depth_range_m,
    first_cut_line,
    outlines,
    section_pixels,
    with_outlines,
    with_segmentation,
)
from rotrecon.reconstruction import Reconstruction
from rotrecon.residuals import with_residuals
from rotrecon.tool_table import Tool

STAGES: dict[LayerName, Stage] = {"close pixels": "close", "accepted pixels": "accepted", "segmentation": "object"}
"""The layers that are figure 3 a, b and c of the paper."""
SECTION_COLOR = (204, 121, 167)
FAINT_OPACITY = 0.3
"""Of what is drawn over the picture and is not of the latest drawing."""
RULER_COLOR = (255, 255, 255)
KEPT_COLOR, GONE_COLOR, BACK_COLOR = (60, 147, 208), (213, 94, 0), (204, 121, 167)
"""Of a line of pixels: what a step left, took away and brought back."""
STEP_HEIGHT_PX = 240
PANEL_WIDTH_PX = 480
"""Width that pictures in a panel are sent with: that of the panel, on a screen of high density a little less."""
KEPT = 4
"""Pictures of each sort that are kept as they are sent, as most pages show the same."""
PICTURE_QUALITY, PANEL_QUALITY, STEP_QUALITY = 85, 80, 90
"""Of JPEG."""
CROP_PX = 72
"""Side of the magnified crop in pixels of the frame."""


class Pictures:
    """Pictures of one frame; what depends on the frame alone is worked out once."""

    def __init__(self, frame: Frame) -> None:
        self.frame = frame
        keep = lru_cache(maxsize=KEPT)
        self.sent_picture, self.sent_layer = keep(self._sent_picture), keep(self._sent_layer)
        self.sent_television, self.sent_step = keep(self._sent_television), keep(self._sent_step)

    @cached_property
    def depth_range_m(self) -> tuple[float, float]:
        """The depths at the two ends of the colour bar."""
        return depth_range_m(self.frame.depth_m)

    @cached_property
    def depth_layer(self) -> Bytes:
        """The depth map in colours, the picture itself where there is no depth."""
        return depth_colors(self.frame.depth_m, self.depth_range_m)

    def with_depth(self, opacity: float) -> Bytes:
        """The frame with its depth blended in."""
        if opacity <= 0:
            return self.frame.image
        return blend(self.frame.image, self.depth_layer, np.isfinite(self.frame.depth_m), opacity)

    def _sent_picture(self, opacity: float) -> Encoded:
        """The picture that is drawn on, as it is sent; it stays the same when the drawing changes."""
        return as_jpeg(self.with_depth(opacity), PICTURE_QUALITY)

    def _sent_layer(
        self,
        result: Reconstruction | None,
        opacity: float,
        section: int,
        overlay: OverlayName,
        ends_px: tuple[Pixel, ...],
        tool: Tool | None = None,
        faint: bool = False,
    ) -> Layer:
        """All that is drawn over it, as it is sent; `faint` where a newer one is on its way to replace it."""
        image = self.camera_view(result, opacity, section, overlay, tool)
        image = self.with_ends(image, ends_px) if ends_px else image
        return as_layer(image, self.with_depth(opacity), FAINT_OPACITY if faint else 1.0)

    def _sent_television(self, result: Reconstruction | None, layer: LayerName) -> Encoded:
        return as_jpeg(self.television(result, layer), PANEL_QUALITY)

    def _sent_step(self, result: Reconstruction, section: int, step: int) -> Encoded | None:
        image = self.step(result, section, step)
        return None if image is None else as_jpeg(image, STEP_QUALITY)

    def camera_view(
        self,
        result: Reconstruction | None,
        opacity: float,
        section: int,
        overlay: OverlayName = "nothing",
        tool: Tool | None = None,
    ) -> Bytes:
        """The picture that is drawn on: depth blended in, the solid's outline, a section lit, and what is over it."""
        image = self.with_depth(opacity)
        if result is None:
            return image
        image = _with_overlay(image, result, overlay, tool)
        return _with_section(with_outlines(image, outlines(result)), result, section)

    def with_ends(self, image: Bytes, ends_px: tuple[Pixel, ...]) -> Bytes:
        """A picture with the ends of a distance, joined when there are two."""
        drawn = image.copy()
        places = [(round(u), round(v)) for u, v in ends_px]
        for place in places:
            cv2.drawMarker(drawn, place, RULER_COLOR, cv2.MARKER_CROSS, 13, 2)
        if len(places) == 2:
            cv2.line(drawn, places[0], places[1], RULER_COLOR, 1, cv2.LINE_AA)
        return drawn

    def step(self, result: Reconstruction, section: int, step: int) -> Bytes | None:
        """The object at one step of the segmentation, one line of pixels lit; None for a section without a line."""
        line, row = line_in(result, section), first_cut_line(result, section)
        if line is None or row is None:
            return None
        runs = result.settings.layers
        stage: Stage = "close" if step < runs else "object" if step >= len(line.stages) - 1 else "accepted"
        image = with_segmentation(self.frame.image, result, stage)
        now = line.stages[min(step, len(line.stages) - 1)]
        pixel = result.segments.pixel[row]
        for which, color in ((now.members, KEPT_COLOR), (now.removed, GONE_COLOR), (now.added, BACK_COLOR)):
            image.reshape(-1, 3)[pixel[which]] = color
        v, u = np.divmod(result.segments.pixel[result.segments.inside], image.shape[1])
        return _enlarged(image[max(v.min() - 8, 0) : v.max() + 9, max(u.min() - 8, 0) : u.max() + 9])

    def television(self, result: Reconstruction | None, layer: LayerName) -> Bytes:
        """The frame as one stage of the method leaves it."""
        image = self.frame.image
        if layer == "depth map":
            image = self.depth_layer
        elif layer in STAGES and result is not None:
            image = with_segmentation(image, result, STAGES[layer])
        elif layer == "model" and result is not None and isinstance(result.fit, Fit):
            image = with_outlines(with_segmentation(image, result, opacity=0.25), outlines(result))
        scale = min(1.0, PANEL_WIDTH_PX / image.shape[1])
        return np.asarray(cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), dtype=np.uint8)

    def crop(self, point_px: Pixel) -> Bytes:
        """The frame round the nearest point on it, magnified, with a cross there; black beyond the border."""
        magnified = PANEL_WIDTH_PX // CROP_PX
        height, width = self.frame.image.shape[:2]
        u, v = (round(min(max(value, 0), size - 1)) for value, size in zip(point_px, (width, height), strict=True))
        half = CROP_PX // 2
        padded = cv2.copyMakeBorder(self.frame.image, half, half, half, half, cv2.BORDER_CONSTANT)
        crop = padded[v : v + CROP_PX : 1, u : u + CROP_PX]
        crop = crop[CROP_PX // 4 : -CROP_PX // 4]
        large = cv2.resize(crop, None, fx=magnified, fy=magnified, interpolation=cv2.INTER_NEAREST)
        middle = (half * magnified + magnified // 2, half // 2 * magnified + magnified // 2)
        return np.asarray(cv2.drawMarker(large, middle, (255, 255, 255), cv2.MARKER_CROSS, 30, 1), dtype=np.uint8)


def _with_section(image: Bytes, result: Reconstruction, section: int) -> Bytes:
    """The picture with the pixels of one section lit."""
    if result.sections is None or not 0 <= section < len(result.sections.start) - 1:
        return image
    lit = image.copy()
    u, v = section_pixels(result, section).astype(np.int32).T
    lit[v, u] = SECTION_COLOR
    return lit


def _with_overlay(image: Bytes, result: Reconstruction, overlay: OverlayName, tool: Tool | None) -> Bytes:
    """The picture with the tool at its place, or with the residuals in colours."""
    if overlay == "tool":
        grasp = grasp_in(result, tool)
        return image if grasp is None else with_grasp(image, grasp, result.frame)
    residuals = residuals_in(result) if overlay == "residuals" else None
    return image if residuals is None else with_residuals(image, residuals)


def _enlarged(image: Bytes) -> Bytes:
    """A cut-out as large as a panel has room for, its pixels sharp."""
    height, width = image.shape[:2]
    scale = min(PANEL_WIDTH_PX / width, STEP_HEIGHT_PX / height)
    size = (max(round(width * scale), 1), max(round(height * scale), 1))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_NEAREST), dtype=np.uint8)

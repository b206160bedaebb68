"""The pictures a page shows, composed of the frame, its depth and a reconstruction by the library's overlays."""

from functools import cached_property

import cv2
import numpy as np

from app.object_drawing import Pixel
from app.page import LayerName
from rotrecon.arrays import Bytes
from rotrecon.frame import Frame
from rotrecon.outcome import Fit
from rotrecon.overlay import (
    Stage,
    blend,
    depth_colors,
    depth_range_m,
    outlines,
    section_pixels,
    with_outlines,
    with_segmentation,
)
from rotrecon.reconstruction import Reconstruction

STAGES: dict[LayerName, Stage] = {"close pixels": "close", "accepted pixels": "accepted", "segmentation": "object"}
"""The layers that are figure 3 a, b and c of the paper."""
SECTION_COLOR = (204, 121, 167)
PANEL_WIDTH_PX = 480
"""Width that pictures in a panel are sent with: that of the panel, on a screen of high density a little less."""
CROP_PX = 72
"""Side of the magnified crop in pixels of the frame."""


class Pictures:
    """Pictures of one frame; what depends on the frame alone is worked out once."""

    def __init__(self, frame: Frame) -> None:
        self.frame = frame

    @cached_property
    def depth_range_m(self) -> tuple[float, float]:
        """The depths at the two ends of the colour bar."""
        return depth_range_m(self.frame.depth_m)

    @cached_property
    def depth_layer(self) -> Bytes:
        """The depth map in colours, the picture itself where there is no depth."""
        return depth_colors(self.frame.depth_m, self.depth_range_m)

    def camera_view(self, result: Reconstruction | None, opacity: float, section: int) -> Bytes:
        """The picture that is drawn on: depth blended in, the solid's outline, and one section lit."""
        image = self.frame.image
        if opacity > 0:
            image = blend(image, self.depth_layer, np.isfinite(self.frame.depth_m), opacity)
        return image if result is None else _with_section(with_outlines(image, outlines(result)), result, section)

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

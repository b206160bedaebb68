"""The pictures of a report, as text that a page can hold."""

from base64 import b64encode

import cv2
import numpy as np

from rotrecon.arrays import Bytes
from rotrecon.grasp import grasp_of
from rotrecon.grasp_overlay import with_grasp
from rotrecon.overlay import blend, depth_colors, depth_range_m, outlines, with_outlines, with_segmentation
from rotrecon.reconstruction import Reconstruction

QUALITY = 88
"""Of the JPEG, per cent: lines of one pixel stay clear."""
MARGIN = 0.2
"""Of the area's size that is shown round it."""
CLOSE_UP_PX = 640
"""Longer side of the close-up."""
DEPTH_OPACITY = 0.6
THUMBNAIL_PX, THUMBNAIL_QUALITY = 192, 70
"""Width and quality that make a few kilobytes, as every proposal keeps one."""


def report_pictures(result: Reconstruction, tool: str | None) -> list[tuple[str, str]]:
    """Captions, and the pictures as data URLs: the frame with the result, close to the object, tool, and depth."""
    frame = result.frame
    overlay = with_outlines(with_segmentation(frame.image, result), outlines(result))
    low, high = depth_range_m(frame.depth_m)
    depth = blend(frame.image, depth_colors(frame.depth_m, (low, high)), np.isfinite(frame.depth_m), DEPTH_OPACITY)
    close_up = _close_up(overlay, result)
    return [
        ("The frame: segmented object, re-projected solid; hidden parts dashed", data_url(overlay)),
        ("The object; navy: distant, light blue: close, yellow: accepted, red: object", data_url(close_up)),
        *_with_tool(result, tool),
        (
            f"Depth, from {1000 * low:.0f} mm (bright) to {1000 * high:.0f} mm (dark)",
            data_url(with_outlines(depth, outlines(result))),
        ),
    ]


def _with_tool(result: Reconstruction, name: str | None) -> list[tuple[str, str]]:
    """A tool of the table at its place, if there is anything that it could be put to."""
    tool = next((tool for tool in result.settings.tools if tool.name == name), None)
    grasp = None if tool is None else grasp_of(result, tool)
    if grasp is None:
        return []
    image = with_grasp(with_outlines(result.frame.image, outlines(result)), grasp, result.frame)
    return [(f"The {name} at its place: mouth green, jaws and body yellow, what it would hit pink", data_url(image))]


def thumbnail(result: Reconstruction) -> str:
    """The frame with the result, small, as a data URL: a list of decisions is told apart by it."""
    image = with_outlines(with_segmentation(result.frame.image, result), outlines(result))
    scale = min(1.0, THUMBNAIL_PX / image.shape[1])
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    return data_url(np.asarray(small, dtype=np.uint8), THUMBNAIL_QUALITY)


def data_url(image: Bytes, quality: int = QUALITY) -> str:
    """A picture (H, W, 3) RGB as a JPEG in a data URL."""
    written, content = cv2.imencode(".jpg", image[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert written
    return f"data:image/jpeg;base64,{b64encode(content.tobytes()).decode()}"


def _close_up(image: Bytes, result: Reconstruction) -> Bytes:
    """The drawn area with a margin, enlarged."""
    corners = np.array(result.drawing.area.vertices_px)
    margin = MARGIN * np.ptp(corners, axis=0).max()
    height, width = image.shape[:2]
    u0, v0 = np.clip(np.floor(corners.min(axis=0) - margin), 0, [width - 1, height - 1]).astype(int)
    u1, v1 = np.clip(np.ceil(corners.max(axis=0) + margin), 1, [width, height]).astype(int)
    crop = image[v0:v1, u0:u1]
    scale = CLOSE_UP_PX / max(crop.shape[:2])
    return np.asarray(cv2.resize(crop, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC), dtype=np.uint8)

"""Pictures: PNG and JPEG, whose size is read from the header before anything is decoded."""

import struct
from typing import Any, cast

import cv2
import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bytes
from rotrecon.scene.formats.source import SourceFile

_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_JPEG_SIGNATURE = b"\xff\xd8"
_JPEG_FRAME_MARKERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
# Calibration belongs to the raster as it was recorded, so a phone-style orientation tag must not turn it.
_AS_RGB = cv2.IMREAD_COLOR_RGB | cv2.IMREAD_IGNORE_ORIENTATION


def read_image(source: SourceFile) -> Bytes:
    """Read a PNG or JPEG as (height, width, 3) RGB uint8, grey made RGB; raises SceneError."""
    return cast(Bytes, _decode(source, _AS_RGB))


def read_raw_image(source: SourceFile) -> NDArray[Any]:
    """Read a PNG or JPEG with the channels and the type it was stored with; raises SceneError."""
    return _decode(source, cv2.IMREAD_UNCHANGED)


def encode_png(image: NDArray[Any]) -> bytes:
    """A picture (height, width, 3) RGB uint8, or (height, width) uint8 or uint16, as the bytes of a PNG file."""
    written, content = cv2.imencode(".png", image[..., ::-1] if image.ndim == 3 else image)
    if not written:
        raise ValueError(f"an array of shape {image.shape} and type {image.dtype} is not a picture")
    return content.tobytes()


def _decode(source: SourceFile, flags: int) -> NDArray[Any]:
    content = source.read_bytes()
    size = _announced_size(content)
    if size is None:
        raise source.error("is not a PNG or JPEG picture, or is cut off in its header", "save it as PNG")
    source.check_count(size[0] * size[1], "pixels")
    try:
        image = cv2.imdecode(np.frombuffer(content, np.uint8), flags)
    except cv2.error:
        image = None
    if image is None:
        raise source.error("is a truncated or damaged picture", "copy or record it again")
    return image


def _announced_size(content: bytes) -> tuple[int, int] | None:
    """Width and height as the header states them; None when there is no such header."""
    if content.startswith(_PNG_SIGNATURE) and len(content) >= 24:
        width, height = struct.unpack(">II", content[16:24])
        return width, height
    if content.startswith(_JPEG_SIGNATURE):
        return _announced_jpeg_size(content)
    return None


def _announced_jpeg_size(content: bytes) -> tuple[int, int] | None:
    at = 2
    while at + 9 <= len(content) and content[at] == 0xFF:
        marker, length = content[at + 1], int.from_bytes(content[at + 2 : at + 4], "big")
        if marker in _JPEG_FRAME_MARKERS:
            height, width = struct.unpack(">HH", content[at + 5 : at + 9])
            return width, height
        # A marker may be preceded by any number of fill bytes, which carry no length.
        at += 1 if marker == 0xFF else 2 + length
    return None

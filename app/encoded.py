"""Pictures encoded once for all pages that show the same; viser's own way encodes them for each page anew."""

from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np

from rotrecon.arrays import Bytes

SPARSE_COMPRESSION = 1
"""Of PNG: what is nearly everywhere the same gets no smaller by more, and takes three times as long."""


@dataclass(frozen=True)
class Encoded:
    """A picture as it goes over the wire."""

    data: bytes
    format: Literal["jpeg", "png"]


@dataclass(frozen=True)
class Layer:
    """What is drawn over a picture, where there is any of it."""

    picture: Encoded
    box_px: tuple[int, int, int, int]
    """Left, top, width and height of it in the picture that it lies over."""


def as_jpeg(image: Bytes, quality: int) -> Encoded:
    """A picture (H, W, 3) RGB."""
    _, data = cv2.imencode(".jpg", cv2.cvtColor(image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality])
    return Encoded(data.tobytes(), "jpeg")


def as_layer(image: Bytes, below: Bytes, opacity: float = 1.0) -> Layer:
    """What a picture (H, W, 3) RGB shows that the one below it does not, the rest transparent."""
    differs = cv2.bitwise_not(cv2.inRange(cv2.absdiff(image, below), (0, 0, 0), (0, 0, 0)))
    left, top, width, height = cv2.boundingRect(differs)
    width, height = max(width, 1), max(height, 1)  # where nothing differs, a pixel of nothing
    cut = np.s_[top : top + height, left : left + width]
    layer = cv2.copyTo(cv2.cvtColor(image[cut], cv2.COLOR_RGB2BGRA), differs[cut])
    layer[..., 3] = layer[..., 3] * opacity
    _, data = cv2.imencode(".png", layer, [cv2.IMWRITE_PNG_COMPRESSION, SPARSE_COMPRESSION])
    return Layer(Encoded(data.tobytes(), "png"), (left, top, width, height))


def put(handle: Any, picture: Encoded) -> None:
    """Show a picture in one of viser's images, of the scene or of a panel."""
    handle._format, handle._data = picture.format, picture.data

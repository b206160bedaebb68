"""Pictures as they are sent: a layer over what it was made for shows the picture, and nothing is encoded twice."""

from io import BytesIO

import imageio.v3 as imageio
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.encoded import Layer, as_jpeg, as_layer
from app.pictures import Pictures
from tests.exact import cylinder, exact_frame


def laid(layer: Layer, below: np.ndarray) -> np.ndarray:
    """The picture below, with the layer over it."""
    left, top, width, height = layer.box_px
    over = imageio.imread(BytesIO(layer.picture.data))
    assert over.shape == (height, width, 4)
    shown, seen = below.copy(), over[..., 3] > 0
    shown[top : top + height, left : left + width][seen] = over[seen][:, :3]
    return shown


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 12))
def test_a_layer_over_the_picture_below_shows_the_picture(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    below = rng.integers(0, 256, (30, 40, 3), dtype=np.uint8)
    image = below.copy()
    image[rng.integers(0, 30, count), rng.integers(0, 40, count)] = rng.integers(0, 256, (count, 3), dtype=np.uint8)
    layer = as_layer(image, below)
    assert (laid(layer, below) == image).all()
    changed = np.argwhere((image != below).any(axis=2))
    if len(changed):
        top, left = changed.min(axis=0)
        height, width = np.ptp(changed, axis=0) + 1
        assert layer.box_px == (left, top, width, height), "no larger than it has to be"


def test_a_jpeg_keeps_its_colours() -> None:
    image = np.zeros((16, 16, 3), np.uint8)
    image[..., 0] = 250
    read = imageio.imread(BytesIO(as_jpeg(image, 95).data))
    assert np.abs(read.astype(int) - image).max() < 8


def test_pages_that_show_the_same_get_the_same_picture() -> None:
    pictures = Pictures(exact_frame(cylinder(np.array([0.0, 0.0, 0.8]), np.array([0.0, 1.0, 0.0]), 0.06)))
    assert pictures.sent_picture(0.0) is pictures.sent_picture(0.0)
    assert pictures.sent_picture(0.0) != pictures.sent_picture(0.5)
    assert pictures.sent_television(None, "picture") is pictures.sent_television(None, "picture")
    nothing = pictures.sent_layer(None, 0.0, 0, "nothing", (), None)
    assert nothing is pictures.sent_layer(None, 0.0, 0, "nothing", (), None)
    assert nothing.box_px[2:] == (1, 1)
    assert nothing != pictures.sent_layer(None, 0.0, 0, "nothing", ((3.0, 4.0),), None)

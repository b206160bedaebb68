"""What lies over a page's picture is faint as long as it is not of the drawing shown."""

from io import BytesIO
from types import SimpleNamespace
from typing import Any

import imageio.v3 as imageio
import numpy as np
import pytest

from app.covering import Covering
from app.encoded import Layer
from app.page import PageState
from app.pictures import FAINT_OPACITY, Pictures
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from tests.exact import cylinder, drawing_along, exact_frame

PIPE = cylinder(np.array([0.0, 0.0, 0.8]), np.array([0.0, 1.0, 0.0]), 0.06)
PICTURES = Pictures(exact_frame(PIPE))


@pytest.fixture(scope="module")
def result() -> Reconstruction:
    return reconstruct(PICTURES.frame, drawing_along(PIPE), Settings())


class Overlaid:
    """Stands in for the nodes of a page: its picture, and the layers that it was told to lay over it."""

    def __init__(self) -> None:
        self.picture: Any = SimpleNamespace()
        self.layers: list[Layer] = []

    def cover(self, layer: Layer) -> None:
        self.layers.append(layer)

    @property
    def alpha(self) -> int:
        """Of the most solid pixel of the latest layer, of 255."""
        return int(imageio.imread(BytesIO(self.layers[-1].picture.data))[..., 3].max())


def test_what_was_found_is_faint_from_a_change_of_the_drawing_to_its_measurement(result: Reconstruction) -> None:
    nodes = Overlaid()
    covering = Covering(nodes, PICTURES)
    page = PageState()
    covering.show(page, None, 0, None, moving=True)
    assert not nodes.layers, "nothing is over it yet"
    covering.show(page, result, 0, None, moving=False)
    assert nodes.alpha == 255
    for section in (0, 3):
        covering.show(page, result, section, None, moving=True)
        assert nodes.alpha == int(255 * FAINT_OPACITY)
    assert len(nodes.layers) == 2, "nothing is sent that has not changed"
    covering.show(page, result, 0, None, moving=False)
    assert nodes.alpha == 255
    covering.show(page, None, 0, None, moving=False)
    assert nodes.alpha == 0


def test_another_frame_has_nothing_over_it_until_something_was_found_in_it(result: Reconstruction) -> None:
    nodes = Overlaid()
    covering = Covering(nodes, PICTURES)
    covering.show(PageState(), result, 0, None, moving=False)
    covering.hold(Pictures(exact_frame(PIPE)))
    covering.show(PageState(), result, 0, None, moving=True)
    assert len(nodes.layers) == 1, "not what was found in the frame before it"

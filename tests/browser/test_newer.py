"""A newer frame on the real page: it is announced, taken with a click, and drawn on where it is."""

from datetime import UTC, datetime

import numpy as np
from playwright.sync_api import expect

from app.console import Console
from app.held import Newer
from app.newer_frames import newer_facts
from rotrecon.camera import PinholeCamera
from rotrecon.capture import Capture
from rotrecon.simulation.simulate import simulate
from tests.browser.conftest import LITTLE_NOISE
from tests.browser.operator import Operator

WIDER = PinholeCamera(400, 200, np.array([[310.0, 0, 190.0], [0, 310.0, 104.0], [0, 0, 1]]))


def test_a_newer_frame_of_another_size_is_taken_and_drawn_on(operator: Operator, console: Console) -> None:
    newer = simulate("ball", 1, WIDER, LITTLE_NOISE, supersampling=1)
    capture, now = Capture("A ball", recorded=newer.frame), datetime.now(UTC)
    console.newer(Newer(1, capture, "arm", now, newer_facts(capture, now)))
    announced = operator.page.get_by_test_id("newer")
    expect(announced).to_contain_text("A ball, from arm")
    operator.page.get_by_role("button", name="Take the newer frame").click()
    operator.until(lambda: console.frame is newer.frame, "the newer frame is held")
    operator.until(operator._picture_in_place, "the newer picture is where it belongs")
    expect(announced).to_be_hidden()
    corners = np.array(newer.drawing.area.vertices_px)
    operator.drag(tuple(corners.min(axis=0)), tuple(corners.max(axis=0)))
    operator.until(
        lambda: abs(float(operator.value("diameter_mm") or 0) - newer.diameter_mm) < 3, "the ball is measured"
    )

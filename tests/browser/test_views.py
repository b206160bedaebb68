"""A scene of views in the console: coarse depth first, then the area matched finely."""

from contextlib import closing

import pytest
from playwright.sync_api import Browser, expect

from app.bench.accuracy.outcome import radius_at
from app.console import Console
from app.record.store import Record
from rotrecon.capture import Capture
from rotrecon.frame import Frame
from rotrecon.settings import Settings
from tests.browser.conftest import SLOW_PAGE, opened_page
from tests.browser.operator import Operator
from tests.views import Rig, simulated


def test_what_is_drawn_on_views_is_measured_on_depth_matched_for_it(browser: Browser, tmp_path) -> None:
    scene = simulated(Rig.SIDEWAYS)
    capture = Capture("A ball, two views", views=scene.views)
    coarse = capture.frame()
    assert isinstance(coarse, Frame)
    with closing(Record.open(tmp_path)) as record:
        console = Console(
            coarse,
            capture.name,
            Settings(),
            port=0,
            cloud_points=500,
            record=record,
            deciding=SLOW_PAGE,
            capture=capture,
        )
        console.start()
        try:
            with opened_page(browser) as page:
                operator = Operator(page, console)
                corners = scene.drawing.area.vertices_px
                low, high = (tuple(pick(axis) for axis in zip(*corners, strict=True)) for pick in (min, max))
                operator.drag(low, high)

                def finely() -> bool:
                    measured = console.session.measured
                    return measured is not None and not measured.coarse

                operator.until(finely, "the area is matched again and measured")
                operator.settle()
                result = console.session.reconstruction
                assert result is not None
                assert result.frame is not coarse
                assert result.frame.views
                assert result.solid is not None
                assert radius_at(result.solid, result.solid.center_m) == pytest.approx(scene.solid.radius_m, rel=0.01)
                expect(page.get_by_test_id("hint")).to_contain_text("Measured.")
        finally:
            console.stop()

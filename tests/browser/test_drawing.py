"""The page, driven with a real mouse and real keys: what is drawn is measured, and what is shown is the answer."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

from app.object_drawing import Pixel
from app.pictures import Pictures
from app.session import Session
from app.wording import measured
from rotrecon.answer import answer
from rotrecon.drawing import AreaOfInterest
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated
from tests.browser.operator import Operator

TOLERANCE_PX = 0.6
"""A pointer has whole pixels, and a pixel of the frame is nearly three of the screen's."""


def draw(operator: Operator, scene: Simulated) -> None:
    """The rectangle round the scene's object, and its axis."""
    columns, rows = zip(*scene.drawing.area.vertices_px, strict=True)
    operator.drag((min(columns), min(rows)), (max(columns), max(rows)))
    expect(operator.page.get_by_test_id("hint")).to_contain_text("shift + drag")
    operator.settle()
    operator.drag(scene.drawing.axis.start_px, scene.drawing.axis.end_px, shift=True)
    operator.until(lambda: is_drawn(operator), "area and axis are drawn")
    shows_its_result(operator)


def is_drawn(operator: Operator) -> bool:
    """Whether there is an axis that has been drawn to its end, and not proposed."""
    drawn = session_of(operator).objects[0]
    return drawn.axis is not None and not drawn.proposed


def shows_its_result(operator: Operator) -> None:
    """The page shows exactly the answer to the session's drawing, read again from the page."""
    operator.settle()
    session = operator.console.session
    drawing = session.shown.complete
    assert drawing is not None
    expected = answer(reconstruct(operator.console.frame, drawing, Settings()))
    result = operator.page.get_by_test_id("result")
    expect(result).to_have_attribute("data-revision", str(session.revision))
    for field in ("diameter_mm", "length_mm", "kind", "rms_mm"):
        assert operator.value(field) == str(expected[field])
    assert operator.value("tool") == (expected["tool"] or "")
    diameter = measured(expected["diameter_mm"], expected["interval_mm"], " mm")
    expect(operator.page.locator('[data-field="diameter_mm"]')).to_have_text(re.compile(re.escape(diameter)))
    expect(operator.page.locator('[data-field="certain"]')).to_have_attribute(
        "data-value", str(expected["certain"]).lower()
    )


def session_of(operator: Operator) -> Session:
    return operator.console.session


@pytest.fixture
def drawn(operator: Operator, scene: Simulated) -> Operator:
    draw(operator, scene)
    return operator


def test_what_is_drawn_with_the_mouse_is_measured_and_shown(drawn: Operator, scene: Simulated) -> None:
    axis = session_of(drawn).shown.axis
    assert axis is not None
    assert np.abs(np.subtract(axis.start_px, scene.drawing.axis.start_px)).max() < TOLERANCE_PX
    assert np.abs(np.subtract(axis.end_px, scene.drawing.axis.end_px)).max() < TOLERANCE_PX
    assert float(drawn.value("diameter_mm") or 0) == pytest.approx(100, rel=0.1)


def test_a_handle_moved_changes_the_result_and_undo_restores_it(drawn: Operator) -> None:
    before = drawn.value("diameter_mm"), session_of(drawn).shown
    axis = before[1].axis
    assert axis is not None
    start, end = np.array(axis.start_px), np.array(axis.end_px)
    drawn.drag(axis.end_px, tuple(end - 0.4 * (end - start) + [3, 0]))
    drawn.until(lambda: session_of(drawn).objects[0] != before[1], "the handle has moved the axis")
    shows_its_result(drawn)
    assert drawn.value("diameter_mm") != before[0]
    drawn.page.keyboard.press("Control+z")
    drawn.until(lambda: session_of(drawn).objects[0] == before[1], "the drawing is the one before")
    shows_its_result(drawn)
    assert drawn.value("diameter_mm") == before[0]
    drawn.page.keyboard.press("Control+Shift+z")
    drawn.until(lambda: session_of(drawn).objects[0] != before[1], "the change is made again")


def test_the_rubber_band_follows_an_unfinished_drag_and_escape_drops_it(operator: Operator) -> None:
    operator.drag((50, 50), (150, 120), release=False)
    operator.until(lambda: session_of(operator).preview is not None, "the drag is shown")
    assert session_of(operator).objects[0].area is None
    operator.page.keyboard.press("Escape")
    operator.until(lambda: session_of(operator).drag == "cancelled", "the drag is dropped")
    operator.page.mouse.move(*operator.frame_to_screen(170, 140), steps=4)
    operator.page.mouse.up()
    operator.until(lambda: session_of(operator).drag == "none", "the dropped drag has ended")
    assert session_of(operator).shown.area is None
    operator.drag((50, 50), (150, 120))
    operator.until(lambda: session_of(operator).objects[0].area is not None, "the area is drawn")


def test_a_drag_may_end_outside_the_picture(operator: Operator, caplog: pytest.LogCaptureFixture) -> None:
    operator.drag((150, 60), (260, 120), release=False)
    operator.page.mouse.move(1000, 590, steps=4)
    operator.page.mouse.up()
    operator.until(lambda: session_of(operator).objects[0].area is not None, "the area is drawn")
    operator.settle()
    area = session_of(operator).shown.area
    assert area is not None
    assert max(u for u, _ in area.vertices_px) == 319
    assert operator.view.state.last_point_px is not None
    assert operator.view.state.last_point_px[0] == 319
    assert not caplog.records


@pytest.mark.parametrize("point", [(-500.0, 50.0), (5000.0, 4000.0), (0.0, 239.0)])
def test_the_crop_keeps_to_the_frame(point: Pixel, scene: Simulated) -> None:
    pictures = Pictures(scene.frame)
    assert pictures.crop(point).shape == pictures.crop((100.0, 100.0)).shape


def test_the_picture_stays_under_a_drag_and_is_zoomed_about_the_area(operator: Operator) -> None:
    operator.drag((50, 50), (150, 120), release=False)
    operator.until(lambda: session_of(operator).drag == "running", "the drag runs")
    for key in "vr":
        operator.page.keyboard.press(key)
    operator.settle()
    assert (operator.view.state.view, operator.view.state.zoom) == ("camera", 1.0)
    operator.page.mouse.up()
    operator.until(lambda: session_of(operator).drag == "none", "the drag has ended")
    operator.page.keyboard.press("r")
    operator.until(lambda: operator.view.state.zoom > 1, "the picture is larger")
    assert np.allclose(operator.view.state.center_px or (), (100, 85), atol=TOLERANCE_PX)


def test_a_polygon_is_clicked_and_closed_on_its_first_corner(operator: Operator) -> None:
    corners = [(60, 60), (200, 70), (180, 180), (70, 150)]
    for count, corner in enumerate(corners, start=1):
        operator.click(*corner)
        operator.until(lambda count=count: len(session_of(operator).vertices_px) == count, "the corner is there")
    operator.settle()
    operator.click(*corners[0])
    operator.until(lambda: session_of(operator).shown.area is not None, "the polygon is closed")
    area = session_of(operator).shown.area
    assert area is not None
    assert np.abs(np.subtract(area.vertices_px, AreaOfInterest(tuple(corners)).vertices_px)).max() < TOLERANCE_PX


def test_keys_take_back_close_and_cancel_a_polygon(operator: Operator) -> None:
    for count, corner in enumerate([(60, 60), (200, 70), (180, 180), (70, 150)], start=1):
        operator.click(*corner)
        operator.until(lambda count=count: len(session_of(operator).vertices_px) == count, "the corner is there")
    operator.page.keyboard.press("Backspace")
    operator.until(lambda: len(session_of(operator).vertices_px) == 3, "the last corner is taken back")
    operator.page.keyboard.press("Enter")
    operator.until(lambda: session_of(operator).shown.area is not None, "the polygon is closed")
    operator.settle()
    operator.click(20, 200)
    operator.until(lambda: len(session_of(operator).vertices_px) == 1, "a new polygon is begun")
    operator.page.keyboard.press("Escape")
    operator.until(lambda: session_of(operator).vertices_px == (), "the new polygon is dropped")
    assert session_of(operator).shown.area is not None


def test_a_drawing_that_cannot_be_measured_is_refused_with_advice(operator: Operator) -> None:
    operator.drag((40, 40), (80, 80))
    operator.until(lambda: session_of(operator).shown.area is not None, "the area is drawn")
    operator.settle()
    operator.drag((200, 150), (200, 200), shift=True)
    expect(operator.page.get_by_text("This drawing cannot be measured")).to_be_visible()
    expect(operator.page.get_by_test_id("hint")).to_contain_text("inside the area")


def test_the_kind_that_is_asked_for_is_fitted(drawn: Operator) -> None:
    drawn.page.get_by_label("Object is a").click()
    drawn.page.get_by_role("option", name="rod").click()
    drawn.until(lambda: session_of(drawn).shown.kind == "rod", "the kind is chosen")
    shows_its_result(drawn)
    assert drawn.value("kind") == "rod"


def test_by_touch_a_plain_drag_draws_the_axis_when_that_is_chosen(operator: Operator) -> None:
    operator.drag((100, 60), (200, 180))
    expect(operator.page.get_by_test_id("hint")).to_contain_text("or choose Axis")
    operator.page.get_by_label("A drag draws").click()
    operator.page.get_by_role("option", name="Axis").click()
    operator.until(lambda: session_of(operator).tool == "axis", "the axis is chosen")
    operator.settle()
    operator.drag((150, 80), (150, 160))
    operator.until(lambda: is_drawn(operator), "the axis is drawn")


def test_an_area_alone_is_measured_and_what_is_known_of_the_diameter_is_obeyed(
    operator: Operator, scene: Simulated
) -> None:
    columns, rows = zip(*scene.drawing.area.vertices_px, strict=True)
    operator.drag((min(columns), min(rows)), (max(columns), max(rows)))
    operator.until(lambda: session_of(operator).shown.proposed, "an axis is proposed")
    shows_its_result(operator)
    diameter_mm = float(operator.value("diameter_mm") or 0)
    assert diameter_mm == pytest.approx(100, rel=0.1)
    known_mm = round(diameter_mm, 1)
    operator.page.get_by_text("What is known").click()
    fields = operator.page.get_by_label("Diameter from / to, mm").locator("xpath=../../..").get_by_role("textbox")
    for number in (0, 1):
        fields.nth(number).fill(str(known_mm))
        operator.until(lambda number=number: session_of(operator).shown.diameter_mm[number] == known_mm, "it is known")
    shows_its_result(operator)
    assert float(operator.value("diameter_mm") or 0) == pytest.approx(known_mm, abs=1e-6)
    expect(operator.page.get_by_text(f"What is known: {known_mm:g} mm")).to_be_visible()


def test_buttons_do_what_keys_do(drawn: Operator) -> None:
    drawing = session_of(drawn).objects
    for button, expected in (("Clear", False), ("Undo", True), ("Redo", False)):
        drawn.page.get_by_role("button", name=button, exact=True).click()
        drawn.until(lambda expected=expected: (session_of(drawn).objects == drawing) == expected, button)

"""Looking closely before deciding: the tool at its place, the stages, residuals, and a distance, on the real page."""

from playwright.sync_api import Page, expect

from rotrecon.simulation.simulate import Simulated
from tests.browser.operator import Operator
from tests.browser.test_page import drawing_events


def open_tab(page: Page, name: str) -> None:
    page.get_by_role("tab", name=name, exact=True).click()


def test_the_tool_is_moved_and_checked_again_and_the_object_looked_at(operator: Operator, scene: Simulated) -> None:
    page = operator.page
    operator.send(*drawing_events(scene))
    open_tab(page, "Tool")
    expect(page.locator('[data-tool="mechanical cutter"]')).to_have_attribute("data-verdict", "fits")
    place = page.get_by_test_id("place")
    expect(place).to_contain_text("where it is proposed")
    angle = page.get_by_label("Approach turned by, °")
    angle.fill("40")
    expect(place).to_contain_text("turned by 40°")
    operator.until(lambda: operator.console.session.up_to_date, "the object is measured with its new contact")
    page.get_by_text("Where should the camera go?").click()
    expect(page.get_by_test_id("next-view")).to_contain_text("the diameter should be known to")

    open_tab(page, "Stages")
    shown = page.get_by_test_id("step")
    expect(shown).to_contain_text("Step 1 of 6, all depths the arm can use")
    page.get_by_role("slider").first.focus()
    page.keyboard.press("ArrowRight")
    expect(shown).to_contain_text("Step 2 of 6, run 1")
    expect(page.get_by_test_id("candidates")).to_contain_text("chosen")

    page.get_by_label("Over the picture").click()
    page.get_by_role("option", name="residuals").click()
    expect(page.get_by_test_id("residuals")).to_contain_text("outside")
    page.get_by_role("button", name="3D", exact=True).click()
    scene = operator.view.client.scene
    operator.until(lambda: getattr(scene.get_handle_by_name("/residuals"), "visible", False), "they are in the 3D view")
    assert scene.get_handle_by_name("/world/object") is not None, "in place of what all pages see"
    page.get_by_role("button", name="Camera", exact=True).click()
    operator.until(lambda: not scene.get_handle_by_name("/residuals").visible, "they do not hide the picture")
    operator.settle()

    page.get_by_label("Clicks measure a distance").check()
    expect(page.get_by_test_id("distance")).to_contain_text("first point")
    for pixel in ((60.0, 100.0), (250.0, 100.0)):
        operator.click(*pixel)
        operator.settle()
    expect(page.get_by_test_id("distance")).to_contain_text("mm between the two points")
    assert not operator.console.session.vertices_px, "the clicks were no corners"

    open_tab(page, "Why")
    page.get_by_text("Where does this number come from?").click()
    page.locator('[data-origin="arc_deg"] summary').click()
    expect(page.get_by_text("How far round the axis the depths agree")).to_be_visible()

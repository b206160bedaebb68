"""What belongs to one page: its view, zoom, layers and section; and what the server does not do for anybody."""

from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, expect

from app.events import Event, PointerDragged, PolygonClosed, SectionToggled, VertexClicked
from app.host import HostError, check_host
from app.serving import serve
from rotrecon.overlay import section_pixels
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated
from tests.browser.conftest import opened_page
from tests.browser.operator import Operator


def drawing_events(scene: Simulated) -> tuple[Event, ...]:
    """The scene's object, drawn."""
    corners = (VertexClicked(corner, reach_px=0.0) for corner in scene.drawing.area.vertices_px)
    axis = scene.drawing.axis
    return (*corners, PolygonClosed(), PointerDragged(axis.start_px, axis.end_px, shift=True))


def test_the_keys_change_the_view_and_the_camera_view_comes_back(operator: Operator, scene: Simulated) -> None:
    sensor = scene.frame.T_base_camera[:3, 3]
    operator.page.keyboard.press("v")
    operator.until(lambda: not np.allclose(operator.view.client.camera.position, sensor), "the 3D view is shown")
    operator.page.keyboard.press("c")
    operator.until(lambda: operator.view.state.view == "camera", "the camera view is asked for")
    operator.settle()
    assert np.allclose(operator.view.client.camera.position, sensor)


def test_what_moves_the_camera_does_not_move_the_camera_view(operator: Operator, scene: Simulated) -> None:
    moved: list[bool] = []

    async def watch(camera: object) -> None:
        moved.append(True)

    operator.view.client.camera.on_update(watch)
    operator.page.keyboard.press("w", delay=300)
    operator.until(lambda: bool(moved), "the key has moved the camera")
    sensor = scene.frame.T_base_camera[:3, 3]
    operator.until(
        lambda: np.allclose(operator.view.client.camera.position, sensor, atol=1e-4), "the camera is put back"
    )


def test_zooming_looks_at_the_last_point(operator: Operator) -> None:
    operator.click(80, 60)
    operator.until(lambda: operator.view.state.last_point_px is not None, "the point is known")
    fov_rad = operator.view.client.camera.fov
    operator.page.keyboard.press("r")
    operator.until(lambda: operator.view.client.camera.fov < 0.8 * fov_rad, "the picture is larger")
    operator.settle()
    box = operator.page.locator("canvas").first.bounding_box()
    assert box is not None
    assert np.allclose(operator.frame_to_screen(80, 60), (box["width"] / 2, box["height"] / 2), atol=3)
    operator.page.keyboard.press("f")
    operator.until(lambda: abs(operator.view.client.camera.fov - fov_rad) < 1e-6, "the whole picture is back")


def test_sections_are_stepped_and_excluded(operator: Operator, scene: Simulated) -> None:
    operator.send(*drawing_events(scene))
    operator.page.get_by_role("tab", name="Sections").click()
    shown = operator.page.get_by_test_id("section")
    expect(shown).to_contain_text(" of ")
    number = int((shown.text_content() or "").split()[1])
    operator.page.keyboard.press("x")
    expect(shown).to_contain_text(f"Section {number + 1} of")
    operator.page.keyboard.press("z")
    expect(shown).to_contain_text(f"Section {number} of")
    expect(operator.page.locator("svg.rr-section")).to_be_visible()
    operator.page.get_by_role("button", name="Exclude this section").click()
    expect(shown).to_contain_text("excluded by hand")
    assert operator.console.session.shown.excluded_sections == {number - 1}
    operator.page.get_by_role("button", name="Put this section back").click()
    operator.until(lambda: not operator.console.session.shown.excluded_sections, "the section counts again")
    restore = operator.page.get_by_role("button", name="Put all back")
    expect(restore).to_have_count(0)
    operator.settle()
    operator.send(SectionToggled(3))
    operator.send(SectionToggled(number))
    restore.click()
    operator.until(lambda: not operator.console.session.shown.excluded_sections, "all sections count again")


def test_a_click_on_the_object_lights_the_section_there(operator: Operator, scene: Simulated) -> None:
    operator.send(*drawing_events(scene))
    result = operator.console.session.reconstruction
    assert result is not None
    places = {section: section_pixels(result, section).mean(axis=0) for section in (10, 40)}
    operator.page.keyboard.down("Control")
    for section, (u, v) in places.items():
        operator.click(round(u), round(v))
        operator.until(lambda wanted=section: abs((operator.view.state.section or 0) - wanted) <= 2, "it is lit")
    operator.page.keyboard.up("Control")
    assert operator.console.session.vertices_px == (), "no corner of a polygon"
    operator.page.keyboard.press("v")
    operator.until(lambda: operator.view.state.view == "3D", "the 3D view is shown")
    operator.settle()
    before = operator.view.state.section
    solid = result.solid
    assert solid is not None
    place_m = solid.center_m + 0.8 * solid.ends[0] * solid.direction

    def another_is_lit() -> bool:
        """Clicks again, as what the page last told of its camera may be from before it turned to the 3D view."""
        operator.page.mouse.click(*operator.base_to_screen(place_m))
        operator.frames()
        return operator.view.state.section != before

    operator.until(another_is_lit, "another section is lit")


def test_two_pages_share_the_drawing_and_not_the_view(operator: Operator, browser: Browser, scene: Simulated) -> None:
    with opened_page(browser) as page:
        other = Operator(page, operator.console)
        operator.send(*drawing_events(scene))
        expect(other.page.locator('[data-field="diameter_mm"]')).to_have_attribute(
            "data-value", operator.value("diameter_mm") or ""
        )
        other.page.keyboard.press("v")
        other.until(lambda: other.view.state.view == "3D", "the other page shows the 3D view")
        assert operator.view.state.view == "camera"
    operator.until(lambda: other.client_id not in operator.console.pages, "the closed page is forgotten")


def test_layers_and_depth_are_chosen_on_the_page(operator: Operator) -> None:
    operator.page.get_by_role("tab", name="Picture").click()
    operator.page.get_by_label("Frame shows").click()
    operator.page.get_by_role("option", name="depth map").click()
    operator.until(lambda: operator.view.state.layer == "depth map", "the layer is chosen")
    slider = operator.page.get_by_role("slider").last
    slider.focus()
    slider.press("End")
    operator.until(lambda: operator.view.state.depth_opacity == 1.0, "the depth covers the picture")
    operator.settle()


def test_sharing_is_refused_and_not_offered(operator: Operator) -> None:
    assert operator.console.server.request_share_url() is None
    expect(operator.page.get_by_label("Share")).to_have_count(0)
    assert operator.console.server._share_tunnel is None


@pytest.mark.parametrize("host", ["nonsense.invalid", "192.0.2.1", "2001:db8::1", "", "..", "a" * 80, "1 2", "\0"])
def test_a_host_that_is_not_this_machines_is_refused_at_once(host: str, scene: Simulated, tmp_path: Path) -> None:
    with pytest.raises(HostError) as refused:
        serve(scene.frame, "A pipe", Settings(), host, people=tmp_path / "users.json", announce=lambda line: None)
    assert repr(host) in str(refused.value)
    assert "leave --host out" in str(refused.value)


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "0.0.0.0"])
def test_a_host_of_this_machine_is_taken(host: str) -> None:
    check_host(host)

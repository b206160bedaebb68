"""A person at the page, for tests and for pictures of it: where a pixel is on the screen, drags, clicks, and waits."""

from collections.abc import Callable
from io import BytesIO
from shutil import which
from time import monotonic

import imageio.v3 as imageio
import numpy as np
from playwright.sync_api import Page, expect
from viser import transforms as tf

from app.console import Console
from app.console_items import FromPage
from app.deciding.events import DecisionEvent
from app.events import Event
from app.object_drawing import Pixel
from app.page_view import PageView
from rotrecon.arrays import Floats
from rotrecon.camera import transform

CHROMIUM = which("chromium") or which("chromium-browser") or "/usr/bin/chromium"
"""Debian's name, then Ubuntu's."""
CHROMIUM_ARGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-default-apps",
    "--disable-extensions",
    "--disable-sync",
    "--no-first-run",
    "--no-default-browser-check",
]
"""Software WebGL, and nothing that talks to the outside."""
TIMEOUT_S = 30.0
BACKDROP_LEVEL = 24


class Operator:
    """A page in a browser, and the console behind it."""

    def __init__(
        self,
        page: Page,
        console: Console,
        enter: Callable[[Page], object] | None = None,
        *,
        takes_control: bool = True,
    ) -> None:
        """`enter` opens the page by another way than the console's own address; control is taken if nobody has it."""
        self.page, self.console = page, console
        page.set_default_timeout(1000 * TIMEOUT_S)
        known = set(console.pages)
        if enter is None:
            page.goto(console.address)
        else:
            enter(page)
        self.until(lambda: len(set(console.pages) - known) == 1, "the page has connected")
        (self.client_id,) = set(console.pages) - known
        self._dismiss_software_notice()
        expect(page.get_by_test_id("hint")).to_be_visible()
        self.until(self._picture_in_place, "the picture is where it belongs")
        if takes_control and console.session.decision.control.holder is None:
            self.page.get_by_role("button", name="Take control").click()
            self.until(lambda: self.in_control, "this page is in control")
            self.settle()

    @property
    def in_control(self) -> bool:
        """Whether this page may draw and decide."""
        return self.console.session.decision.control.holder == self.client_id

    @property
    def view(self) -> PageView:
        """What the server knows of this page."""
        return self.console.pages[self.client_id]

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Wait for something that the server or the screen has to show."""
        end = monotonic() + TIMEOUT_S
        while not condition():
            assert monotonic() < end, f"waited {TIMEOUT_S:g} s, and not yet: {what}"
            self.page.wait_for_timeout(20)

    def settle(self) -> None:
        """Wait until the server has nothing left to do and the page has drawn it."""
        self.console.wait_until_idle(TIMEOUT_S)
        self.frames()

    def frames(self, count: int = 4) -> None:
        """Wait for frames to be drawn, after which what had arrived can be seen and clicked."""
        next_frame = "n => new Promise(done => { const f = () => n-- > 0 ? requestAnimationFrame(f) : done(); f(); })"
        self.page.evaluate(next_frame, count)

    def frame_to_screen(self, u: float, v: float) -> tuple[float, float]:
        """Place on the page of a pixel of the frame, in the camera view."""
        frame = self.console.frame
        return self.base_to_screen(transform(frame.T_base_camera, frame.camera.unproject((u, v), 1.0)))

    def base_to_screen(self, point_m: Floats) -> tuple[float, float]:
        """Place on the page of a point in base coordinates, in either view."""
        camera = self.view.client.camera
        ray = tf.SO3(camera.wxyz).as_matrix().T @ (point_m - camera.position)
        box = self.page.locator("canvas").first.bounding_box()
        assert box is not None
        focal = box["height"] / 2 / np.tan(camera.fov / 2)
        x, y = ray[:2] / ray[2] * focal
        return (float(box["x"] + box["width"] / 2 + x), float(box["y"] + box["height"] / 2 + y))

    def drag(self, start: Pixel, end: Pixel, *, shift: bool = False, release: bool = True) -> None:
        """Drag on the picture from pixel to pixel of the frame, by way of its middle."""
        mouse, middle = self.page.mouse, (np.array(start) + end) / 2
        if shift:
            self.page.keyboard.down("Shift")
        mouse.move(*self.frame_to_screen(*start))
        mouse.down()
        for point in (middle, end):
            mouse.move(*self.frame_to_screen(*point), steps=4)
        if release:
            mouse.up()
        if shift:
            self.page.keyboard.up("Shift")

    def click(self, u: float, v: float) -> None:
        """Click on a pixel of the frame."""
        self.page.mouse.click(*self.frame_to_screen(u, v))

    def send(self, *events: Event | DecisionEvent) -> None:
        """Let events happen as if they had come from this page, for tests of what follows from them."""
        for event in events:
            self.console.server.get_event_loop().call_soon_threadsafe(
                self.console.post, FromPage(self.client_id, event)
            )
        self.settle()

    def value(self, field: str) -> str | None:
        """Exact value of a number of the result, as the page has it."""
        return self.page.locator(f'[data-field="{field}"]').get_attribute("data-value")

    def _dismiss_software_notice(self) -> None:
        notice = self.page.get_by_text("Software WebGL rendering detected")
        notice.wait_for()
        self.page.locator(".mantine-Notification-closeButton").first.click()
        notice.wait_for(state="detached")

    def _picture_in_place(self) -> bool:
        """Whether the picture's four corners are where they should be, with the backdrop just outside of them."""
        self.console.wait_until_idle(TIMEOUT_S)
        screen = imageio.imread(BytesIO(self.page.screenshot()))[..., :3].astype(int)
        width, height = self.console.frame.camera.width, self.console.frame.camera.height
        inset, outset = 6, 6
        for u, outward_u in ((0, -1), (width - 1, 1)):
            for v, outward_v in ((0, -1), (height - 1, 1)):
                x, y = self.frame_to_screen(u, v)
                inner = screen[round(y - outward_v * inset), round(x - outward_u * inset)]
                outer = screen[round(y + outward_v * outset), round(x + outward_u * outset)]
                if np.abs(inner - BACKDROP_LEVEL).max() < 4 or np.abs(outer - BACKDROP_LEVEL).max() > 4:
                    return False
        return True

"""Make the README's pictures again: the console on the recorded tin, driven by a real browser."""

import sys
from contextlib import closing
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import imageio.v3 as imageio
import numpy as np
from playwright.sync_api import Page, sync_playwright

from app.console import Console
from app.deciding.settings import DecisionSettings
from app.drawing_text import parse_area, parse_axis
from app.record.store import Record
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.overlay import blend, depth_colors, depth_range_m, outlines, with_outlines, with_segmentation
from rotrecon.reconstruct import reconstruct
from rotrecon.scene.reading import read_scene
from rotrecon.settings import Settings
from tests.browser.conftest import SLOW_PAGE
from tests.browser.operator import CHROMIUM, CHROMIUM_ARGS, Operator
from tests.browser.steps import arm, hold
from tests.recordings import DATA

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
AREA, AXIS = "270,50 380,232", "325,75 325,222"
DECIDING = replace(SLOW_PAGE, arm_s=DecisionSettings().arm_s)
CROP = np.s_[20:260, 180:470]


def main() -> None:
    """Write every picture; needs the recording of the tin and Chromium."""
    capture = read_scene(DATA / "tin")
    frame = capture.frame()
    assert isinstance(frame, Frame)
    PICTURES.mkdir(parents=True, exist_ok=True)
    write_figures(frame)
    with TemporaryDirectory() as folder, closing(Record.open(Path(folder))) as record:
        console = Console(
            frame, capture.name, Settings(), port=0, notes=capture.notes, record=record, deciding=DECIDING
        )
        console.start()
        try:
            write_console(console)
        finally:
            console.stop()


def write_console(console: Console) -> None:
    """The page in both views, and on the way to a confirmed tool."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_ARGS)
        page = browser.new_page(viewport={"width": 1280, "height": 720})
        operator = Operator(page, console)
        draw(operator)
        save(page, "camera-view.jpg")
        page.get_by_role("tab", name="Stages").click()
        page.get_by_label("Over the picture").click()
        page.get_by_role("option", name="tool").click()
        page.get_by_role("tab", name="Tool").click()
        operator.settle()
        page.get_by_test_id("place").scroll_into_view_if_needed()
        operator.frames(10)
        save(page, "tool.jpg")
        page.keyboard.press("v")
        operator.settle()
        operator.frames(10)
        save(page, "3d-view.jpg")
        page.keyboard.press("c")
        page.get_by_role("tab", name="Decision").click()
        arm(operator)
        operator.frames(10)
        save(page, "armed.jpg")
        hold(operator, "confirmed")
        page.get_by_role("tab", name="History").click()
        page.get_by_test_id("history").locator("[data-kind=confirmed]").wait_for()
        operator.frames(10)
        save(page, "history.jpg")


def draw(operator: Operator) -> None:
    """What an operator does: an area by dragging, the axis by dragging with shift."""
    corners = parse_area(AREA).vertices_px
    axis = parse_axis(AXIS)
    operator.drag(corners[0], corners[2])
    operator.settle()
    operator.drag(axis.start_px, axis.end_px, shift=True)
    operator.settle()
    operator.frames(10)


def save(page: Page, name: str) -> None:
    """The page as a JPEG that a README can carry."""
    write(name, imageio.imread(BytesIO(page.screenshot()))[..., :3])


def write_figures(frame: Frame) -> None:
    """Depth over the frame, the segmentation, and the re-projected solid, side by side."""
    result = reconstruct(frame, Drawing(parse_area(AREA), parse_axis(AXIS)), Settings())
    colors = depth_colors(frame.depth_m, depth_range_m(frame.depth_m))
    figures = [
        blend(frame.image, colors, np.isfinite(frame.depth_m), 0.7),
        with_segmentation(frame.image, result, "close"),
        with_segmentation(frame.image, result),
        with_outlines(frame.image, outlines(result)),
    ]
    write("figures.jpg", np.hstack([figure[CROP] for figure in figures]))


def write(name: str, image: np.ndarray) -> None:
    """Write an RGB image (H, W, 3)."""
    cv2.imwrite(str(PICTURES / name), image[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 82])


if __name__ == "__main__":
    sys.exit(main())

"""A console on a small simulated scene, and a real browser that opens its page."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from math import inf
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

from app.console import Console
from app.deciding.settings import DecisionSettings
from app.record.store import Record
from rotrecon.camera import PinholeCamera
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated, simulate
from rotrecon.simulation.stereo_noise import StereoErrors
from tests.browser.operator import CHROMIUM, CHROMIUM_ARGS, Operator

SMALL_CAMERA = PinholeCamera(320, 240, np.array([[300.0, 0, 165.0], [0, 301.0, 117.0], [0, 0, 1]]))
"""With a principal point off the middle, as real ones are."""


VIEWPORT: ViewportSize = {"width": 1024, "height": 600}
"""Software WebGL takes its time by the pixel."""

SLOW_PAGE = DecisionSettings(arm_s=60.0, hold_ticks=3, hold_gap_s=2.0, silent_s=inf)
"""With software WebGL a page hangs for up to a second; what the times do is tested without a browser, and silence by
itself."""


LITTLE_NOISE = StereoErrors(disparity_sigma_px=0.03, window_px=1, half_occlusion=False)
"""Enough for no two drawings to give the same diameter."""


@pytest.fixture(scope="session")
def scene() -> Simulated:
    return simulate("pipe", 3, SMALL_CAMERA, LITTLE_NOISE, supersampling=1)


@pytest.fixture
def console(scene: Simulated, tmp_path: Path) -> Iterator[Console]:
    with closing(Record.open(tmp_path)) as record:
        console = Console(
            scene.frame, "A pipe", Settings(), port=0, cloud_points=500, record=record, deciding=SLOW_PAGE
        )
        console.start()
        yield console
        console.stop()


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_ARGS)
        yield browser
        browser.close()


@contextmanager
def opened_page(browser: Browser) -> Iterator[Page]:
    """An empty page of its own, closed at the end: one that is left open draws on, and slows all tests after it."""
    with closing(browser.new_page(viewport=VIEWPORT)) as page:
        yield page


@pytest.fixture
def operator(browser: Browser, console: Console) -> Iterator[Operator]:
    with opened_page(browser) as page:
        yield Operator(page, console)

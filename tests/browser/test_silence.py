"""A real page that hangs with its connection open loses control, and one that nothing is done on keeps it."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Dialog

from app.console import Console
from app.deciding.settings import DecisionSettings
from app.record.store import Record
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated
from tests.browser.conftest import VIEWPORT
from tests.browser.operator import Operator

SILENT_S = 8.0
"""Software WebGL lets a page hang for up to a second."""


@pytest.fixture
def console(scene: Simulated, tmp_path: Path) -> Iterator[Console]:
    limits = DecisionSettings(silent_s=SILENT_S)
    with closing(Record.open(tmp_path)) as record:
        console = Console(scene.frame, "A pipe", Settings(), port=0, cloud_points=10, record=record, deciding=limits)
        console.start()
        yield console
        console.stop()


def test_a_page_that_hangs_loses_control_and_an_idle_one_keeps_it(console: Console, browser: Browser) -> None:
    operator = Operator(browser.new_page(viewport=VIEWPORT), console)
    before = console.told.decision.control.heard
    operator.until(lambda: console.told.decision.now > before + 1.2 * SILENT_S, "it was idle for long enough")
    assert operator.in_control
    dialogs: list[Dialog] = []
    operator.page.on("dialog", lambda dialog: dialogs.append(dialog))  # nobody answers it, and the page hangs
    operator.page.evaluate("() => { setTimeout(() => alert('hung')) }")
    operator.until(lambda: bool(dialogs) and not operator.in_control, "the page that hangs has lost control")
    assert operator.client_id in console.server.get_clients(), "with its connection open"
    dialogs[0].accept()
    operator.page.get_by_text("This page did not answer").wait_for()
    operator.page.close()

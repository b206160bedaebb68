"""What a person does to decide: arm, and hold."""

from contextlib import closing
from pathlib import Path

from playwright.sync_api import Locator, expect

from app.record.store import Record
from app.record.verify import verify
from tests.browser.operator import TIMEOUT_S, Operator


def button(operator: Operator, name: str) -> Locator:
    return operator.page.get_by_role("button", name=name)


def state(operator: Operator, name: str) -> None:
    """Wait until the page shows a state."""
    expect(operator.page.get_by_test_id("decision")).to_have_attribute("data-state", name, timeout=1000 * TIMEOUT_S)
    operator.settle()


def arm(operator: Operator) -> None:
    button(operator, "1. Arm").click()
    state(operator, "armed")


def hold(operator: Operator, until: str) -> None:
    """Press the second button and keep it pressed until the page shows a state."""
    button(operator, "2. Hold").hover()
    operator.page.mouse.down()
    state(operator, until)
    operator.page.mouse.up()
    operator.settle()


def kinds(folder: Path) -> list[str]:
    """What was recorded, the latest drawing's entries first to last."""
    with closing(Record.read(folder)) as record:
        assert verify(record) is None
        found = [entry.content["kind"] for entry in record.entries()]
    return found[len(found) - 1 - found[::-1].index("proposal") :]

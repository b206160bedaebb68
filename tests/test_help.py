"""The help names every key that the page binds, and every tab; what keys do, buttons do too."""

import re

import pytest

from app.page import Zoomed
from app.panels import HISTORY, KEYS, POLYGON, SECTION, TABS, VIEW, ZOOM
from app.static_files import static_text

HELP = static_text("help.html")
ROWS = re.findall(r"<tr><td>(.*?)</td>", HELP)
MODIFIERS = {None: (), "cmd/ctrl": ("Ctrl",), "cmd/ctrl+shift": ("Ctrl", "Shift")}


@pytest.mark.parametrize(("label", "key", "modifier", "event"), KEYS, ids=[key[0] for key in KEYS])
def test_every_key_is_in_the_help(label: str, key: str, modifier: str | None, event: object) -> None:
    keys = tuple(f"<kbd>{name}</kbd>" for name in (*MODIFIERS[modifier], key.capitalize()))
    if modifier is None:
        assert keys[0] in HELP
    else:
        assert " + ".join(keys) in ROWS


@pytest.mark.parametrize(("label", "key", "modifier", "event"), KEYS, ids=[key[0] for key in KEYS])
def test_what_a_key_does_a_button_does(label: str, key: str, modifier: str | None, event: object) -> None:
    buttons = [event for events in (POLYGON, HISTORY, VIEW, SECTION, ZOOM) for event in events.values()]
    assert event in buttons
    assert Zoomed(None) in buttons


def test_every_tab_is_in_the_help_in_its_place() -> None:
    tabs = HELP[HELP.index('data-list="tabs"') :]
    assert tuple(re.findall(r"<tr><td>(.*?)</td><td>..", tabs)) == TABS


@pytest.mark.parametrize("gesture", ["drag", "click, click", "<kbd>Shift</kbd> + drag", "drag a handle", "by touch"])
def test_every_gesture_is_in_the_help(gesture: str) -> None:
    assert any(row.startswith(gesture) for row in ROWS)
    assert "<kbd>Ctrl</kbd> + click" in HELP

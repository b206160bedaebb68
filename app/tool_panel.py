"""The tab of the tools: their clearances, the one that is shown at its place, and where the camera should go next."""

from collections.abc import Callable
from math import degrees
from typing import Any

from viser import GuiApi

from app.events import ContactPlaced
from app.session import Session
from app.tool_text import NOTHING, next_view_html, place_html, tools_html
from rotrecon.contact import limits_of
from rotrecon.reconstruction import Reconstruction

ANGLE_STEP_DEG, ALONG_STEP_MM = 5, 5
MOST_ANGLE_DEG = 90


class ToolPanel:
    """Controls and texts that all pages share."""

    def __init__(self, gui: GuiApi, choosing: Callable[[Callable[[Any], ContactPlaced]], Any]) -> None:
        """`choosing` makes a callback that posts the event that a value stands for."""
        self._placed = (0.0, 0.0)
        self._tools = gui.add_html(NOTHING)
        self._angle = gui.add_number(
            "Approach turned by, °",
            0.0,
            min=-MOST_ANGLE_DEG,
            max=MOST_ANGLE_DEG,
            step=ANGLE_STEP_DEG,
            hint="About the axis, from the camera's side",
        )
        self._along = gui.add_number(
            "Contact along the axis, mm", 0.0, step=ALONG_STEP_MM, hint="From the middle of the object"
        )
        self._place = gui.add_html("")
        with gui.add_folder("Where should the camera go?", expand_by_default=False):
            self._next = gui.add_html("")
        self._angle.on_update(choosing(lambda value: ContactPlaced(float(value), self._placed[1])))
        self._along.on_update(choosing(lambda value: ContactPlaced(self._placed[0], float(value))))

    def show(self, session: Session) -> None:
        """Bring it up to date, sending only what has changed."""
        contact, result = session.shown.contact, session.reconstruction
        self._placed = (degrees(contact.angle_rad), 1000 * contact.along_m)
        texts = (
            (self._tools, tools_html(result)),
            (self._place, place_html(result, session.overriding)),
            (self._next, next_view_html(result)),
        )
        for name, limit in zip(("min", "max"), limits_mm(result), strict=True):
            if getattr(self._along, name) != limit:
                setattr(self._along, name, limit)
        for handle, value in zip((self._angle, self._along), self._placed, strict=True):
            if abs(handle.value - value) > 1e-6:
                handle.value = round(value, 3)
        for handle, content in texts:
            if handle.content != content:
                handle.content = content


def limits_mm(result: Reconstruction | None) -> tuple[float | None, float | None]:
    """How far along the axis a contact may be, to either side of the middle; no limits before it is measured."""
    if result is None or result.solid is None:
        return None, None
    most_mm = 1000 * limits_of(result.solid).along_m
    return -most_mm, most_mm

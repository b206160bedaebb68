"""The tab of the tools: their clearances, the one that is shown at its place, and where the camera should go next."""

from math import degrees

from viser import GuiApi

from app.events import ContactPlaced
from app.session import Session
from app.showing import Choosing, in_session_unit, set_to, show_unit
from app.tool_text import NOTHING, free_instead, next_view_html, place_html, tools_html
from app.units import INCH_DECIMALS, Unit, from_mm, to_mm
from rotrecon.contact import Place, limits_of
from rotrecon.reconstruction import Reconstruction

ALONG = "Contact along the axis, {}"
ANGLE_STEP_DEG, ALONG_STEP_MM = 5, 5
MOST_ANGLE_DEG = 90


class ToolPanel:
    """Controls and texts that all pages share."""

    def __init__(self, gui: GuiApi, choosing: Choosing) -> None:
        self._placed = (0.0, 0.0)
        self._free_place: Place | None = None
        self._unit: Unit = "mm"
        self._tools = gui.add_html(NOTHING)
        self._angle = gui.add_number(
            "Approach turned by, °",
            0.0,
            min=-MOST_ANGLE_DEG,
            max=MOST_ANGLE_DEG,
            step=ANGLE_STEP_DEG,
            hint="About the axis, from the camera's side",
        )
        self._along = gui.add_number(ALONG.format("mm"), 0.0, step=ALONG_STEP_MM, hint="From the middle of the object")
        self._free = gui.add_button("Move it to the nearest free contact", visible=False, color="gray")
        self._place = gui.add_html("")
        with gui.add_folder("Where should the camera go?", expand_by_default=False):
            self._next = gui.add_html("")
        self._free.on_click(choosing(self._move_to_free))
        self._angle.on_update(choosing(lambda value: ContactPlaced(float(value), self._placed[1])))
        self._along.on_update(choosing(lambda value: ContactPlaced(self._placed[0], to_mm(float(value), self._unit))))

    def show(self, session: Session) -> None:
        """Bring it up to date, sending only what has changed."""
        contact, result = session.shown.contact, session.reconstruction
        self._free_place = free_instead(result) if session.up_to_date else None
        set_to(self._free, "visible", self._free_place is not None)
        self._placed, self._unit = (degrees(contact.angle_rad), 1000 * contact.along_m), session.unit
        show_unit(self._along, session.unit, ALONG, ALONG_STEP_MM)
        for name, limit_mm in zip(("min", "max"), limits_mm(result), strict=True):
            set_to(self._along, name, None if limit_mm is None else from_mm(limit_mm, session.unit))
        shown = (self._placed[0], from_mm(self._placed[1], session.unit))
        for handle, value in zip((self._angle, self._along), shown, strict=True):
            if abs(handle.value - value) > 1e-6:
                handle.value = round(value, 3 if session.unit == "mm" else INCH_DECIMALS)
        texts = (
            (self._tools, tools_html(result)),
            (self._place, place_html(result, session.overriding)),
            (self._next, next_view_html(result)),
        )
        for handle, content in texts:
            set_to(handle, "content", in_session_unit(content, session))

    def _move_to_free(self, _: object) -> ContactPlaced | None:
        place = self._free_place
        return None if place is None else ContactPlaced(degrees(place.angle_rad), 1000 * place.along_m)


def limits_mm(result: Reconstruction | None) -> tuple[float | None, float | None]:
    """How far along the axis a contact may be, to either side of the middle; no limits before it is measured."""
    if result is None or result.solid is None:
        return None, None
    most_mm = 1000 * limits_of(result.solid).along_m
    return -most_mm, most_mm

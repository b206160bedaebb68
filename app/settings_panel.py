"""The tab of the settings: each with its unit, its range, and the way back to what the program was started with."""

from typing import get_args

from viser import GuiApi

from app.adjustable import DECIDING, MEASURING, METHOD, METHODS, Adjustable
from app.events import SettingTyped, UnitChosen
from app.session import Session
from app.showing import Choosing, set_to, show_unit
from app.units import Unit, from_mm, in_unit, to_mm

WHOSE = "All pages show the same; whoever is in control changes it, and what is proposed is proposed anew."
LENGTHS = "Lengths in"
METHOD_LABEL = "Method"


class SettingsPanel:
    """Controls that all pages share."""

    def __init__(self, gui: GuiApi, choosing: Choosing) -> None:
        gui.add_html(f'<div class="rr-caption">{WHOSE}</div>')
        self._unit = gui.add_dropdown(LENGTHS, get_args(Unit))
        self._unit.on_update(choosing(UnitChosen))
        self._method = gui.add_dropdown(METHOD_LABEL, METHODS)
        self._method.on_update(choosing(lambda name: SettingTyped(METHOD, name)))
        self._rows = [_Row(gui, one, choosing) for one in MEASURING]
        gui.add_html('<div class="rr-why"><h4>Deciding</h4></div>')
        self._rows += [_Row(gui, one, choosing) for one in DECIDING]

    def show(self, session: Session) -> None:
        """Bring it up to date, sending only what has changed."""
        set_to(self._unit, "value", session.unit)
        set_to(self._method, "value", session.settings.method)
        for row in self._rows:
            row.show(session)


class _Row:
    """A number with what there is to know of it, and a button back to its default."""

    def __init__(self, gui: GuiApi, one: Adjustable, choosing: Choosing) -> None:
        self._one = one
        self._unit: Unit = "mm"
        self._default = one.setting(one.low)
        self._text = gui.add_html("")
        self._number = gui.add_number(one.unit, float(one.low), min=float(one.low), max=float(one.high), step=one.step)
        self._back = gui.add_button("Back", color="gray", visible=False)
        self._number.on_update(choosing(lambda value: SettingTyped(one.key, self._typed(float(value)))))
        self._back.on_click(choosing(lambda _: SettingTyped(one.key, self._default), read=False))

    def show(self, session: Session) -> None:
        """Bring it up to date; the texts are in mm up to here."""
        one, value, self._default = self._one, session.chosen[self._one.key], session.defaults[self._one.key]
        if one.unit == "mm":
            self._unit = session.unit
            show_unit(self._number, session.unit, "{}", one.step)
            set_to(self._number, "min", from_mm(one.low, session.unit))
            set_to(self._number, "max", from_mm(one.high, session.unit))
        set_to(self._number, "value", from_mm(one.shown(value), self._unit))
        default = f"{one.shown(self._default):.3g} {one.unit}".strip()
        ends = f"{one.low:g} to {one.high:g} {one.unit}".strip()
        text = f'<div class="rr-setting"><b>{one.label}</b>: {ends}, by default {default}. {one.why}</div>'
        set_to(self._text, "content", in_unit(text, session.unit))
        set_to(self._back, "label", in_unit(f"Back to {default}", session.unit))
        set_to(self._back, "visible", value != self._default)

    def _typed(self, value: float) -> float:
        """The setting that a typed number means; the ends of the range are no farther off by rounding."""
        one = self._one
        return one.setting(min(max(to_mm(value, self._unit), one.low), one.high))

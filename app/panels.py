"""The docked panels that all pages share: what to do next, the result, the drawing's controls, and the keys."""

from collections.abc import Callable, Mapping
from html import escape
from typing import Any

from viser import CommandHandle, GuiEvent, ViserServer

from app.events import (
    Cancelled,
    Cleared,
    DiameterTyped,
    DirectionChosen,
    Event,
    KindChosen,
    PolygonClosed,
    Redone,
    ToolChosen,
    Undone,
    VertexTakenBack,
)
from app.held import Held
from app.knowledge import DIRECTION_NAMES, knowledge_text
from app.newer_panel import newer_html
from app.object_drawing import UNKNOWN_MM
from app.origins import origins_html
from app.page import PageEvent, SectionStepped, ViewChosen, Zoomed
from app.result_text import result_html, why_html
from app.session import Session
from app.settings_panel import SettingsPanel
from app.showing import in_session_unit, set_to, show_unit
from app.static_files import static_text
from app.tool_panel import ToolPanel
from app.units import Unit, from_mm, in_unit, to_mm
from rotrecon.primitives import KINDS

PANEL_WIDTH_PX = 390
TABS = ("Decision", "Sections", "Stages", "Tool", "Picture", "Why", "History", "Buttons", "Settings", "Help")
AUTO = "auto"
KNOWN = "What is known"
DIAMETER, DIAMETER_STEP_MM = "Diameter from / to, {}", 0.1
DIRECTIONS = {name: DirectionChosen(direction) for direction, name in DIRECTION_NAMES.items()}
TOOLS = {"Area": ToolChosen("area"), "Axis": ToolChosen("axis")}
POLYGON = {"Close": PolygonClosed(), "Corner back": VertexTakenBack(), "Cancel": Cancelled()}
HISTORY = {"Undo": Undone(), "Redo": Redone(), "Clear": Cleared()}
VIEW = {"Camera": ViewChosen("camera"), "3D": ViewChosen("3D")}
SECTION = {"Previous": SectionStepped(-1), "Next": SectionStepped(1)}
ZOOM = {"In": Zoomed(1), "Out": Zoomed(-1), "Whole": Zoomed(None)}
KEYS: tuple[tuple[str, Any, Any, Event | PageEvent], ...] = (
    ("Camera view", "C", None, ViewChosen("camera")),
    ("3D view", "V", None, ViewChosen("3D")),
    ("Zoom in", "R", None, Zoomed(1)),
    ("Zoom out", "F", None, Zoomed(-1)),
    ("Previous section", "Z", None, SectionStepped(-1)),
    ("Next section", "X", None, SectionStepped(1)),
    ("Close the polygon", "enter", None, PolygonClosed()),
    ("Take back a corner", "backspace", None, VertexTakenBack()),
    ("Drop what was begun", "escape", None, Cancelled()),
    ("Undo", "Z", "cmd/ctrl", Undone()),
    ("Redo", "Z", "cmd/ctrl+shift", Redone()),
)

Post = Callable[[int, Event | PageEvent], None]
"""Takes an event from a page, by its client's number."""


class Panels:
    """Controls and texts that belong to the server, so that all pages show the same."""

    def __init__(self, server: ViserServer, held: Held, post: Post) -> None:
        self._gui, self._post = server.gui, post
        self._unit: Unit = "mm"
        self.camera_commands: list[CommandHandle] = []
        """Commands that move the camera of the page they come from and do nothing else."""
        self._gui.set_panel_label("rotrecon")
        self._gui.main_panel.dock_right()
        self._gui.main_panel.set_width(PANEL_WIDTH_PX)
        self._gui.add_html(f"<style>{static_text('console.css')}</style>")
        self._newer = self._gui.add_html("")
        self._result = self._gui.add_html("")
        self._add_buttons("View", VIEW)
        self._add_buttons("Drawing", HISTORY)
        self._tool = self._gui.add_dropdown("A drag draws", tuple(TOOLS), hint="Shift + drag: the axis")
        self._tool.on_update(self._choosing(TOOLS.get))
        self._kind = self._gui.add_dropdown("Object is a", (AUTO, *KINDS), initial_value=AUTO)
        self._kind.on_update(self._choosing(lambda value: KindChosen(None if value == AUTO else value)))
        self._add_knowledge()
        self._add_keys()
        panel = self._gui.add_panel()
        self.decision, self.sections, self.stages, tool, self.picture, *others = map(panel.add_tab, TABS)
        why, self.history, draw, settings, self.help = others
        with draw:
            self._add_controls()
        with tool:
            self._tools = ToolPanel(self._gui, self._choosing)
        with why:
            self._why = self._gui.add_html("")
            with self._gui.add_folder("Where does this number come from?", expand_by_default=False):
                self._origins = self._gui.add_html("")
        with settings:
            self._settings = SettingsPanel(self._gui, self._choosing)
        with self.help:
            self._help = self._gui.add_html(_help_html(held))
        panel.dock_below(self._gui.main_panel)

    def show(self, session: Session) -> None:
        """Bring texts and controls up to date, sending only what has changed."""
        self._unit = session.unit
        set_to(self._newer, "content", newer_html(session))
        set_to(self._result, "content", in_session_unit(result_html(session), session))
        set_to(self._kind, "value", session.shown.kind or AUTO)
        set_to(self._direction, "value", DIRECTION_NAMES[session.shown.direction])
        show_unit(self._diameter, self._unit, DIAMETER, DIAMETER_STEP_MM)
        low_mm, high_mm = session.shown.diameter_mm
        set_to(self._diameter, "value", (from_mm(low_mm, self._unit), from_mm(high_mm, self._unit)))
        known = in_unit(knowledge_text(session.shown), self._unit)
        set_to(self._known, "label", f"{KNOWN}: {known}" if known else KNOWN)
        set_to(self._tool, "value", session.tool.capitalize())
        if session.preview is None:
            set_to(self._why, "content", in_session_unit(why_html(session), session))
            set_to(self._origins, "content", in_unit(origins_html(), self._unit))
            self._tools.show(session)
        self._settings.show(session)

    def hold(self, held: Held) -> None:
        """Say of another frame which one it is."""
        self._help.content = _help_html(held)

    def _add_knowledge(self) -> None:
        """Folded away: what is in force stands in its label."""
        self._known = self._gui.add_folder(KNOWN, expand_by_default=False)
        with self._known:
            self._direction = self._gui.add_dropdown("Axis lies", tuple(DIRECTIONS))
            self._diameter = self._gui.add_vector2(
                DIAMETER.format("mm"),
                UNKNOWN_MM,
                min=UNKNOWN_MM,
                step=DIAMETER_STEP_MM,
                hint="0: not known; the same twice: held",
            )
        self._direction.on_update(self._choosing(DIRECTIONS.get))
        self._diameter.on_update(
            self._choosing(lambda typed: DiameterTyped(*(to_mm(float(one), self._unit) for one in typed)))
        )

    def _diameter_typed(self, typed: tuple[float, float]) -> DiameterTyped:
        return DiameterTyped(to_mm(float(typed[0]), self._unit), to_mm(float(typed[1]), self._unit))

    def _add_controls(self) -> None:
        for label, events in (("Polygon", POLYGON), ("Zoom", ZOOM), ("Section", SECTION)):
            self._add_buttons(label, events)

    def _add_buttons(self, label: str, events: Mapping[str, Event | PageEvent]) -> None:
        self._gui.add_button_group(label, tuple(events)).on_click(self._choosing(events.get))

    def _add_keys(self) -> None:
        for label, key, modifier, event in KEYS:
            command = self._gui.add_command(label, hotkey=key, modifier=modifier)
            command.on_trigger(self._choosing(lambda _, event=event: event, read=False))
            if isinstance(event, ViewChosen | Zoomed):
                self.camera_commands.append(command)

    def _choosing(self, event_of: Callable[[Any], Event | PageEvent | None], read: bool = True) -> Any:
        """A callback that posts the event a value stands for, when a page and not the program has set it."""

        async def chosen(event: GuiEvent[Any]) -> None:
            made = event_of(event.target.value if read else None)
            if made is not None and event.client_id is not None:
                self._post(event.client_id, made)

        return chosen


def _help_html(held: Held) -> str:
    """All keys, and which scene it is."""
    about = "".join(f"<p>{escape(line)}</p>" for line in (held.name, *held.notes))
    return static_text("help.html") + f'<div class="rr-help"><h4>Scene</h4>{about}</div>'

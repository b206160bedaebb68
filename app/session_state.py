"""What all pages share: the frozen Session."""

from dataclasses import dataclass, field, replace
from typing import Literal

from app.adjustable import Chosen
from app.deciding.states import Deciding
from app.deciding.watchdog import FrameFacts
from app.events import Refused
from app.held import Held, Newer, Taking
from app.object_drawing import ObjectDrawing, Part, Pixel
from app.units import Unit
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.tool_table import Tool

Objects = tuple[ObjectDrawing, ...]
VEIL = "a class is marked dangerous: say in the Decision panel what the object is, and the measurement is shown"
Drag = Literal["none", "running", "cancelled"]
"""Whether a button is held; what a cancelled drag still sends counts for nothing, up to its end."""


@dataclass(frozen=True)
class Measured:
    """What came of the drawing of one revision."""

    revision: int
    outcome: Reconstruction | Refused
    coarse: bool = False
    """Whether a finer one follows, once nothing is dragged any more."""


@dataclass(frozen=True)
class Notice:
    """Something the operator has to be told once about the drawing of one revision."""

    revision: int
    title: str
    text: str


@dataclass(frozen=True)
class Left:
    """What was there before an entry of the record was opened."""

    held: Held
    facts: FrameFacts
    objects: Objects
    selected: int


@dataclass(frozen=True)
class Session:
    """Everything that all pages share; the picture it is drawn on has `size_px` (width, height)."""

    size_px: tuple[int, int]
    objects: Objects = (ObjectDrawing(),)
    selected: int = 0
    preview: ObjectDrawing | None = None
    """The selected object as a drag that has not ended would leave it."""
    drag: Drag = "none"
    vertices_px: tuple[Pixel, ...] = ()
    """The corners of a polygon that has not been closed."""
    tool: Part = "area"
    """What a plain drag draws."""
    past: tuple[Objects, ...] = ()
    future: tuple[Objects, ...] = ()
    revision: int = 0
    """Grows with every change of what is shown."""
    measured: Measured | None = None
    """The latest measurement; until a new one is there, that of an earlier revision."""
    notice: Notice | None = None
    """The failure to measure what is shown, or to close the polygon; gone as soon as that changes."""
    decision: Deciding = field(default_factory=Deciding)
    """What is proposed, who may decide on it, and how far that has got."""
    settings: Settings = field(default_factory=Settings)
    """What everything is measured with."""
    defaults: Chosen = field(default_factory=Chosen)
    """The settings that the program was started with."""
    unit: Unit = "mm"
    """That lengths are shown in."""
    held: Held | None = None
    """What is drawn on and measured in."""
    newer: Newer | None = None
    """The latest that has come since, and waits to be taken."""
    taking: Taking | None = None
    """The one that is being made the held frame."""
    left: Left | None = None
    """What an entry of the record was opened instead of, while one is."""

    @property
    def chosen(self) -> Chosen:
        """The settings in force."""
        return Chosen(self.settings, self.decision.settings)

    @property
    def shown(self) -> ObjectDrawing:
        """The selected object, as it is being dragged if it is."""
        return self.objects[self.selected] if self.preview is None else self.preview

    @property
    def up_to_date(self) -> bool:
        """Whether there is nothing left to measure."""
        if self.shown.complete is None:
            return True
        return self.measured_once and (self.preview is not None or not (self.measured and self.measured.coarse))

    @property
    def measured_once(self) -> bool:
        """Whether there is a measurement of what is shown, be it a coarse one."""
        return self.measured is not None and self.measured.revision == self.revision

    @property
    def reconstruction(self) -> Reconstruction | None:
        """The latest reconstruction, if the latest drawing could be measured at all."""
        if self.measured is None or isinstance(self.measured.outcome, Refused):
            return None
        return self.measured.outcome

    @property
    def proposal_told(self) -> bool:
        """Whether the tool that fits may be named: its proposal is on disk."""
        return self.decision.case is not None and self.decision.fault is None

    @property
    def entry(self) -> int | None:
        """Of the record, whose frame is held; None for one that was opened or taken."""
        return None if self.held is None else self.held.entry

    @property
    def overriding(self) -> Tool | None:
        """The tool that the operator has chosen against the program's answer."""
        case, result = self.decision.case, self.reconstruction
        if case is None or case.override is None or result is None:
            return None
        return next((tool for tool in result.settings.tools if tool.name == case.tool), None)

    @property
    def visible(self) -> "Session":
        """The session as pages may show it: without a result whose class the operator has to name first."""
        if self.measured is None or not self.decision.veiled:
            return self
        if self.reconstruction is None or self.reconstruction.solid is None:
            return self
        return replace(self, measured=replace(self.measured, outcome=Refused(VEIL)))


def with_selected(session: Session, drawn: ObjectDrawing) -> Objects:
    """The objects, the selected one drawn anew."""
    return (*session.objects[: session.selected], drawn, *session.objects[session.selected + 1 :])


def sentence(text: str) -> str:
    """A reason as a sentence of its own: a capital first, a full stop last."""
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "!", "?")) else ".")

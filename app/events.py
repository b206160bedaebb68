"""What can happen to a session: everything a person does on a page, and a measurement that comes back."""

from dataclasses import dataclass

from app.object_drawing import Part, Pixel
from app.units import Unit
from rotrecon.drawing import Direction
from rotrecon.primitives import Kind
from rotrecon.reconstruction import Reconstruction


@dataclass(frozen=True)
class Refused:
    """A drawing that nothing can be measured with, and what to draw instead."""

    reason: str


@dataclass(frozen=True)
class PointerDragged:
    """A drag on the picture: with shift, or with the axis tool, an axis; otherwise a rectangle.

    While a polygon is open a plain drag is a click, unless the axis tool draws one longer than `reach_px`.
    """

    start_px: Pixel
    end_px: Pixel
    shift: bool = False
    finished: bool = True
    reach_px: float = 6.0


@dataclass(frozen=True)
class VertexClicked:
    """A click on the picture: a corner of a polygon, or its end when within `reach_px` of the first corner.

    Within reach of the corner before, or of a corner of the area just closed, it is the second of a double click.
    """

    point_px: Pixel
    reach_px: float = 6.0


@dataclass(frozen=True)
class HandleMoved:
    """A corner of the area or an end of the axis (0 or 1) dragged to another place."""

    part: Part
    index: int
    point_px: Pixel
    finished: bool = True


@dataclass(frozen=True)
class PolygonClosed:
    """The polygon is to be closed as it is."""


@dataclass(frozen=True)
class VertexTakenBack:
    """The last corner of the open polygon was a mistake."""


@dataclass(frozen=True)
class Cancelled:
    """Whatever was begun and not finished is dropped."""


@dataclass(frozen=True)
class PageLeft:
    """A page was closed: a drag that it began will have no end."""


@dataclass(frozen=True)
class Cleared:
    """Area and axis of the selected object are taken away; what is known of it stays."""


@dataclass(frozen=True)
class Undone:
    """The last corner of an open polygon, else the last change of a drawing, is taken back."""


@dataclass(frozen=True)
class Redone:
    """What was undone last is done again."""


@dataclass(frozen=True)
class ToolChosen:
    """What a plain drag draws from now on."""

    tool: Part


@dataclass(frozen=True)
class KindChosen:
    """The kind of solid to fit; None lets the program decide."""

    kind: Kind | None


@dataclass(frozen=True)
class DirectionChosen:
    """How the object's axis lies."""

    direction: Direction


@dataclass(frozen=True)
class DiameterTyped:
    """The limits of the object's diameter, in either order; 0 is none."""

    from_mm: float
    to_mm: float


@dataclass(frozen=True)
class ContactPlaced:
    """Where a tool is to touch: turned about the axis from the camera's side, and along it from the middle."""

    angle_deg: float
    along_mm: float


@dataclass(frozen=True)
class SectionToggled:
    """A section of the second cut is taken out of the measurement, or put back."""

    section: int


@dataclass(frozen=True)
class SectionsRestored:
    """All sections that were taken out are put back."""


@dataclass(frozen=True)
class SettingTyped:
    """A setting, by its key in `app.adjustable`, is to have another value, in the units of the settings."""

    key: str
    value: float | str


@dataclass(frozen=True)
class UnitChosen:
    """Lengths are shown in another unit."""

    unit: Unit


@dataclass(frozen=True)
class FrameTaken:
    """The newer frame that waits is to be held from now on."""


@dataclass(frozen=True)
class Reconstructed:
    """A measurement has come back."""

    revision: int
    outcome: Reconstruction | Refused
    coarse: bool = False
    """On the depth of the whole frame, where that is to be matched again in the area, finely."""


DrawingEvent = (
    PointerDragged
    | VertexClicked
    | HandleMoved
    | PolygonClosed
    | VertexTakenBack
    | Cancelled
    | PageLeft
    | Cleared
    | Undone
    | Redone
    | ToolChosen
    | KindChosen
    | DirectionChosen
    | DiameterTyped
    | ContactPlaced
    | SectionToggled
    | SectionsRestored
    | FrameTaken
    | Reconstructed
)
"""What makes another drawing, or another result of it."""
Event = DrawingEvent | SettingTyped | UnitChosen

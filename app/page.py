"""What one page shows, which is nobody else's business: its view, zoom, layers and the section it looks at."""

from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Literal, get_args

from app.browsing import Browsed, Browsing, EntryChosen, ListFiltered, ListTurned, browse
from app.object_drawing import Pixel

ViewName = Literal["camera", "3D"]
LayerName = Literal["segmentation", "close pixels", "accepted pixels", "depth map", "model", "picture"]
OverlayName = Literal["nothing", "tool", "residuals"]
VIEWS: tuple[ViewName, ...] = get_args(ViewName)
LAYERS: tuple[LayerName, ...] = get_args(LayerName)
OVERLAYS: tuple[OverlayName, ...] = get_args(OverlayName)
ZOOM_STEP = 1.5
LARGEST_ZOOM = 16.0
"""A pixel is then as large as a fingertip."""


@dataclass(frozen=True)
class PageState:
    """The choices made on one page."""

    view: ViewName = "camera"
    depth_opacity: float = 0.0
    layer: LayerName = "segmentation"
    zoom: float = 1.0
    last_point_px: Pixel | None = None
    """Where the pointer last did something: the crop's middle, and what zooming goes for without an area."""
    center_px: Pixel | None = None
    """What the zoomed view looks at; None for the middle of the picture."""
    section: int | None = None
    """The section looked at; None for the one in the middle."""
    dark: bool = True
    overlay: OverlayName = "nothing"
    """What is drawn over the picture besides outline and section."""
    step: int = 0
    """The step of the segmentation that is looked at."""
    measuring: bool = False
    """Whether clicks on the picture are the ends of a distance, and not corners of an area."""
    ends_px: tuple[Pixel, ...] = ()
    """Of that distance: none, one or two."""
    tour: int | None = None
    """How many stations of the tour are ticked off; None when it is closed."""
    browsing: Browsing = field(default_factory=Browsing)
    """What is looked at of the record."""


@dataclass(frozen=True)
class ViewChosen:
    view: ViewName


@dataclass(frozen=True)
class OpacityChosen:
    opacity: float


@dataclass(frozen=True)
class LayerChosen:
    layer: LayerName


@dataclass(frozen=True)
class Zoomed:
    """In by a number of steps, out by a negative one, or back to the whole picture by None."""

    steps: int | None


@dataclass(frozen=True)
class PointTouched:
    point_px: Pixel


@dataclass(frozen=True)
class SectionChosen:
    section: int


@dataclass(frozen=True)
class SectionPointed:
    """A place on the object was clicked, to see the section there: a sight line in base coordinates."""

    origin_m: tuple[float, float, float]
    direction: tuple[float, float, float]


@dataclass(frozen=True)
class SectionStepped:
    by: int


@dataclass(frozen=True)
class DarkChosen:
    dark: bool


@dataclass(frozen=True)
class OverlayChosen:
    overlay: OverlayName


@dataclass(frozen=True)
class StepChosen:
    step: int


@dataclass(frozen=True)
class MeasuringChosen:
    measuring: bool


@dataclass(frozen=True)
class EndPointed:
    """An end of a distance: the first of a new one when there were two."""

    point_px: Pixel


@dataclass(frozen=True)
class TourStarted:
    """From its first station on."""


@dataclass(frozen=True)
class TourClosed:
    """For good, unless it is started again."""


PageEvent = (
    ViewChosen
    | OpacityChosen
    | LayerChosen
    | Zoomed
    | PointTouched
    | SectionChosen
    | SectionPointed
    | SectionStepped
    | DarkChosen
    | OverlayChosen
    | StepChosen
    | MeasuringChosen
    | EndPointed
    | TourStarted
    | TourClosed
    | Browsed
)


def page_step(page: PageState, event: PageEvent, section_count: int, middle_px: Pixel | None = None) -> PageState:
    """The page after an event; values a page could not have sent by its controls change nothing.

    `middle_px` is that of the drawn area, which zooming goes for.
    """
    match event:
        case ViewChosen(view) if view in VIEWS:
            return replace(page, view=view)
        case OpacityChosen(opacity) if isfinite(opacity):
            return replace(page, depth_opacity=min(max(opacity, 0.0), 1.0))
        case LayerChosen(layer) if layer in LAYERS:
            return replace(page, layer=layer)
        case Zoomed(steps):
            return _zoomed(page, steps, middle_px or page.last_point_px)
        case PointTouched(point) if all(isfinite(value) for value in point):
            return replace(page, last_point_px=point)
        case SectionChosen(section):
            return replace(page, section=_within(section, section_count))
        case SectionStepped(by):
            return replace(page, section=_within(section_shown(page, section_count) + by, section_count))
        case DarkChosen(dark):
            return replace(page, dark=dark)
        case OverlayChosen(overlay) if overlay in OVERLAYS:
            return replace(page, overlay=overlay)
        case StepChosen(step):
            return replace(page, step=max(step, 0))
        case MeasuringChosen(measuring):
            return replace(page, measuring=bool(measuring), ends_px=())
        case TourStarted():
            return replace(page, tour=0, section=None)
        case TourClosed():
            return replace(page, tour=None)
        case EndPointed(point) if page.measuring and all(isfinite(value) for value in point):
            return replace(page, ends_px=(point,) if len(page.ends_px) == 2 else (*page.ends_px, point))
        case ListFiltered() | ListTurned() | EntryChosen():
            return replace(page, browsing=browse(page.browsing, event))
        case _:
            return page


def section_shown(page: PageState, section_count: int) -> int:
    """Number of the section that is looked at, of so many."""
    return _within(section_count // 2 if page.section is None else page.section, section_count)


def _zoomed(page: PageState, steps: int | None, target_px: Pixel | None) -> PageState:
    zoom = 1.0 if steps is None else min(max(page.zoom * ZOOM_STEP**steps, 1.0), LARGEST_ZOOM)
    return replace(page, zoom=zoom, center_px=None if zoom == 1.0 else target_px)


def _within(section: int, count: int) -> int:
    return min(max(section, 0), max(count - 1, 0))

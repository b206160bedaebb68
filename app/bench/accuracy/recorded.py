"""Recorded scenes beside what is known of them."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from app.drawing_text import parse_area, parse_axis
from rotrecon.answer import answer
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.reconstruct import reconstruct
from rotrecon.scene.importing import import_scene
from rotrecon.scene.reading import read_scene
from rotrecon.settings import Method, Settings

Answer = dict[str, Any]


@dataclass(frozen=True)
class Recording:
    """A scene, its drawing, and what is known of its object."""

    name: str
    area: str
    axis: str
    known: str
    agrees: Callable[[Answer], bool]
    """Whether an answer that is not a refusal agrees with what is known."""
    width_px: float
    """Of the object in the picture, across the stroke."""
    bag: str | None = None
    """File inside the folder, where that is no scene."""

    @property
    def drawing(self) -> Drawing:
        """As it was drawn by hand."""
        return Drawing(parse_area(self.area), parse_axis(self.axis))


def _diameter_within(low_mm: float, high_mm: float) -> Callable[[Answer], bool]:
    return lambda said: low_mm <= said["diameter_mm"] <= high_mm


def _half_angle_within(low_deg: float, high_deg: float) -> Callable[[Answer], bool]:
    def agrees(said: Answer) -> bool:
        angle = said["half_angle_deg"]
        return said["kind"] in ("cone", "revolution") and angle is not None and low_deg <= abs(angle) <= high_deg

    return agrees


def _interval_holds(diameter_mm: float) -> Callable[[Answer], bool]:
    def agrees(said: Answer) -> bool:
        interval = said["interval_mm"]
        return interval is not None and interval[0] <= diameter_mm <= interval[1]

    return agrees


def _concave_within(low_mm: float, high_mm: float) -> Callable[[Answer], bool]:
    return lambda said: said["concave"] and low_mm <= said["diameter_mm"] <= high_mm


RECORDINGS = (
    Recording("tin", "270,50 380,232", "325,75 325,222", "65 to 69 mm", _diameter_within(65, 69), 76),
    Recording("pr2_mug", "330,280 450,390", "388,300 388,378", "76 to 83 mm", _diameter_within(76, 83), 85),
    Recording(
        "blue_mug",
        "275,200 380,318",
        "328,205 328,310",
        "cone, half angle 6 to 8.5 deg",
        _half_angle_within(6, 8.5),
        75,
    ),
    Recording(
        "green_bowl",
        "255,250 400,335",
        "325,275 325,315",
        "cone, half angle 30 to 36 deg",
        _half_angle_within(30, 36),
        110,
    ),
    Recording(
        "ros1_can",
        "255,275 320,370",
        "287,285 287,358",
        "an interval that holds 52.5 mm",
        _interval_holds(52.5),
        38,
        "perception_tutorial.bag",
    ),
    Recording(
        "concrete_pipe",
        "300,300 620,470",
        "460,460 460,320",
        "concave, 195 mm within 3 %",
        _concave_within(195 * 0.97, 195 * 1.03),
        320,
    ),
)
PR2_MUG = RECORDINGS[1]
PR2_MUG_BODY = "345,280 430,390"
"""Its area from limb to limb."""
PR2_MUG_MARGIN = "355,280 420,390"
"""The same less 10 px at each limb."""


def read_recording(recording: Recording, folder: Path) -> Frame:
    """The frame of a recording in a folder of them; raises SceneError."""
    place = folder / recording.name
    if recording.bag is None:
        frame = read_scene(place).frame()
    else:
        with TemporaryDirectory() as scratch:
            import_scene(place / recording.bag, Path(scratch) / recording.name)
            frame = read_scene(Path(scratch) / recording.name).frame()
    assert isinstance(frame, Frame), frame
    return frame


def said_of(frame: Frame, drawing: Drawing, method: Method) -> Answer:
    """The answer as the command prints it."""
    return answer(reconstruct(frame, drawing, Settings(method=method)))

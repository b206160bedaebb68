"""The paper's method on recorded scenes: sizes are those it gave when it was seen to work, not the truth."""

import pytest

from app.drawing_text import parse_area, parse_axis
from rotrecon.answer import answer
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame, FrameUnavailable
from rotrecon.reconstruct import reconstruct
from rotrecon.scene.importing import import_scene
from rotrecon.scene.reading import read_scene
from rotrecon.settings import Settings
from tests.recordings import recording

DRAWINGS = {
    "tin": ("270,50 380,232", "325,75 325,222"),
    "blue_mug": ("275,200 380,318", "328,205 328,310"),
    "green_bowl": ("255,250 400,335", "325,275 325,315"),
    "pr2_mug": ("330,280 450,390", "388,300 388,378"),
    "concrete_pipe": ("300,300 620,470", "460,460 460,320"),
}


def measure(frame: Frame, name: str):
    area, axis = DRAWINGS[name]
    return answer(reconstruct(frame, Drawing(parse_area(area), parse_axis(axis)), Settings()))


def frame_of(name: str) -> Frame:
    frame = read_scene(recording(name)).frame()
    assert isinstance(frame, Frame)
    return frame


@pytest.mark.parametrize(
    ("name", "kind", "low_mm", "high_mm"),
    [
        ("tin", "cylinder", 65, 80),
        ("blue_mug", "cone", 60, 95),
        ("pr2_mug", "cylinder", 74, 95),
    ],
)
def test_recorded_object_is_recognised(name, kind, low_mm, high_mm):
    content = measure(frame_of(name), name)
    assert content["kind"] == kind
    assert low_mm < content["diameter_mm"] < high_mm
    assert not content["concave"]


def test_bowl_that_flares_along_the_sight_lines_is_refused_with_advice():
    """Pixel lines cut its wall in flat conics: the paper's method cannot hold it, and says so."""
    content = measure(frame_of("green_bowl"), "green_bowl")
    assert content["kind"] is None
    assert "draw" in content["reasons"][0]


def test_inside_of_a_pipe_never_gets_a_tool():
    assert measure(frame_of("concrete_pipe"), "concrete_pipe")["tool"] is None


def test_imported_can_is_a_cylinder(tmp_path):
    import_scene(recording("ros1_can") / "perception_tutorial.bag", tmp_path / "can")
    frame = read_scene(tmp_path / "can").frame()
    assert isinstance(frame, Frame)
    drawing = Drawing(parse_area("255,275 320,370"), parse_axis("287,285 287,358"))
    content = answer(reconstruct(frame, drawing, Settings()))
    assert content["kind"] == "cylinder"
    assert 45 < content["diameter_mm"] < 75
    assert content["tool"] is None, "its pixels lie too far off for a tool to rely on it"
    assert "doubtful" in content["reasons"][0]


def test_views_answer_that_they_need_matching():
    frame = read_scene(recording("virtual_stereo")).frame()
    assert isinstance(frame, FrameUnavailable)
    assert "needs stereo matching" in frame.reason

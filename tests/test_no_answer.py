"""Where nothing is round, nothing certain is answered: flat, boxy, cluttered and empty areas."""

from typing import Any

import pytest

from app.bench.accuracy.unanswerable import AREAS, ERRORS, SIMULATED, Area
from rotrecon.answer import answer
from rotrecon.drawing import DrawingError
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from rotrecon.simulation.distractors import SMALL_CAMERA
from rotrecon.simulation.simulate import simulate
from rotrecon.simulation.stereo_noise import StereoErrors
from tests.recordings import DATA, recording

NO_DEPTH = {"hole", "no depth"}
MAY_HAVE_NONE = NO_DEPTH | {"few pixels"}


def ask(area: Area) -> dict[str, Any] | None:
    """The answer, or None where the drawing itself is refused."""
    if area.source != SIMULATED:
        recording(area.source)
    frame, drawing = area.load(DATA)
    try:
        return answer(reconstruct(frame, drawing, Settings()))
    except DrawingError:
        return None


@pytest.mark.parametrize("area", AREAS, ids=str)
def test_no_certain_answer_where_nothing_is_round(area: Area) -> None:
    content = ask(area)
    if content is None:
        assert area.kind in MAY_HAVE_NONE
        return
    assert area.kind not in NO_DEPTH
    assert content["certain"] is False, content
    assert content["reasons"] or content["tool"], "an answer that names no tool says why"


@pytest.mark.parametrize("errors", ERRORS, ids=["exact", "white", "stereo"])
@pytest.mark.parametrize("name", ["ball", "pipe", "cone"])
def test_what_is_round_is_answered_with_certainty_by_the_same_settings(name: str, errors: StereoErrors | None) -> None:
    scene = simulate(name, 0, SMALL_CAMERA, errors, supersampling=1)
    assert answer(reconstruct(scene.frame, scene.drawing, Settings()))["certain"] is True


def test_the_areas_are_many_and_different() -> None:
    assert len(set(AREAS)) == len(AREAS) >= 200
    assert sum(area.source != SIMULATED for area in AREAS) >= 60

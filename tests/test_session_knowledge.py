"""An area alone is measured about a proposed axis, and what is known of the object goes into the measurement."""

from dataclasses import replace
from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.events import (
    Cleared,
    DiameterTyped,
    DirectionChosen,
    HandleMoved,
    KindChosen,
    PointerDragged,
    Reconstructed,
    Redone,
    Refused,
    Undone,
)
from app.hints import hint, warning
from app.knowledge import knowledge_text
from app.measuring import measure
from app.session import Session, step
from rotrecon.outcome import Fit
from rotrecon.primitives import Frustum
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated, simulate
from tests.test_session import AREA, AXIS, EMPTY, after

REFUSED = Refused("nothing in the area stands out; draw the axis along the object by hand")
diameters = st.sampled_from([0.0, 6.0, 67.0, 103.5])


@pytest.fixture(scope="module")
def scene() -> Simulated:
    return simulate("pipe", 0, noise=None)


@pytest.fixture(scope="module")
def area(scene: Simulated) -> PointerDragged:
    columns, rows = zip(*scene.drawing.area.vertices_px, strict=True)
    return PointerDragged((min(columns), min(rows)), (max(columns), max(rows)))


@pytest.fixture(scope="module")
def proposed(scene: Simulated, area: PointerDragged) -> Reconstruction:
    drawing = step(EMPTY, area).shown.complete
    assert drawing is not None
    result = measure(scene.frame, drawing, Settings())
    assert isinstance(result, Reconstruction)
    return result


def told(session: Session, outcome: Reconstruction | Refused) -> Session:
    return step(session, Reconstructed(session.revision, outcome))


def test_an_area_alone_is_measured_and_its_proposed_axis_becomes_part_of_the_drawing(
    area: PointerDragged, proposed: Reconstruction
) -> None:
    session = told(step(EMPTY, area), proposed)
    assert isinstance(proposed.fit, Fit)
    assert session.shown.axis == proposed.drawing.axis
    assert session.shown.complete == proposed.drawing, "what is shown is what was measured"
    assert session.up_to_date
    assert session.reconstruction is proposed
    assert "proposed" in hint(session)
    assert not told(step(session, AXIS), proposed).shown.proposed
    assert not told(step(session, HandleMoved("axis", 0, (200.0, 200.0))), proposed).shown.proposed


def test_a_proposed_axis_is_undone_and_made_again_with_its_area(area: PointerDragged, proposed: Reconstruction) -> None:
    session = told(step(EMPTY, area), proposed)
    undone = step(session, Undone())
    assert undone.shown == EMPTY.shown
    assert undone.measured is None
    assert step(undone, Redone()).shown == session.shown


def test_a_drag_shows_no_proposal_before_it_has_ended(area: PointerDragged, proposed: Reconstruction) -> None:
    dragging = told(step(EMPTY, replace(area, finished=False)), proposed)
    assert dragging.shown.axis is None
    assert dragging.reconstruction is proposed
    ended = step(dragging, area)
    assert ended.shown.axis == proposed.drawing.axis
    assert ended.up_to_date, "it is not measured again"
    refused = told(step(EMPTY, AREA), REFUSED)
    again = told(step(refused, replace(area, finished=False)), proposed)
    assert again.objects == refused.objects, "nor is it that of the area before"


def test_a_proposed_axis_goes_with_its_area_and_a_drawn_one_stays(
    area: PointerDragged, proposed: Reconstruction
) -> None:
    session = told(step(EMPTY, area), proposed)
    (u0, v0), (u1, v1) = area.start_px, area.end_px
    mine = step(session, HandleMoved("axis", 0, ((u0 + u1) / 2, v0)))
    for event in (HandleMoved("area", 2, (u1 + 5, v1 + 5)), replace(area, end_px=(u1 + 5, v1 + 5))):
        assert step(session, event).shown.axis is None
        assert step(mine, event).shown.axis == mine.shown.axis
    assert step(session, KindChosen("rod")).shown.axis == session.shown.axis


def test_a_failed_proposal_is_a_hint_and_the_drawing_goes_on() -> None:
    session = told(step(EMPTY, AREA), REFUSED)
    assert session.notice is None
    assert session.shown.axis is None
    assert warning(session) == hint(session)
    assert "draw the axis along the object" in hint(session)
    assert hint(step(session, AXIS)).startswith("Measuring")
    assert told(step(session, AXIS), REFUSED).notice is not None


def test_what_is_known_goes_into_the_drawing_and_outlives_it() -> None:
    session = after(AREA, AXIS, DirectionChosen("vertical"), DiameterTyped(60.0, 70.0))
    drawing = session.shown.complete
    assert drawing is not None
    assert drawing.constraints.radius_m == (0.03, 0.035)
    assert drawing.constraints.direction == "vertical"
    assert knowledge_text(session.shown) == "vertical, 60 to 70 mm"
    cleared = step(session, Cleared())
    assert cleared.shown.constraints == drawing.constraints
    assert cleared.shown.area is None
    assert step(session, Undone()).shown.constraints.radius_m is None
    assert after(Undone(), Undone(), session=session).shown.direction == "free"


@pytest.mark.parametrize(
    ("typed", "radius_m", "text"),
    [
        ((0.0, 0.0), None, ""),
        ((67.0, 67.0), (0.0335, 0.0335), "67 mm"),
        ((60.0, 0.0), (0.03, inf), "60 or more mm"),
        ((0.0, 60.0), (0.0, 0.03), "up to 60 mm"),
        ((60.0, 7.0), (0.0035, 0.03), "7 to 60 mm"),
    ],
)
def test_typed_limits_never_contradict_each_other(
    typed: tuple[float, float], radius_m: tuple[float, float] | None, text: str
) -> None:
    drawn = step(EMPTY, DiameterTyped(*typed)).shown
    assert drawn.diameter_mm == typed, "fields keep what was typed"
    assert drawn.constraints.radius_m == radius_m
    assert knowledge_text(drawn) == text


@given(st.lists(st.builds(DiameterTyped, diameters, diameters), min_size=1, max_size=6))
def test_digits_are_undone_together_and_nothing_else_with_them(typed: list[DiameterTyped]) -> None:
    drawn = after(AREA, AXIS)
    session = after(*typed, session=drawn)
    assert session.shown.diameter_mm == (typed[-1].from_mm, typed[-1].to_mm)
    if session.objects != drawn.objects:
        undone = step(session, Undone())
        assert undone.objects == drawn.objects
        assert step(undone, Redone()).objects == session.objects


@pytest.mark.parametrize(("typed", "diameter_mm"), [((100.1, 100.1), 100.1), ((60.0, 0.0), 100), ((0.0, 160.0), 100)])
def test_what_is_known_is_obeyed(scene: Simulated, typed: tuple[float, float], diameter_mm: float) -> None:
    constraints = step(EMPTY, DiameterTyped(*typed)).shown.constraints
    result = measure(scene.frame, replace(scene.drawing, constraints=constraints), Settings())
    assert isinstance(result, Reconstruction)
    assert isinstance(result.solid, Frustum)
    assert 2000 * result.solid.radius_m == pytest.approx(diameter_mm, abs=0.05)

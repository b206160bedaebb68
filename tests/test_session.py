"""Laws of the session: nothing raises, what is undone comes back, and nothing stale or off the frame gets in."""

from dataclasses import replace
from math import inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.drawing_steps import HISTORY_LENGTH
from app.events import (
    Cancelled,
    Cleared,
    DiameterTyped,
    DirectionChosen,
    Event,
    HandleMoved,
    KindChosen,
    PageLeft,
    PointerDragged,
    PolygonClosed,
    Reconstructed,
    Redone,
    Refused,
    SectionsRestored,
    SectionToggled,
    ToolChosen,
    Undone,
    VertexClicked,
    VertexTakenBack,
)
from app.hints import hint
from app.object_drawing import Pixel
from app.session import Session, sentence, step
from rotrecon.drawing import AreaOfInterest, Drawing, DrawingError, ObjectAxis, check_area

SIZE_PX = (640, 480)
EMPTY = Session(SIZE_PX)

coordinates = st.floats(-1000, 2000) | st.sampled_from([float("nan"), float("inf"), -float("inf")])
pixels = st.tuples(coordinates, coordinates)
indices = st.integers(-2, 8)
events: st.SearchStrategy[Event] = st.one_of(
    st.builds(PointerDragged, pixels, pixels, st.booleans(), st.booleans(), st.floats(0, 50)),
    st.builds(VertexClicked, pixels, st.floats(0, 50)),
    st.builds(HandleMoved, st.sampled_from(["area", "axis"]), indices, pixels, st.booleans()),
    st.builds(ToolChosen, st.sampled_from(["area", "axis", "nonsense"])),
    st.builds(KindChosen, st.sampled_from([None, "cylinder", "sphere", "nonsense"])),
    st.builds(DirectionChosen, st.sampled_from(["free", "vertical", "nonsense"])),
    st.builds(DiameterTyped, coordinates, coordinates),
    st.builds(SectionToggled, indices),
    st.builds(Reconstructed, st.integers(0, 30), st.just(Refused("the axis has no length"))),
    st.sampled_from(
        [PolygonClosed(), VertexTakenBack(), Cancelled(), PageLeft(), Cleared(), SectionsRestored(), Undone(), Redone()]
    ),
)
sequences = st.lists(events, max_size=30)


def after(*happened: Event, session: Session = EMPTY) -> Session:
    for event in happened:
        session = step(session, event)
    return session


AREA = PointerDragged((100.0, 100.0), (200.0, 300.0))
AXIS = PointerDragged((150.0, 120.0), (150.0, 280.0), shift=True)


@given(sequences)
def test_no_sequence_of_events_raises_or_leaves_the_frame(happened: list[Event]) -> None:
    session = after(*happened)
    assert hint(session)
    assert len(session.past) <= HISTORY_LENGTH
    for drawn in (*session.objects, session.shown):
        ends = () if drawn.axis is None else (drawn.axis.start_px, drawn.axis.end_px)
        for u, v in (*(drawn.area.vertices_px if drawn.area else ()), *ends, *session.vertices_px):
            assert 0 <= u <= SIZE_PX[0] - 1
            assert 0 <= v <= SIZE_PX[1] - 1
        assert drawn.kind in (None, "cylinder", "sphere")
        assert drawn.direction in ("free", "vertical")
        low_m, high_m = drawn.constraints.radius_m or (0.0, inf)
        assert 0 <= low_m <= high_m


@given(sequences, events)
def test_undo_restores_and_redo_repeats_whatever_changed_the_drawing(happened: list[Event], event: Event) -> None:
    before = after(*happened)
    changed = step(before, event)
    if changed.objects == before.objects or isinstance(event, Undone | Redone | DiameterTyped):
        return
    undone = step(replace(changed, vertices_px=()), Undone())
    assert undone.objects == before.objects
    assert step(undone, Redone()).objects == changed.objects


@given(sequences, events)
def test_the_revision_grows_exactly_when_what_is_shown_changes(happened: list[Event], event: Event) -> None:
    before = after(*happened)
    changed = step(before, event)
    assert changed.revision == before.revision + (changed.shown != before.shown)


@given(sequences, st.integers(-5, 60))
def test_a_measurement_counts_only_for_the_drawing_it_was_made_of(happened: list[Event], revision: int) -> None:
    session = after(*happened)
    told = step(session, Reconstructed(revision, Refused("news")))
    if revision != session.revision or session.shown.complete is None:
        assert told is session
    else:
        assert told.up_to_date
        assert told.measured is not None
        assert told.measured.outcome == Refused("news")


@given(sequences)
def test_an_open_drag_changes_nothing_that_escape_does_not_restore(happened: list[Event]) -> None:
    session = after(*happened, Cancelled())
    dragging = after(PointerDragged((10.0, 10.0), (90.0, 80.0), finished=False), session=session)
    assert dragging.objects == session.objects
    assert step(dragging, Cancelled()).shown == session.shown


drags = st.one_of(
    st.builds(PointerDragged, pixels, pixels, st.booleans(), st.just(False)),
    st.builds(HandleMoved, st.sampled_from(["area", "axis"]), indices, pixels, st.just(False)),
)


@given(sequences, drags, st.lists(drags, max_size=5), drags)
def test_a_cancelled_drag_draws_nothing_up_to_its_end(
    happened: list[Event], begun: PointerDragged | HandleMoved, moves: list[Event], last: PointerDragged | HandleMoved
) -> None:
    cancelled = after(*happened, PageLeft(), begun, Cancelled())
    ended = after(*moves, replace(last, finished=True), session=cancelled)
    assert ended == replace(cancelled, drag="none")
    assert step(ended, AXIS).shown.axis == step(EMPTY, AXIS).shown.axis, "the next one counts"


@given(sequences, drags)
def test_no_end_of_a_drag_leaves_it_running(happened: list[Event], last: PointerDragged | HandleMoved) -> None:
    ended = after(*happened, replace(last, finished=True))
    assert ended.drag == "none"
    assert ended.preview is None


def test_escape_without_a_drag_leaves_the_next_one_alone() -> None:
    assert after(Cancelled(), AREA).shown.area is not None
    dragging = after(replace(AREA, finished=False), PageLeft())
    assert dragging.preview is None
    assert step(dragging, AREA).shown.area is not None, "the page that began another drag is still there"


@settings(max_examples=30)
@given(st.lists(st.tuples(st.integers(0, 600), st.integers(0, 400)), min_size=3, max_size=9, unique=True))
def test_clicked_corners_become_the_area_when_the_polygon_is_closed(corners: list[Pixel]) -> None:
    session = after(*(VertexClicked(corner, reach_px=0) for corner in corners))
    assert session.shown.area is None
    assert session.vertices_px == tuple(corners)
    by_click = step(session, VertexClicked(corners[0], reach_px=0.5))
    by_key = step(session, PolygonClosed())
    assert by_click == by_key
    area = AreaOfInterest(tuple(corners))
    if by_click.notice is None:
        assert by_click.shown.area == area
        assert by_click.vertices_px == ()
    else:
        assert by_click.vertices_px == session.vertices_px, "it can be corrected"
        with pytest.raises(DrawingError) as refused:
            check_area(area, SIZE_PX)
        assert by_click.notice.text == sentence(str(refused.value))


def test_a_polygon_that_crosses_itself_is_refused_at_once_and_can_be_corrected() -> None:
    corners = [(10.0, 10.0), (200.0, 200.0), (200.0, 10.0), (10.0, 200.0)]
    refused = after(*map(VertexClicked, corners), PolygonClosed())
    assert refused.notice is not None
    assert "crosses" in refused.notice.text
    assert refused.notice.text in hint(refused)
    corrected = step(refused, VertexTakenBack())
    assert corrected.notice is None
    assert step(corrected, PolygonClosed()).shown.area == AreaOfInterest(tuple(corners[:3]))


def test_two_corners_do_not_close_and_backspace_takes_the_last_one_back() -> None:
    session = after(VertexClicked((10, 10)), VertexClicked((50, 10)))
    assert step(session, PolygonClosed()) == session
    assert step(session, VertexTakenBack()).vertices_px == ((10, 10),)
    assert step(session, Undone()).vertices_px == ((10, 10),)
    assert step(session, Cancelled()).vertices_px == ()


def test_while_a_polygon_is_open_a_plain_drag_is_a_corner_and_shift_draws_the_axis() -> None:
    begun = after(VertexClicked((10.0, 10.0)), VertexClicked((50.0, 10.0)))
    shaky = PointerDragged((49.0, 60.0), (50.0, 62.0))
    assert step(begun, shaky).vertices_px == ((10.0, 10.0), (50.0, 10.0), (50.0, 62.0))
    assert step(begun, AREA).vertices_px == ((10.0, 10.0), (50.0, 10.0), (200.0, 300.0))
    moving = step(begun, replace(AREA, finished=False))
    assert moving.shown == begun.shown
    assert moving.vertices_px == begun.vertices_px
    for session, axis in ((begun, AXIS), (step(begun, ToolChosen("axis")), replace(AXIS, shift=False))):
        drawn = step(session, axis)
        assert drawn.vertices_px == begun.vertices_px
        assert drawn.shown.axis == ObjectAxis(AXIS.start_px, AXIS.end_px)
        assert drawn.shown.area is None
        assert step(session, replace(shaky, shift=False)).vertices_px[2:] == ((50.0, 62.0),)
    closed = after(shaky, PointerDragged((12.0, 11.0), (13.0, 13.0)), session=begun)
    assert closed.shown.area == AreaOfInterest(((10.0, 10.0), (50.0, 10.0), (50.0, 62.0)))


def test_a_double_click_is_one_corner() -> None:
    session = after(*[VertexClicked((10.0, 10.0))] * 2, VertexClicked((50.0, 10.0)), VertexClicked((51.0, 12.0)))
    assert session.vertices_px == ((10.0, 10.0), (50.0, 10.0))
    closed = after(VertexClicked((50.0, 60.0)), *[VertexClicked((10.0, 10.0))] * 2, session=session)
    assert closed.shown.area is not None
    assert closed.vertices_px == (), "closed by a double click, no other polygon is begun"


def test_a_rectangle_and_a_stroke_make_a_drawing_that_can_be_measured() -> None:
    session = step(EMPTY, AREA)
    assert session.shown.complete == Drawing(AreaOfInterest.rectangle((100.0, 100.0), (200.0, 300.0))), "axis proposed"
    assert step(EMPTY, AXIS).shown.complete is None
    drawing = step(session, AXIS).shown.complete
    assert drawing is not None
    assert drawing.area == AreaOfInterest.rectangle((100.0, 100.0), (200.0, 300.0))
    assert drawing.axis == ObjectAxis((150.0, 120.0), (150.0, 280.0))


def test_with_the_axis_tool_a_plain_drag_draws_the_axis() -> None:
    assert step(step(EMPTY, ToolChosen("axis")), replace(AXIS, shift=False)).shown.axis is not None


def test_a_corner_of_a_rectangle_takes_its_neighbours_along() -> None:
    moved = after(AREA, HandleMoved("area", 2, (250.0, 350.0))).shown.area
    assert moved == AreaOfInterest.rectangle((100.0, 100.0), (250.0, 350.0))


@given(indices, pixels, pixels, pixels)
def test_a_rectangle_neither_collapses_nor_becomes_another_shape(
    index: int, start: Pixel, end: Pixel, point: Pixel
) -> None:
    area = after(PointerDragged(start, end), HandleMoved("area", index, point)).shown.area
    if area is not None:
        columns, rows = zip(*area.vertices_px, strict=True)
        assert area == AreaOfInterest.rectangle(area.vertices_px[0], area.vertices_px[2])
        assert min(max(columns) - min(columns), max(rows) - min(rows)) > 3.9


def test_a_corner_that_meets_its_neighbour_or_its_opposite_keeps_its_distance() -> None:
    onto_neighbour = after(AREA, HandleMoved("area", 2, (102.0, 300.0))).shown.area
    assert onto_neighbour == AreaOfInterest.rectangle((100.0, 100.0), (104.0, 300.0))
    onto_opposite = after(AREA, HandleMoved("area", 2, (99.0, 100.0))).shown.area
    assert onto_opposite == AreaOfInterest.rectangle((100.0, 100.0), (104.0, 104.0))


def test_a_dragged_area_too_small_to_be_meant_changes_nothing() -> None:
    drawn = after(AREA, AXIS)
    assert step(drawn, PointerDragged((300.0, 100.0), (302.0, 180.0))) == drawn
    begun = after(VertexClicked((10.0, 10.0)))
    assert step(begun, PointerDragged((300.0, 100.0), (301.0, 101.0))).vertices_px[0] == (10.0, 10.0)


def test_an_area_drawn_elsewhere_drops_the_axis_of_the_object_before() -> None:
    assert after(AREA, AXIS, PointerDragged((400.0, 100.0), (500.0, 300.0))).shown.axis is None
    assert after(AREA, AXIS, PointerDragged((90.0, 90.0), (220.0, 310.0))).shown.axis is not None

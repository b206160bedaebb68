"""What a drawing's events make of the session."""

from dataclasses import replace

from app.events import (
    Cancelled,
    Cleared,
    ContactPlaced,
    DiameterTyped,
    DirectionChosen,
    DrawingEvent,
    FrameTaken,
    HandleMoved,
    KindChosen,
    PageLeft,
    PointerDragged,
    PolygonClosed,
    Reconstructed,
    Redone,
    SectionsRestored,
    SectionToggled,
    ToolChosen,
    Undone,
    VertexClicked,
    VertexTakenBack,
)
from app.knowledge import with_knowledge
from app.newer_steps import taken
from app.object_drawing import (
    PARTS,
    SMALLEST_PX,
    ObjectDrawing,
    distance_px,
    on_frame,
    with_area,
    with_axis,
    with_corner,
    without_proposal,
)
from app.session_state import Drag, Measured, Notice, Session, sentence, with_selected
from rotrecon.drawing import AreaOfInterest, DrawingError, ObjectAxis, check_area

HISTORY_LENGTH = 200
"""Steps that can be undone: more than a person remembers, few enough to keep."""


def drawn_on(session: Session, event: DrawingEvent) -> Session:
    """The session after an event; one that makes no sense leaves it as it is."""
    match event:
        case PointerDragged() | HandleMoved() if session.drag == "cancelled":
            return replace(session, drag="none" if event.finished else "cancelled")
        case PointerDragged():
            return _dragged(_dragging(session, event.finished), event)
        case VertexClicked():
            return _clicked(session, event)
        case HandleMoved():
            return _handle_moved(_dragging(session, event.finished), event)
        case PolygonClosed():
            return _closed(session)
        case VertexTakenBack():
            return replace(session, vertices_px=session.vertices_px[:-1])
        case Cancelled():
            drag: Drag = "none" if session.drag == "none" else "cancelled"
            return replace(session, drag=drag, preview=None, vertices_px=())
        case PageLeft():
            return replace(session, drag="none", preview=None)
        case Cleared():
            kept = replace(session.objects[session.selected], area=None, axis=None, proposed=False)
            return _changed(replace(session, vertices_px=()), replace(kept, excluded_sections=frozenset()))
        case Undone():
            return _undone(session)
        case Redone():
            return _redone(session)
        case ToolChosen():
            return replace(session, tool=event.tool) if event.tool in PARTS else session
        case KindChosen() | DirectionChosen():
            return _changed(session, with_knowledge(session.objects[session.selected], event))
        case DiameterTyped() | ContactPlaced():
            return _typed(session, event)
        case SectionToggled():
            return _section_toggled(session, event.section)
        case SectionsRestored():
            return _changed(session, replace(session.objects[session.selected], excluded_sections=frozenset()))
        case FrameTaken():
            return taken(session)
        case Reconstructed():
            return _reconstructed(session, event)


def _dragging(session: Session, finished: bool) -> Session:
    """The session in a drag, of which an end leaves nothing, wherever it is."""
    return replace(session, drag="none", preview=None) if finished else replace(session, drag="running")


def _dragged(session: Session, event: PointerDragged) -> Session:
    start, end = on_frame(event.start_px, session.size_px), on_frame(event.end_px, session.size_px)
    if start is None or end is None:
        return session
    is_axis = event.shift or session.tool == "axis"
    if session.vertices_px and not event.shift and (not is_axis or distance_px(start, end) <= event.reach_px):
        session = replace(session, preview=None)
        return _clicked(session, VertexClicked(end, event.reach_px)) if event.finished else session
    drawn = replace(session.objects[session.selected], excluded_sections=frozenset())
    if is_axis:
        drawn = with_axis(drawn, ObjectAxis(start, end))
    else:
        if min(abs(a - b) for a, b in zip(start, end, strict=True)) < SMALLEST_PX:
            return replace(session, preview=None)
        drawn = with_area(drawn, AreaOfInterest.rectangle(start, end))
    return _drawn(session, drawn, event.finished)


def _clicked(session: Session, event: VertexClicked) -> Session:
    point = on_frame(event.point_px, session.size_px)
    if point is None:
        return session
    vertices = session.vertices_px
    if len(vertices) >= 3 and distance_px(point, vertices[0]) <= event.reach_px:
        return _closed(session)
    area = session.shown.area
    doubled = vertices[-1:] if vertices or area is None else area.vertices_px
    if any(distance_px(point, corner) <= event.reach_px for corner in doubled):
        return session
    return replace(session, vertices_px=(*vertices, point))


def _closed(session: Session) -> Session:
    if len(session.vertices_px) < 3:
        return session
    area = AreaOfInterest(session.vertices_px)
    try:
        check_area(area, session.size_px)
    except DrawingError as error:
        return replace(session, notice=Notice(session.revision, "This polygon cannot be closed", sentence(str(error))))
    drawn = replace(session.objects[session.selected], excluded_sections=frozenset())
    return _changed(replace(session, vertices_px=()), with_area(drawn, area))


def _handle_moved(session: Session, event: HandleMoved) -> Session:
    point, drawn = on_frame(event.point_px, session.size_px), session.objects[session.selected]
    if point is None:
        return session
    drawn = replace(drawn, excluded_sections=frozenset())
    if event.part == "axis" and drawn.axis is not None and event.index in (0, 1):
        ends = (point, drawn.axis.end_px) if event.index == 0 else (drawn.axis.start_px, point)
        return _drawn(session, with_axis(drawn, ObjectAxis(*ends)), event.finished)
    if event.part == "area" and drawn.area is not None and 0 <= event.index < len(drawn.area.vertices_px):
        area = with_corner(drawn.area, event.index, point)
        return _drawn(session, replace(without_proposal(drawn), area=area), event.finished)
    return session


def _undone(session: Session) -> Session:
    if session.vertices_px:
        return replace(session, vertices_px=session.vertices_px[:-1])
    if not session.past:
        return session
    future = (session.objects, *session.future)
    return replace(session, objects=session.past[-1], past=session.past[:-1], future=future, preview=None)


def _redone(session: Session) -> Session:
    if not session.future:
        return session
    past = (*session.past, session.objects)
    return replace(session, objects=session.future[0], past=past, future=session.future[1:], preview=None)


def _section_toggled(session: Session, section: int) -> Session:
    result = session.reconstruction
    if result is None or result.second_cut is None or not session.up_to_date:
        return session
    if not 0 <= section < len(result.second_cut.circles.state):
        return session
    drawn = session.objects[session.selected]
    return _changed(session, replace(drawn, excluded_sections=drawn.excluded_sections ^ {section}))


def _reconstructed(session: Session, event: Reconstructed) -> Session:
    if event.revision != session.revision or session.shown.complete is None:
        return session
    return replace(session, measured=Measured(event.revision, event.outcome, event.coarse))


def _drawn(session: Session, drawn: ObjectDrawing, finished: bool) -> Session:
    """A drag's outcome: only shown while it lasts, part of the drawing when it has ended."""
    return _changed(session, drawn) if finished else replace(session, preview=drawn)


def _changed(session: Session, drawn: ObjectDrawing) -> Session:
    """The session with the selected object drawn anew, which can be undone."""
    objects = with_selected(session, drawn)
    if objects == session.objects:
        return replace(session, preview=None)
    past = (*session.past, session.objects)[-HISTORY_LENGTH:]
    return replace(session, objects=objects, past=past, future=(), preview=None)


def _typed(session: Session, event: DiameterTyped | ContactPlaced) -> Session:
    """The session with another diameter; its digits, one event each, are undone together."""
    drawn = session.objects[session.selected]
    typed = with_knowledge(drawn, event)
    if typed == drawn:
        return session
    if session.past:
        before = session.past[-1]
        is_contact = isinstance(event, ContactPlaced)
        same = {"contact": drawn.contact} if is_contact else {"diameter_mm": drawn.diameter_mm}
        last = replace(before[session.selected], **same)
        if (*before[: session.selected], last, *before[session.selected + 1 :]) == session.objects:
            session = replace(session, objects=before, past=session.past[:-1])
    return _changed(session, typed)

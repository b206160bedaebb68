"""The tools beside an object: in words, what is in the way of one, where it is free, and what is then decided on."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from app.decided import decision_of
from app.deciding.events import Offered, OverrideTyped
from app.events import ContactPlaced, PointerDragged, Reconstructed, Undone
from app.hints import warning
from app.inspection import grasp_in
from app.pictures import Pictures
from app.proposing import Evidence, offered
from app.session import Measured, Session, step
from app.tool_panel import limits_mm
from app.tool_text import free_instead, next_view_html, place_html, tools_html, way
from rotrecon.camera import inverse, transform
from rotrecon.contact import MOST_ANGLE_RAD, PROPOSED, Place
from rotrecon.grasp_overlay import HIT_COLOR, with_grasp
from rotrecon.next_view import ViewFrom
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import Simulated
from rotrecon.tools import NoTool, ToolProposal
from rotrecon.workspace import Workspace
from tests.deciding.desk import ANN, Table
from tests.legs import leg, measured_leg, session_of

SECTION = 60


@pytest.fixture(scope="module")
def scene() -> Simulated:
    return leg()


@pytest.fixture(scope="module")
def result() -> Reconstruction:
    return measured_leg()


@pytest.fixture(scope="module")
def session(result: Reconstruction) -> Session:
    return session_of(result)


def test_tools_and_the_next_view_in_words(result: Reconstruction) -> None:
    html = tools_html(result)
    assert 'data-tool="mechanical cutter" data-verdict="fits"' in html
    assert html.count('data-verdict="ruled out"') == 2
    assert "free in its 180 mm" in html
    assert 'data-clear="true"' in place_html(result)
    said = next_view_html(result)
    assert "nearer" in said
    assert "instead of ±" in said
    for text in (tools_html(None), place_html(None), next_view_html(None)):
        assert "None" not in text
    assert "None" not in html + said


def test_a_tool_that_would_hit_something_is_said_in_the_hint(session: Session, result: Reconstruction) -> None:
    assert warning(session) is None
    grasp = grasp_in(result)
    assert grasp is not None
    hit = with_point_in_jaw(result)
    told = warning(step(replace(session, measured=None), Reconstructed(session.revision, hit)))
    assert told is not None
    assert told.startswith("At the object it would hit 1 point of the cloud, the nearest ")
    assert_blocked_until_overridden(hit)
    assert 'data-clear="false"' in place_html(hit)
    assert (with_grasp(hit.frame.image, grasp_in(hit) or grasp, hit.frame)[3, 4] == HIT_COLOR).all()
    short = replace(result, frame=replace(result.frame, workspace=Workspace(reach_m=(0.0, 0.2))))
    told = warning(step(replace(session, measured=None), Reconstructed(session.revision, short)))
    assert told is not None
    assert "Out of reach: the contact is" in told


def test_the_nearest_free_contact_is_offered_and_has_to_be_decided_on_anew(
    session: Session, result: Reconstruction
) -> None:
    assert free_instead(result) is None, "it is free where it is"
    hit = with_point_in_jaw(result)
    place = free_instead(hit)
    assert place is not None
    said = f"The nearest free contact is {1000 * place.along_m:+.0f} mm along the axis."
    assert said in place_html(hit)
    before = offered(Evidence(0, hit.drawing, hit.settings, hit), "Ann")
    assert isinstance(before, Offered)
    assert said in before.offer.in_the_way["mechanical cutter"]

    moved = step(session, ContactPlaced(np.rad2deg(place.angle_rad), 1000 * place.along_m))
    assert moved.revision > session.revision
    drawing = moved.shown.complete
    assert drawing is not None
    anew = reconstruct(hit.frame, drawing, hit.settings)
    assert free_instead(anew) is None
    after = offered(Evidence(0, anew.drawing, anew.settings, anew), "Ann")
    assert isinstance(after, Offered)
    assert not after.offer.in_the_way
    assert after.offer.digest != before.offer.digest

    short = replace(result, frame=replace(result.frame, workspace=Workspace(reach_m=(0.0, 0.2))))
    assert "No contact along the axis is free" in place_html(short)


def with_point_in_jaw(result: Reconstruction) -> Reconstruction:
    """The same with one more point in the cloud, in the way of the tool that is proposed."""
    grasp = grasp_in(result)
    assert grasp is not None
    cloud = result.frame.points_m.copy()
    cloud[3, 4] = transform(inverse(result.frame.T_base_camera), grasp.envelope.jaws[0].center_m)
    return replace(result, frame=replace(result.frame, points_m=cloud))


def assert_blocked_until_overridden(hit: Reconstruction) -> None:
    """What is proposed of it cannot be armed, as it says why; the record has it too."""
    event = offered(Evidence(0, hit.drawing, hit.settings, hit), "Ann")
    assert isinstance(event, Offered)
    assert event.offer.tool == "mechanical cutter"
    why, free = event.offer.in_the_way["mechanical cutter"]
    assert why.startswith("At the object it would hit 1 point of the cloud")
    assert f"{why} {free}" in event.entry.payload["in_the_way"]
    table = Table(offer=event.offer)
    table.arm()
    assert table.said_to(ANN) == why


def test_a_tool_chosen_against_the_answer_is_the_one_that_is_shown(session: Session, result: Reconstruction) -> None:
    _, clipper, _ = result.settings.tools
    table = Table()
    assert replace(session, decision=table.deciding).overriding is None
    table.do(OverrideTyped(table.now, ANN, table.number, "clipper", "the cutter is blunt today"))
    assert replace(session, decision=table.deciding).overriding == clipper
    assert "clipper, which is not proposed," in place_html(result, clipper)
    none = replace(result, tool=NoTool(("no tool fits",)))
    told = decision_of(replace(session, measured=Measured(0, none), decision=table.deciding))
    assert told.T_base_contact is not None
    assert isinstance(result.tool, ToolProposal)
    assert np.allclose(told.T_base_contact[:3, 3], result.tool.contact_point_m), (
        "wherever the program has proposed none"
    )
    pictures = Pictures(result.frame)
    shown, other = (pictures.camera_view(result, 0.0, SECTION, "tool", tool) for tool in (None, clipper))
    assert (shown != other).any()


def test_a_contact_can_be_typed_as_far_as_the_object_goes(result: Reconstruction) -> None:
    low, high = limits_mm(result)
    assert low is not None
    assert high is not None
    assert result.solid is not None
    assert -low == high == pytest.approx(1000 * min(-result.solid.ends[0], result.solid.ends[1]))
    assert limits_mm(None) == (None, None)


def test_a_way_in_words() -> None:
    view = ViewFrom(np.eye(4), np.deg2rad(-30.0), 0.8, 0.6, "left", 0.001)
    assert way(view) == "20 % nearer and 30 degrees round the axis to the left"
    assert way(replace(view, toward="up", nearness=1.25)) == "25 % farther away and 30 degrees round the axis up"
    assert way(replace(view, angle_rad=0.0, nearness=1.0, toward="")) == "as now"


def test_a_tool_that_is_not_sure_names_the_view_that_would_settle_it(scene: Simulated) -> None:
    (cutter, *_) = Settings().tools
    diameter_mm = (10.0, scene.diameter_mm)
    limited = msgspec.structs.replace(cutter, diameter_mm=diameter_mm)
    html = tools_html(reconstruct(scene.frame, scene.drawing, Settings(tools=(limited,))))
    assert 'data-verdict="not sure"' in html
    assert "look at it from nearer" in html
    assert 'data-testid="settles">Go ' in html


def test_a_contact_is_placed_undone_and_part_of_what_is_decided(
    session: Session, scene: Simulated, result: Reconstruction
) -> None:
    placed = step(step(session, ContactPlaced(30.0, 0.0)), ContactPlaced(30.0, 20.0))
    assert placed.shown.contact == Place(np.deg2rad(30.0), 0.02)
    assert placed.revision > session.revision, "the proposal was for another place"
    assert not placed.up_to_date
    assert step(placed, Undone()).shown.contact == PROPOSED, "one undoing for both numbers"
    assert step(session, ContactPlaced(float("nan"), 0.0)) == session
    assert step(session, ContactPlaced(500.0, 0.0)).shown.contact.angle_rad == MOST_ANGLE_RAD
    anew = step(placed, PointerDragged((10.0, 10.0), (100.0, 100.0)))
    assert anew.shown.contact == PROPOSED, "another area is another object"
    drawing = placed.shown.complete
    assert drawing is not None
    moved = reconstruct(scene.frame, drawing, Settings(layers=3))
    assert_recorded_and_served_there(moved, result)
    assert isinstance(moved.tool, ToolProposal)
    assert isinstance(result.tool, ToolProposal)
    assert moved.tool.approach @ result.tool.approach == pytest.approx(np.cos(np.deg2rad(30.0)))
    assert "turned by 30" in place_html(moved)


def assert_recorded_and_served_there(moved: Reconstruction, result: Reconstruction) -> None:
    """The place that was chosen is in the digest, in the record and in what the robot is told."""
    before, after = (offered(Evidence(0, one.drawing, one.settings, one), "Ann") for one in (result, moved))
    assert isinstance(before, Offered)
    assert isinstance(after, Offered)
    assert before.offer.digest != after.offer.digest
    table = Table(offer=after.offer)
    table.arm()
    table.hold()
    assert table.written[-1].digest == after.offer.digest
    camera = moved.frame.camera
    session = Session((camera.width, camera.height), measured=Measured(0, moved), decision=table.deciding)
    told = decision_of(session)
    assert told.state == "confirmed"
    assert told.T_base_contact is not None
    contact = after.entry.payload["answer"]["contact"]
    assert np.allclose(told.T_base_contact[:3, 3], contact["point_m"], atol=1e-5)
    assert np.allclose(told.T_base_contact[:3, 2], contact["approach"], atol=1e-5)
    first = before.entry.payload["answer"]["contact"]
    assert np.linalg.norm(np.subtract(first["point_m"], contact["point_m"])) > 0.01

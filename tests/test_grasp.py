"""A tool at a place of an object: its room, the space it takes, what it would hit, and the arm's reach."""

from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.camera import inverse, transform
from rotrecon.clearance import clearances
from rotrecon.contact import Place, contact_on, limits_of, within
from rotrecon.envelope import BODY_M, STANDOFF_M, Box, envelope_of
from rotrecon.grasp import Grasp, clearances_of, grasp_of, points_in, shown_tool
from rotrecon.outcome import Fit
from rotrecon.primitives import Primitive, Sphere
from rotrecon.reading import Reading
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.tool_table import Tool, default_tools
from rotrecon.tools import ToolProposal, propose_tool
from rotrecon.workspace import Workspace
from tests.exact import cylinder, drawing_along, exact_frame
from tests.solids import ALONG, CAMERA_M, CENTER_M, pipe

TOOL = Tool(name="cutter", takes=("cylinder",), diameter_mm=(15, 160), opening_mm=180, depth_mm=200)
SHALLOW = Tool(name="snips", takes=("cylinder",), diameter_mm=(5, 100), opening_mm=110, depth_mm=45)
places = st.builds(Place, st.floats(-1.5, 1.5), st.floats(-0.14, 0.14))


def cleared(diameter_m: float, tool: Tool = TOOL, off_m: float = 0.002) -> tuple[float, ...]:
    reading = Reading(pipe(diameter_m, 0.6), (diameter_m - off_m, diameter_m + off_m))
    (one,) = clearances((reading,), CENTER_M, False, (tool,))
    assert one.opening_mm is not None
    assert one.depth_mm is not None
    return (*one.opening_mm, *one.depth_mm, *one.below_highest_mm, *(-value for value in one.above_lowest_mm))


@given(st.floats(0.01, 0.2), st.floats(0.0001, 0.1))
def test_a_thicker_object_has_less_room(diameter_m: float, more_m: float) -> None:
    assert all(after < before for before, after in zip(cleared(diameter_m), cleared(diameter_m + more_m), strict=True))


@given(st.floats(0.01, 0.2), st.floats(0.0001, 0.005))
def test_a_wider_interval_has_less_room_at_least(diameter_m: float, more_m: float) -> None:
    narrow, wide = cleared(diameter_m, off_m=0.001), cleared(diameter_m, off_m=0.001 + more_m)
    assert wide[0] < narrow[0]
    assert wide[1] > narrow[1]


def test_every_tool_of_the_table_has_its_clearance_or_its_reason() -> None:
    solid = pipe(0.06)
    found = clearances((Reading(solid, (0.059, 0.061)),), CENTER_M, False, default_tools())
    assert [one.verdict for one in found] == ["fits", "ruled out", "ruled out"]
    assert [bool(one.why) for one in found] == [False, True, True]
    assert found[0].opening_mm == pytest.approx((119, 121))
    inside = clearances((Reading(solid),), CENTER_M, True, default_tools())
    assert {one.verdict for one in inside} == {"ruled out"}
    across = clearances((Reading(pipe(0.1605), (0.158, 0.163)),), CENTER_M, False, default_tools())
    assert across[0].verdict == "not sure"
    assert "look at it from nearer" in across[0].why
    assert across[0].below_highest_mm == pytest.approx((-3, 2))
    with pytest.raises(ValueError, match="no reading"):
        clearances((), CENTER_M, False, default_tools())


def test_jaws_that_do_not_get_past_the_middle_are_ruled_out() -> None:
    shallow = replace_tool(SHALLOW, depth_mm=20)
    (out,) = clearances((Reading(pipe(0.06)),), CENTER_M, False, (shallow,))
    assert out.verdict == "ruled out"
    assert "20 mm deep" in out.why
    (open_,) = clearances((Reading(pipe(0.04), (0.038, 0.042)),), CENTER_M, False, (shallow,))
    assert open_.verdict == "not sure"


@settings(max_examples=60, deadline=None)
@given(
    st.tuples(*[st.floats(-0.6, 0.6)] * 2, st.floats(-0.3, 1.2)),
    st.tuples(*[st.floats(0.01, 0.4)] * 3),
    st.tuples(*[st.floats(-3.0, 3.0)] * 3),
)
def test_what_is_in_a_box_is_found_wherever_it_is(
    center: tuple[float, ...], half: tuple[float, ...], turn: tuple[float, ...]
) -> None:
    frame = exact_frame(cylinder(np.array([0.0, 0.0, 0.8]), np.array([0.0, 1.0, 0.0]), 0.06))
    box = Box(cv2.Rodrigues(np.array(turn))[0], np.array(center), np.array(half))
    pixel, in_base = points_in(box, frame)
    points_m = frame.points_m.reshape(-1, 3).astype(np.float64)
    everywhere = np.flatnonzero(box.holds(transform(frame.T_base_camera, points_m)))
    assert sorted(pixel.tolist()) == everywhere.tolist()
    assert np.allclose(in_base, transform(frame.T_base_camera, points_m[pixel]))


def replace_tool(tool: Tool, depth_mm: float) -> Tool:
    return Tool(
        name=tool.name,
        takes=tool.takes,
        diameter_mm=tool.diameter_mm,
        opening_mm=tool.opening_mm,
        depth_mm=depth_mm,
    )


@given(places, st.sampled_from([pipe(), Sphere(CENTER_M, ALONG, 0.05)]))
def test_a_contact_is_on_the_surface_and_square_to_the_axis(place: Place, solid: Primitive) -> None:
    contact = contact_on(solid, CAMERA_M, place)
    assert abs(float(solid.distance(contact.point_m))) < 1e-9
    assert np.linalg.norm(contact.approach) == pytest.approx(1)
    assert abs(float(contact.approach @ solid.direction)) < 1e-9


@given(st.floats(allow_nan=True, allow_infinity=True), st.floats(allow_nan=True, allow_infinity=True))
def test_a_place_is_kept_within_its_limits(angle: float, along: float) -> None:
    solid = pipe()
    kept, most = within(Place(angle, along), solid), limits_of(solid)
    assert abs(kept.angle_rad) <= most.angle_rad
    assert abs(kept.along_m) <= most.along_m
    assert within(kept, solid) == kept


def test_what_is_proposed_is_the_place_zero() -> None:
    for solid in (pipe(), Sphere(CENTER_M, ALONG, 0.05)):
        proposal = propose_tool((Reading(solid),), CAMERA_M, False, default_tools())
        assert isinstance(proposal, ToolProposal)
        contact = contact_on(solid, CAMERA_M)
        assert np.array_equal(contact.point_m, proposal.contact_point_m)
        assert np.array_equal(contact.approach, proposal.approach)
    right = contact_on(pipe(), CAMERA_M, Place(0.5))
    assert right.approach @ contact_on(pipe(), CAMERA_M).approach == pytest.approx(np.cos(0.5))


def section(solid: Primitive, along_m: float, radius_m: float) -> np.ndarray:
    """Points (n, 3) of the cross-section there, thickened to a radius."""
    angle = np.linspace(0, 2 * np.pi, 60)[:, None]
    x, y = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
    return solid.center_m + along_m * solid.direction + radius_m * (np.cos(angle) * x + np.sin(angle) * y)


@given(places, st.floats(0.02, 0.14), st.floats(0.0, 0.01))
def test_the_mouth_holds_the_section_and_no_steel_touches_it(place: Place, diameter_m: float, more_m: float) -> None:
    solid = pipe(diameter_m)
    contact = contact_on(solid, CAMERA_M, place)
    envelope = envelope_of(TOOL, solid, contact, diameter_m + more_m)
    points = section(solid, place.along_m, (diameter_m + more_m) / 2)
    assert envelope.mouth.holds(points + 1e-9 * (solid.center_m + place.along_m * ALONG - points)).all()
    for steel in envelope.solid:
        assert not steel.holds(points + 1e-6 * (solid.center_m + place.along_m * ALONG - points)).any()
    for part in (envelope.mouth, *envelope.solid):
        middle = part.center_m + (part.corners_m - part.center_m) * (1 - 1e-9)
        assert envelope.way.holds(middle).all()
    assert np.linalg.norm(envelope.start_m - envelope.bottom_m) == pytest.approx(STANDOFF_M)


def test_a_shallow_tool_goes_in_until_the_object_touches_its_bottom() -> None:
    solid = pipe(0.06)
    envelope = envelope_of(SHALLOW, solid, contact_on(solid, CAMERA_M), 0.06)
    assert np.allclose(envelope.bottom_m, contact_on(solid, CAMERA_M).point_m)
    assert envelope.mouth.half_m[2] == pytest.approx(0.0225)


def test_a_box_as_a_mesh_has_its_corners_and_its_volume() -> None:
    envelope = envelope_of(TOOL, pipe(), contact_on(pipe(), CAMERA_M, Place(0.4, 0.05)), 0.06)
    mesh = envelope.body.as_mesh()
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(8 * np.prod(envelope.body.half_m))
    assert envelope.body.half_m[2] == pytest.approx(BODY_M / 2)
    corners = {tuple(np.round(corner, 9)) for corner in envelope.body.corners_m}
    assert {tuple(np.round(vertex, 9)) for vertex in np.asarray(mesh.vertices)} == corners


@cache
def measured() -> Reconstruction:
    solid = cylinder(np.array([0.0, 0.0, 1.0]), np.array([0, 1.0, 0]), 0.08)
    return reconstruct(exact_frame(solid), drawing_along(solid), Settings())


def grasp(result: Reconstruction, place: Place = Place()) -> Grasp:  # noqa: B008
    found = grasp_of(result, default_tools()[0], place)
    assert found is not None
    return found


def with_point(result: Reconstruction, point_m: np.ndarray) -> tuple[Reconstruction, int]:
    """The same with one more point, base coordinates, in the cloud: in a pixel of its upper left corner."""
    cloud = result.frame.points_m.copy()
    cloud[3, 4] = transform(inverse(result.frame.T_base_camera), point_m)
    return replace(result, frame=replace(result.frame, points_m=cloud)), 3 * result.frame.camera.width + 4


def test_free_space_is_free() -> None:
    found = grasp(measured())
    assert len(found.at_contact.pixel) == len(found.on_way.pixel) == 0
    assert found.at_contact.nearest_m is None
    assert found.unreachable == ()
    assert found.clearance.verdict == "fits"


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(["mouth", "left jaw", "right jaw", "body"]), st.floats(-0.95, 0.95), st.floats(-0.95, 0.95))
def test_a_point_in_the_envelope_is_reported(part: str, first: float, second: float) -> None:
    envelope = grasp(measured()).envelope
    box = dict(zip(["left jaw", "right jaw", "body", "mouth"], [*envelope.solid, envelope.mouth], strict=True))[part]
    share = np.array([0.99 if part == "mouth" else first, second, first])
    point_m = box.center_m + (share * box.half_m) @ box.turn
    result, pixel = with_point(measured(), point_m)
    found = grasp(result)
    assert found.at_contact.pixel.tolist() == [pixel]
    assert found.at_contact.nearest_m is not None
    assert found.at_contact.nearest_m > 0


def test_a_point_on_the_way_is_told_apart_and_the_object_is_no_obstacle() -> None:
    clear = grasp(measured())
    result, pixel = with_point(measured(), clear.envelope.body.center_m - 0.1 * clear.contact.approach)
    found = grasp(result)
    assert found.on_way.pixel.tolist() == [pixel]
    assert len(found.at_contact.pixel) == 0
    own, _ = with_point(measured(), clear.contact.point_m - 0.0005 * clear.contact.approach)
    assert len(grasp(own).at_contact.pixel) == 0
    turned = grasp(result, Place(0.8, 0.0))
    assert len(turned.on_way.pixel) == 0, "from elsewhere the way is free"


def test_what_was_segmented_with_the_object_but_is_not_on_it_is_an_obstacle() -> None:
    result, found = measured(), grasp(measured())
    assert result.sections is not None
    camera, T = result.frame.camera, inverse(result.frame.T_base_camera)
    jaw = found.envelope.jaws[0]
    cloud = result.frame.points_m.copy()
    own = np.zeros(cloud.shape[:2], dtype=bool)
    own.ravel()[result.sections.pixel] = True
    kept = np.unique(result.segments.pixel[result.segmentation.kept])
    u, v = np.rint(camera.project(transform(T, jaw.center_m))).astype(int)
    assert not own[v - 4 : v + 5, u - 4 : u + 5].any()
    cloud[v, u] = transform(T, jaw.center_m)
    hit = replace(result, frame=replace(result.frame, points_m=cloud))
    everything = replace(hit, segmentation=replace(hit.segmentation, kept=np.ones_like(hit.segmentation.kept)))
    assert len(kept) < everything.segmentation.kept.sum()
    assert v * camera.width + u in grasp(everything).at_contact.pixel


def test_what_the_arm_does_not_reach_is_said() -> None:
    near = replace(measured().frame, workspace=Workspace(reach_m=(0.1, 0.9)))
    found = grasp(replace(measured(), frame=near))
    assert any("the contact is 0.96 m from the base" in why for why in found.unreachable)
    box = replace(measured().frame, workspace=Workspace(box_m=np.array([[-1, -1, 0.9], [1, 1, 2.0]])))
    boxed = grasp(replace(measured(), frame=box))
    assert [why.split(",")[0] for why in boxed.unreachable] == ["the approach"]
    assert "z = " in boxed.unreachable[0]
    assert grasp(measured()).unreachable == ()


def test_nothing_measured_is_nothing_to_hold() -> None:
    nothing = replace(measured(), readings=())
    assert grasp_of(nothing, TOOL) is None
    assert clearances_of(nothing) == ()
    assert shown_tool(replace(nothing, tool=replace_no_tool())) is None
    assert shown_tool(measured()) == default_tools()[0]
    assert isinstance(measured().fit, Fit)


def replace_no_tool():
    return Reconstruction.__dataclass_fields__["tool"].default

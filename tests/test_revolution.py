"""A general solid of revolution, and everything that takes a solid: laws."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import settings as examples
from hypothesis import strategies as st

from app.describe import describe
from app.wording import candidate_name
from rotrecon.answer import answer
from rotrecon.camera import PinholeCamera, transform
from rotrecon.curves import curves_of
from rotrecon.mesh import FACETS, as_mesh
from rotrecon.primitives import Frustum, Primitive, Revolution, Sphere, basis_across, in_words
from rotrecon.reading import Reading
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from rotrecon.tool_table import Tool
from rotrecon.tools import NoTool, ToolProposal, propose_tool
from tests.exact import cylinder, drawing_along, exact_frame, measured
from tests.solids import ALONG, CAMERA_M, CENTER_M

CAMERA = PinholeCamera(640, 480, np.array([[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]]))
ANGLES = st.floats(-3.1, 3.1)


def turned(along_m: list[float], radii_m: list[float], direction: np.ndarray = ALONG) -> Revolution:
    return Revolution(CENTER_M, direction / np.linalg.norm(direction), np.array(along_m), np.array(radii_m))


def bottle(direction: np.ndarray = ALONG) -> Revolution:
    return turned([-0.1, 0.03, 0.06, 0.1], [0.035, 0.035, 0.012, 0.014], direction)


@st.composite
def profiles(draw: st.DrawFn) -> Revolution:
    """Any profile, its axis any way."""
    before, after = (draw(st.lists(st.floats(0.005, 0.04), min_size=1, max_size=4)) for _ in range(2))
    along = np.concatenate([-np.cumsum(before)[::-1], np.cumsum(after)])
    radii = draw(st.lists(st.floats(0.005, 0.06), min_size=len(along), max_size=len(along)))
    azimuth, height = draw(ANGLES), draw(st.floats(-0.99, 0.99))
    across = np.sqrt(1 - height**2)
    return turned(list(along), radii, np.array([across * np.cos(azimuth), across * np.sin(azimuth), height]))


@st.composite
def poses(draw: st.DrawFn) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(np.array([draw(ANGLES) for _ in range(3)]))[0]
    pose[:3, 3] = [draw(st.floats(-2, 2)) for _ in range(3)]
    return pose


def surface_point(solid: Revolution, along_m: float, angle: float) -> np.ndarray:
    x, y = basis_across(solid.direction, np.array([0.0, 0.3, 1.0]))
    radial = np.cos(angle) * x + np.sin(angle) * y
    return solid.center_m + along_m * solid.direction + solid.radius_at(along_m) * radial


@given(profiles())
def test_radius_is_that_of_the_profile_and_straight_between(solid: Revolution) -> None:
    assert solid.radius_at(solid.along_m) == pytest.approx(solid.radii_m)
    middles = (solid.along_m[:-1] + solid.along_m[1:]) / 2
    assert solid.radius_at(middles) == pytest.approx((solid.radii_m[:-1] + solid.radii_m[1:]) / 2)
    low, high = solid.ends
    assert solid.radius_at(low - 1) == solid.radii_m[0]
    assert solid.radius_at(high + 1) == solid.radii_m[-1]
    assert solid.radius_m == solid.radius_at(0.0)


@given(profiles(), st.floats(0, 1), ANGLES, st.floats(-1e-4, 1e-4))
def test_distance_is_orthogonal_to_the_surface(solid: Revolution, share: float, angle: float, off_m: float) -> None:
    """Off a piece of the profile by its normal, as long as the foot of the normal is on the same piece."""
    piece = min(int(share * (len(solid.along_m) - 1)), len(solid.along_m) - 2)
    along_m = (solid.along_m[piece] + solid.along_m[piece + 1]) / 2
    slope = (solid.radii_m[piece + 1] - solid.radii_m[piece]) / (solid.along_m[piece + 1] - solid.along_m[piece])
    point = surface_point(solid, along_m, angle)
    radial = point - solid.center_m - along_m * solid.direction
    normal = (radial / np.linalg.norm(radial) - slope * solid.direction) / np.hypot(1, slope)
    assert float(solid.distance(point + off_m * normal)) == pytest.approx(off_m, abs=1e-12)


@given(profiles(), poses(), st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_moving_commutes_with_measuring(solid: Revolution, pose: np.ndarray, place: list[float]) -> None:
    point = np.array(place)
    along_m = (point - solid.center_m) @ solid.direction
    assume(np.abs(along_m - solid.along_m).min() > 1e-9)  # off the surface, the distance jumps where the profile bends
    there = solid.moved(pose)
    assert float(there.distance(transform(pose, point))) == pytest.approx(float(solid.distance(point)), abs=1e-9)
    assert (there.ends, there.radius_m) == (solid.ends, solid.radius_m)


@pytest.mark.parametrize("half_angle_rad", [0.0, 0.2, -0.3])
def test_straight_profile_is_a_frustum(half_angle_rad: float) -> None:
    frustum = Frustum("cone", CENTER_M, ALONG, 0.2, 0.05, half_angle_rad)
    solid = turned([-0.1, 0.02, 0.1], [float(frustum.radius_at(along)) for along in (-0.1, 0.02, 0.1)])
    points = CENTER_M + np.random.default_rng(0).uniform(-0.099, 0.099, (200, 3))
    assert solid.distance(points) == pytest.approx(frustum.distance(points), abs=1e-12)
    for ours, its in zip(curves_of(solid, CAMERA), curves_of(frustum, CAMERA), strict=True):
        assert np.abs(ours.points_px[[0, -1]] - its.points_px[[0, -1]]).max() < 1e-6
        if len(ours.visible) == len(its.visible):
            assert np.mean(ours.visible == its.visible) > 0.9
        else:
            assert ours.visible.all()


@pytest.mark.parametrize(
    ("along_m", "radii_m"),
    [
        ([-0.1, 0.1], [0.1]),
        ([0.0], [0.1]),
        ([-0.1, 0.1, 0.05], [0.1, 0.1, 0.1]),
        ([0.1, 0.2], [0.1, 0.1]),
        ([-0.1, 0.1], [0.1, -0.1]),
        ([-0.1, 0.1], [0.1, np.nan]),
    ],
)
def test_what_is_no_profile_is_refused(along_m: list[float], radii_m: list[float]) -> None:
    with pytest.raises(ValueError, match="profile"):
        turned(along_m, radii_m)


@given(profiles())
@examples(max_examples=30)
def test_mesh_is_closed_and_holds_the_sum_of_its_frusta(solid: Revolution) -> None:
    check_volume(solid)


@pytest.mark.parametrize("radii_m", [[0.0, 0.04, 0.02], [0.03, 0.04, 0.0], [0.0, 0.04, 0.0]])
def test_mesh_of_a_pointed_solid_is_closed(radii_m: list[float]) -> None:
    check_volume(turned([-0.1, 0.02, 0.1], radii_m))


def check_volume(solid: Revolution) -> None:
    mesh = as_mesh(solid)
    assert mesh.is_watertight
    low, high = solid.radii_m[:-1], solid.radii_m[1:]
    polygon = FACETS / 2 * np.sin(2 * np.pi / FACETS)
    volume = (polygon * np.diff(solid.along_m) * (low**2 + low * high + high**2) / 3).sum()
    assert mesh.volume == pytest.approx(volume, rel=1e-6)


def silhouette(solid: Primitive, grow_px: int) -> np.ndarray:
    """(H, W) where the mesh of a solid is seen, and so many pixels round it."""
    mesh = as_mesh(solid)
    picture = np.zeros((CAMERA.height, CAMERA.width), dtype=np.uint8)
    corners = np.rint(CAMERA.project(np.asarray(mesh.vertices))).astype(np.int32)
    for face in mesh.faces:
        cv2.fillConvexPoly(picture, corners[face], 255)
    return cv2.dilate(picture, np.ones((2 * grow_px + 1, 2 * grow_px + 1), dtype=np.uint8)) > 0


@given(profiles())
@examples(max_examples=20)
def test_curves_are_within_the_picture_of_the_mesh_and_the_limbs_bound_it(solid: Revolution) -> None:
    curves = curves_of(solid, CAMERA)
    grown = silhouette(solid, 2)
    for curve in curves:
        u, v = np.rint(curve.points_px[np.isfinite(curve.points_px).all(axis=1)]).astype(int).T
        assert grown[v, u].all()
    drawn = np.concatenate([curve.points_px for curve in curves])
    drawn = drawn[np.isfinite(drawn).all(axis=1)]
    v, u = np.nonzero(silhouette(solid, 0))
    assert drawn.min(axis=0) == pytest.approx([u.min(), v.min()], abs=2)
    assert drawn.max(axis=0) == pytest.approx([u.max(), v.max()], abs=2)


def test_a_bottle_is_drawn_by_its_rims_its_bends_and_its_limbs() -> None:
    foot, shoulder, neck, mouth, *limbs = curves_of(bottle(), CAMERA)
    assert len(limbs) == 2
    assert all(limb.visible.all() for limb in limbs)
    for ring, along in zip((foot, shoulder, neck, mouth), bottle().along_m, strict=True):
        center = CAMERA.project(CENTER_M + along * ALONG)
        assert ring.points_px[:-1].mean(axis=0) == pytest.approx(center, abs=1)
        assert 0.4 < ring.visible.mean() < 0.6
    assert np.linalg.norm(limbs[0].points_px[0] - limbs[1].points_px[0]) == pytest.approx(600 * 0.07 / 0.8, rel=0.01)


def test_a_wide_part_hides_what_is_behind_it() -> None:
    """The camera looks along the axis: at the mouth, which hides the neck, and at the foot, which hides all else."""
    toward, away = bottle(np.array([0.0, 0, -1])), bottle(np.array([0.0, 0, 1]))
    from_mouth, from_foot = ([ring.visible for ring in curves_of(solid, CAMERA)[:4]] for solid in (toward, away))
    assert [seen.all() for seen in from_mouth] == [seen.any() for seen in from_mouth] == [False, True, False, True]
    assert [seen.all() for seen in from_foot] == [seen.any() for seen in from_foot] == [True, False, False, False]


def test_a_smooth_profile_gets_few_rings() -> None:
    along = np.linspace(-0.0499, 0.0499, 65)
    ball = turned(list(along), list(np.sqrt(0.05**2 - along**2)))
    *rings, left, right = curves_of(ball, CAMERA)
    assert len(rings) == 5
    limb = curves_of(Sphere(CENTER_M, ALONG, 0.05), CAMERA)[1].points_px
    seen = np.concatenate([left.points_px, right.points_px])
    seen = seen[np.isfinite(seen).all(axis=1)]
    center = limb[:-1].mean(axis=0)
    across = np.linalg.norm(limb - center, axis=1).mean()
    assert np.linalg.norm(seen - center, axis=1) == pytest.approx(across, rel=0.02)


def held(solid: Revolution, tool: Tool, diameter_m: tuple[float, float] | None = None) -> ToolProposal | NoTool:
    return propose_tool((Reading(solid, diameter_m),), CAMERA_M, False, (tool,))


def tool_for(low_mm: float, high_mm: float, ratio: float = 0.0) -> Tool:
    return Tool(name="grip", takes=("revolution",), diameter_mm=(low_mm, high_mm), min_length_over_diameter=ratio)


def test_contact_is_on_the_surface_before_the_middle() -> None:
    proposal = held(bottle(), tool_for(10, 100))
    assert isinstance(proposal, ToolProposal)
    assert float(bottle().distance(proposal.contact_point_m)) == pytest.approx(0, abs=1e-9)
    assert proposal.contact_point_m == pytest.approx(CENTER_M - [0, 0, bottle().radius_m])
    assert proposal.approach @ ALONG == pytest.approx(0)


def test_a_tool_must_take_the_middle_and_the_widest_part() -> None:
    waist = turned([-0.1, 0.0, 0.1], [0.04, 0.02, 0.03])
    assert isinstance(held(waist, tool_for(40, 80)), ToolProposal)
    for tool in (tool_for(41, 80), tool_for(40, 79)):
        answer = held(waist, tool)
        assert isinstance(answer, NoTool)
        assert answer.unsure == ()
        assert "solid of revolution has 40.0 mm in the middle and 80.0 mm where it is widest" in answer.reasons[0]
    doubtful = held(waist, tool_for(30, 80), (0.039, 0.041))
    assert isinstance(doubtful, NoTool)
    assert len(doubtful.unsure) == 1


def test_long_enough_is_judged_by_the_widest_part() -> None:
    waist = turned([-0.1, 0.0, 0.1], [0.04, 0.02, 0.03])
    assert isinstance(held(waist, tool_for(10, 100, 2.5)), ToolProposal)
    answer = held(waist, tool_for(10, 100, 2.6))
    assert isinstance(answer, NoTool)
    assert "the solid of revolution is 2.5 times" in answer.reasons[0]


def test_tools_for_other_kinds_do_not_take_it() -> None:
    tool = Tool(name="cutter", takes=("cylinder", "rod", "cone", "sphere"), diameter_mm=(1, 500))
    answer = held(bottle(), tool)
    assert isinstance(answer, NoTool)
    assert answer.reasons == ("cutter: does not take a solid of revolution: ruled out",)


def test_kinds_in_words() -> None:
    assert [in_words(kind) for kind in ("cone", "revolution")] == ["cone", "solid of revolution"]


def test_its_answer_has_an_axis_a_length_and_the_diameter_of_the_middle() -> None:
    body = cylinder(CENTER_M, ALONG, 0.08)
    result = reconstruct(exact_frame(body), drawing_along(body, 0.7), Settings())
    solid = bottle(ALONG)
    content = answer(replace(result, solid=solid, fit=replace(measured(result), solid=solid)))
    assert (content["kind"], content["half_angle_deg"]) == ("revolution", None)
    assert content["diameter_mm"] == pytest.approx(70)
    assert content["length_mm"] == pytest.approx(200)
    assert content["axis"] == {"point_m": CENTER_M.tolist(), "direction": ALONG.tolist()}
    assert describe(content).startswith("solid of revolution, 70.0")
    called = {"kind": "revolution", "half_angle_deg": None}
    assert candidate_name(called) == "solid of revolution"

"""What a reconstruction ends in: a refusal with its reason, a solid of a kind, a tool or none."""

from dataclasses import replace

import numpy as np
import pytest

from rotrecon.circles import SectionState
from rotrecon.drawing import AreaOfInterest, Drawing, DrawingError, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.outcome import FailureReason, FitFailure
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from rotrecon.tools import NoTool, ToolProposal
from rotrecon.workspace import Workspace
from tests.exact import CAMERA, cylinder, direction_of, drawing_along, exact_frame, measured, noisy

ROBUST, PAPER = Settings(), Settings(method="paper")
by_both = pytest.mark.parametrize("method", [ROBUST, PAPER], ids=["robust", "paper"])


@pytest.mark.parametrize(("method", "kind"), [(ROBUST, "sphere"), (PAPER, "sphere"), (PAPER, "cone")])
def test_a_kind_that_the_depths_speak_against_is_refused(method, kind):
    solid = cylinder(np.array([0.05, 0, 0.8]), direction_of(20, 70), 0.06)
    result = reconstruct(noisy(exact_frame(solid), 2), drawing_along(solid, kind=kind), method)
    assert isinstance(result.fit, FitFailure)
    assert result.fit.reason is FailureReason.NOT_THIS_KIND
    assert "cylinder" in result.fit.advice
    assert result.solid is None


def test_a_pipe_that_is_asked_for_as_a_cone_is_one_that_hardly_tapers_and_not_certain():
    solid = cylinder(np.array([0.05, 0, 0.8]), direction_of(20, 70), 0.06)
    fit = measured(reconstruct(noisy(exact_frame(solid), 2), drawing_along(solid, kind="cone"), ROBUST))
    assert fit.intervals is not None
    assert fit.evidence is not None
    assert fit.intervals.half_angle_rad is not None
    low, high = fit.intervals.half_angle_rad
    assert low < 0 < high
    assert high - low < 0.02
    assert not fit.evidence.certain


@by_both
def test_wall_alone_is_flat_and_never_a_solid(method):
    frame = noisy(Frame(np.zeros((240, 320, 3), np.uint8), CAMERA.cloud(np.full((240, 320), 1.0)), CAMERA), 3)
    drawing = Drawing(AreaOfInterest.rectangle((100, 60), (220, 180)), ObjectAxis((160, 70), (160, 170)))
    fit = reconstruct(frame, drawing, method).fit
    assert isinstance(fit, FitFailure)
    assert fit.reason in (FailureReason.FLAT, FailureReason.TOO_FEW_SECTIONS, FailureReason.NO_AXIS)


@by_both
def test_what_the_arm_cannot_reach_is_refused_with_the_reason(method):
    solid = cylinder(np.array([0, 0, 0.8]), direction_of(0, 90), 0.06)
    frame = replace(exact_frame(solid), workspace=Workspace(depth_m=(0.1, 0.5)))
    fit = reconstruct(frame, drawing_along(solid), method).fit
    assert isinstance(fit, FitFailure)
    assert fit.reason is FailureReason.OUT_OF_REACH


@by_both
def test_points_outside_the_workspace_are_in_no_section(method):
    solid = cylinder(np.array([0, 0, 0.8]), direction_of(0, 90), 0.06)
    near = replace(exact_frame(solid), workspace=Workspace(depth_m=(0.1, 1.5)))
    result = reconstruct(near, drawing_along(solid), method)
    assert measured(result).solid.radius_m == pytest.approx(0.03, rel=1e-3)
    assert not (result.segmentation.kept & (near.depth_m.ravel()[result.segments.pixel] > 1.5)).any()


@by_both
def test_area_without_depth_is_a_drawing_error(method):
    frame = Frame(np.zeros((240, 320, 3), np.uint8), CAMERA.cloud(np.full((240, 320), np.nan)), CAMERA)
    drawing = Drawing(AreaOfInterest.rectangle((100, 60), (220, 180)), ObjectAxis((160, 70), (160, 170)))
    with pytest.raises(DrawingError, match="no depth"):
        reconstruct(frame, drawing, method)


@by_both
def test_excluded_sections_do_not_count_and_keep_their_numbers(method):
    solid = cylinder(np.array([0, 0, 0.8]), direction_of(0, 90), 0.06)
    frame, drawing = noisy(exact_frame(solid), 5), drawing_along(solid, kind="cylinder")
    excluded = frozenset({3, 4, 60})
    plain = reconstruct(frame, drawing, method)
    less = reconstruct(frame, replace(drawing, excluded_sections=excluded), method)
    states = measured(less).section_state
    assert {int(s) for s in np.flatnonzero(states == SectionState.EXCLUDED)} == excluded
    assert plain.sections is not None
    assert less.sections is not None
    assert np.array_equal(plain.sections.start, less.sections.start)


@by_both
def test_thin_cylinder_is_a_rod_and_goes_to_the_clipper_and_a_thick_one_to_the_cutter(method):
    thin = cylinder(np.array([0, 0, 0.6]), direction_of(0, 90), 0.02, 0.3)
    thick = cylinder(np.array([0, 0, 0.8]), direction_of(0, 90), 0.06, 0.3)
    for solid, kind, tool in ((thin, "rod", "clipper"), (thick, "cylinder", "mechanical cutter")):
        result = reconstruct(exact_frame(solid), drawing_along(solid), method)
        assert result.solid is not None
        assert result.solid.kind == kind
        assert isinstance(result.tool, ToolProposal)
        assert result.tool.tool.name == tool


@by_both
def test_contact_lies_on_the_surface_and_the_approach_is_square_to_the_axis(method):
    solid = cylinder(np.array([0.05, 0, 0.8]), direction_of(30, 80), 0.06)
    result = reconstruct(exact_frame(solid), drawing_along(solid), method)
    assert isinstance(result.tool, ToolProposal)
    assert result.solid is not None
    assert abs(float(result.solid.distance(result.tool.contact_point_m))) < 1e-9
    assert abs(result.tool.approach @ result.solid.direction) < 1e-9
    assert result.tool.approach[2] > 0, "away from the camera"


@by_both
def test_surface_seen_from_inside_is_concave_and_gets_no_tool(method):
    u, v = np.meshgrid(np.arange(320), np.arange(240))
    rays = CAMERA.unproject(np.stack([u, v], axis=-1), np.ones(u.shape))
    # a pipe of radius 0.25 m round an axis along y, 0.3 m ahead: its far wall is 0.55 m away
    a, b, c = rays[..., 0] ** 2 + 1, -0.3, 0.3**2 - 0.25**2
    depth = (-b + np.sqrt(b**2 - a * c)) / a
    frame = Frame(np.zeros((240, 320, 3), np.uint8), CAMERA.cloud(depth), CAMERA)
    drawing = Drawing(AreaOfInterest.rectangle((60, 60), (260, 180)), ObjectAxis((160, 70), (160, 170)), "cylinder")
    result = reconstruct(frame, drawing, replace(method, layers=1))
    assert measured(result).concave
    assert measured(result).solid.radius_m == pytest.approx(0.25, rel=1e-3)
    assert isinstance(result.tool, NoTool)


@pytest.mark.parametrize(
    ("strict", "says"),
    [
        (replace(PAPER, doubtful_rms_over_radius=0.001), "mm off"),
        (replace(PAPER, doubtful_circles=1.1), "have a circle"),
        (replace(ROBUST, doubtful_circles=1.1), "few sections agree"),
        (replace(ROBUST, doubtful_inlier_share=1.1), "of the depths agree"),
        (replace(ROBUST, doubtful_arc_rad=3.0), "degrees of the surface are seen"),
        (replace(ROBUST, widest_interval=1e-4), "known only to lie between"),
    ],
)
def test_doubtful_sizes_name_no_tool_and_say_why(strict, says):
    solid = cylinder(np.array([0, 0, 0.8]), direction_of(0, 90), 0.06)
    frame, drawing = noisy(exact_frame(solid), 4), drawing_along(solid)
    assert isinstance(reconstruct(frame, drawing, Settings(method=strict.method)).tool, ToolProposal)
    result = reconstruct(frame, drawing, strict)
    assert isinstance(result.tool, NoTool)
    assert result.tool.reasons == measured(result).doubts
    assert says in result.tool.reasons[0]
    assert result.solid is not None
    evidence = measured(result).evidence
    assert evidence is None or not evidence.certain


@by_both
def test_a_slip_of_the_hand_is_called_too_short(method):
    solid = cylinder(np.array([0, 0, 0.8]), direction_of(0, 90), 0.06)
    drawing = replace(drawing_along(solid), axis=ObjectAxis((159.5, 110), (159.5, 116)))
    fit = reconstruct(exact_frame(solid), drawing, method).fit
    assert isinstance(fit, FitFailure)
    assert "only 7 px long" in fit.advice


@by_both
def test_too_many_sections_taken_out_is_told_as_such(method):
    solid = cylinder(np.array([0, 0, 0.8]), direction_of(0, 90), 0.06)
    drawing = replace(drawing_along(solid), excluded_sections=frozenset(range(2, 400)))
    result = reconstruct(exact_frame(solid), drawing, method)
    fit = result.fit
    assert isinstance(fit, FitFailure)
    assert "excluded by hand" in fit.advice
    assert result.second_cut is not None, "they can be seen, and put back one by one"
    assert (result.second_cut.circles.state == SectionState.EXCLUDED).sum() > 50

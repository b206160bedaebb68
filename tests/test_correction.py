"""A careless stroke is put right, a careful one left alone."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.bench.accuracy.misdrawn import STROKES, misdrawn, width_px
from rotrecon.drawing import Constraints, Drawing, ObjectAxis, area_mask
from rotrecon.frame import View
from rotrecon.outcome import Fit, Intervals
from rotrecon.primitives import Frustum, Sphere
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.ideal_drawing import ideal_drawing
from rotrecon.simulation.simulate import DEFAULT_CAMERA, simulate
from rotrecon.simulation.stereo_noise import StereoErrors
from rotrecon.stroke.correction import corrected
from tests.exact import cone, cylinder, direction_of

CAMERA = DEFAULT_CAMERA
SIZE = (CAMERA.width, CAMERA.height)
SOLIDS = {
    "pipe": cylinder(np.array([0.02, -0.03, 0.9]), direction_of(20, 30), 0.1),
    "cone": cone(np.array([0.0, 0.02, 0.8]), direction_of(-15, 80), 0.1, 12, 0.2),
    "ball": Sphere(np.array([0.03, 0.01, 0.8]), np.array([0.6, 0.8, 0.0]), 0.1),
}
of_each = pytest.mark.parametrize("name", SOLIDS)


def fit_of(solid: Frustum | Sphere) -> Fit:
    return Fit(solid, np.zeros(0, dtype=np.uint8), np.zeros(0), 0.0, 2.5, concave=False)


def careless(name: str) -> tuple[Drawing, dict[str, Drawing]]:
    drawing = ideal_drawing(SOLIDS[name], CAMERA)
    return drawing, misdrawn(drawing, width_px(drawing), SIZE)


@of_each
def test_a_careful_stroke_is_left_alone(name):
    drawing, others = careless(name)
    assert corrected(drawing, fit_of(SOLIDS[name]), CAMERA) is None
    assert corrected(others["area twice too large"], fit_of(SOLIDS[name]), CAMERA) is None


@pytest.mark.parametrize(
    ("name", "mistake"),
    # a ball has no axis that a stroke could be off
    [case for case in product(SOLIDS, STROKES) if case != ("ball", "axis 10 degrees off")],
)
def test_a_careless_stroke_becomes_the_careful_one(name, mistake):
    drawing, others = careless(name)
    stroke = corrected(others[mistake], fit_of(SOLIDS[name]), CAMERA)
    assert stroke is not None
    ideal, found = (np.array([one.start_px, one.end_px]) for one in (drawing.stroke, stroke))
    along = (ideal[1] - ideal[0]) / np.linalg.norm(ideal[1] - ideal[0])
    beside = (found - ideal[0]) @ np.array([-along[1], along[0]])
    assert np.abs(beside).max() < 3.0
    assert (found[1] - found[0]) @ along > 0.9 * (ideal[1] - ideal[0]) @ along


@of_each
def test_a_stroke_that_holds_the_direction_is_left_alone(name):
    _, others = careless(name)
    held = replace(others["axis 30 % short"], constraints=Constraints(direction="drawn"))
    assert corrected(held, fit_of(SOLIDS[name]), CAMERA) is None


@settings(max_examples=50, deadline=None)
@given(
    center=st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.1, 5)),
    tilt=st.floats(-90, 90),
    roll=st.floats(0, 360),
    diameter=st.floats(0.001, 50),
    length=st.floats(0.001, 50),
)
def test_whatever_was_found_a_corrected_stroke_lies_in_the_area(center, tilt, roll, diameter, length):
    drawing, _ = careless("pipe")
    solid = cylinder(np.array(center), direction_of(tilt, roll), diameter, length)
    stroke = corrected(drawing, fit_of(solid), CAMERA)
    if stroke is not None:
        column, row = np.floor(np.array([stroke.start_px, stroke.end_px]) + 0.5).astype(int).T
        assert area_mask(drawing.area, SIZE)[row, column].all()


SCENE = simulate("pipe", 0, noise=None, supersampling=0)
RESULT = reconstruct(SCENE.frame, SCENE.drawing, Settings(method="paper"))
VIEW = View(SCENE.frame.image, SCENE.frame.camera, SCENE.frame.T_base_camera)


def measured(solid: Frustum, relative: float, doubts: int = 0, views: tuple[View, ...] = ()) -> Reconstruction:
    """A result with an interval of a width, over the size."""
    fit, size_m, angle_rad = fit_of(solid), 2 * solid.radius_m, solid.half_angle_rad
    angles_rad = (angle_rad * (1 - relative / 2), angle_rad * (1 + relative / 2)) if angle_rad else None
    intervals = Intervals((size_m * (1 - relative / 2), size_m * (1 + relative / 2)), 0.001, half_angle_rad=angles_rad)
    fit = replace(fit, intervals=intervals, doubts=("a reason",) * doubts)
    return replace(RESULT, frame=replace(SCENE.frame, views=views), fit=fit)


def of_two(monkeypatch: pytest.MonkeyPatch, *answers: Reconstruction) -> Fit:
    """What is said where a careless stroke and the one put right have these answers."""
    given = iter(answers)
    monkeypatch.setattr("rotrecon.reconstruct._measured", lambda *_: next(given))
    monkeypatch.setattr("rotrecon.reconstruct.corrected", lambda *_: SCENE.drawing.stroke)
    short = misdrawn(SCENE.drawing, width_px(SCENE.drawing), SIZE)["axis 30 % short"]
    found = reconstruct(SCENE.frame, short, Settings()).fit
    assert isinstance(found, Fit)
    return found


@pytest.mark.parametrize(
    ("width", "doubts", "believed"), [(1.0, 0, True), (2.4, 0, True), (2.6, 0, False), (0.9, 1, True), (1.1, 1, False)]
)
def test_a_second_measurement_that_knows_less_is_not_believed(monkeypatch, width, doubts, believed):
    """Such as one that no longer sees a side of the outline."""
    pipe = SOLIDS["pipe"]
    first, second = measured(pipe, 0.02), measured(replace(pipe, radius_m=0.0505), 0.02 * width, doubts)
    assert (of_two(monkeypatch, first, second).solid.radius_m == 0.0505) == believed


@pytest.mark.parametrize("views", [(), (VIEW, VIEW)], ids=["depth", "views"])
@pytest.mark.parametrize("off", [0.9, 1.1])
@pytest.mark.parametrize("name", ["pipe", "cone"])
def test_from_several_views_a_second_measurement_has_to_be_within_the_first(monkeypatch, name, off, views):
    solid, half = SOLIDS[name], 0.01
    by = 1 + off * half
    # a cone's diameter hangs on where its middle is
    radius_m = 0.07 if name == "cone" else by * solid.radius_m
    other = replace(solid, half_angle_rad=by * solid.half_angle_rad, radius_m=radius_m)
    found = of_two(monkeypatch, measured(solid, 2 * half, views=views), measured(other, 2 * half, views=views))
    assert (found.solid == other) == (off < 1 or not views)


def test_an_object_is_measured_as_if_a_short_stroke_had_been_drawn_over_all_of_it():
    scene = simulate("cone", 2, noise=StereoErrors())
    stroke = scene.drawing.stroke
    start, end = np.array(stroke.start_px), np.array(stroke.end_px)
    short = replace(scene.drawing, axis=ObjectAxis(stroke.start_px, tuple(start + 0.65 * (end - start))))
    whole, result = (reconstruct(scene.frame, drawing, Settings()) for drawing in (scene.drawing, short))
    assert result.drawing.stroke != short.stroke, "it says what was measured along"
    assert result.drawing == replace(short, axis=result.drawing.axis)
    again = reconstruct(scene.frame, result.drawing, Settings())
    assert again.drawing == result.drawing, "a stroke that was put right is careful"
    assert len(result.segments.pixel) > 0.9 * len(whole.segments.pixel)
    assert isinstance(whole.fit, Fit)
    assert isinstance(result.fit, Fit)
    assert whole.fit.intervals is not None
    low_m, high_m = whole.fit.intervals.diameter_m
    assert abs(result.fit.solid.radius_m - whole.fit.solid.radius_m) < (high_m - low_m) / 4

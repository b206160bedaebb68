import json
from dataclasses import replace

import numpy as np
import pytest

from rotrecon.answer import answer, cannot
from rotrecon.drawing import AreaOfInterest, Drawing, ObjectAxis
from rotrecon.frame import Frame
from rotrecon.outcome import Fit, Intervals
from rotrecon.primitives import Sphere
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from tests.exact import CAMERA, cone, cylinder, drawing_along, exact_frame

UNKNOWN_TO_PAPER = [
    "margin", "interval_mm", "length_interval_mm", "ends", "center_interval_mm", "axis_interval_deg",
    "half_angle_interval_deg", "inlier_share", "sigma_over_radius", "noise",
]  # fmt: skip
OF_SOME_THINGS = ["length_interval_mm", "half_angle_interval_deg"]
"""Of a closed length, and of a cone."""
FIELDS = [
    "kind", "certain", "margin", "concave", "diameter_mm", "interval_mm", "length_mm", "length_interval_mm", "ends",
    "center_m", "center_interval_mm", "axis", "axis_interval_deg", "half_angle_deg", "half_angle_interval_deg",
    "profile", "rms_mm", "arc_deg", "parts", "inlier_share", "sigma_over_radius", "noise", "stereo", "sections",
    "stroke_px", "tool", "contact", "reasons", "candidates", "frame", "method",
]  # fmt: skip


ROBUST, PAPER = Settings(), Settings(method="paper")
by_both = pytest.mark.parametrize("method", [ROBUST, PAPER], ids=["robust", "paper"])


def answer_for(solid, method=ROBUST):
    return answer(reconstruct(exact_frame(solid), drawing_along(solid, 0.7), method))


@by_both
def test_answers_have_every_field_and_are_strict_json(method):
    wall = Frame(np.zeros((240, 320, 3), np.uint8), CAMERA.cloud(np.full((240, 320), 1.0)), CAMERA)
    drawing = Drawing(AreaOfInterest.rectangle((60, 60), (260, 190)), ObjectAxis((160, 70), (160, 180)))
    body = cylinder(np.array([0, 0, 0.8]), np.array([0, 1.0, 0.3]), 0.08)
    ball = Sphere(np.array([0, 0, 0.8]), np.array([0, 1.0, 0]), 0.1)
    refused = answer(reconstruct(wall, drawing, method))
    for content in (answer_for(body, method), answer_for(ball, method), refused, cannot("no", method.method)):
        assert sorted(content) == sorted(FIELDS)
        assert json.loads(json.dumps(content, allow_nan=False)) == content


@by_both
def test_cylinder_in_numbers(method):
    content = answer_for(cylinder(np.array([0, 0, 0.8]), np.array([0, 1.0, 0.3]), 0.08), method)
    assert content["kind"] == "cylinder"
    assert content["diameter_mm"] == pytest.approx(80, rel=1e-3)
    assert content["axis"]["direction"] == pytest.approx(np.array([0, 1, 0.3]) / np.hypot(1, 0.3), abs=1e-3)
    assert content["tool"] == "mechanical cutter"
    assert content["reasons"] == []
    assert content["half_angle_deg"] is None
    assert content["sections"]["used"] == len(content["profile"])
    along, diameters = np.array(content["profile"], dtype=object)[:, :2].astype(float).T
    assert diameters == pytest.approx(80, rel=2e-3)
    assert np.ptp(along) < content["length_mm"] < 1.05 * np.ptp(along)
    assert sum(c["score"] for c in content["candidates"]) == pytest.approx(1, abs=1e-3)


def test_what_was_measured_along_is_told_and_can_be_given_back():
    body = cylinder(np.array([0, 0, 0.8]), np.array([0, 1.0, 0.3]), 0.08)
    frame, drawing = exact_frame(body), drawing_along(body, 0.7)
    first, last = np.array([drawing.stroke.start_px, drawing.stroke.end_px])
    short = replace(drawing, axis=ObjectAxis(tuple(first), tuple(0.6 * first + 0.4 * last)))
    told = answer(reconstruct(frame, short, ROBUST))
    start, end = told["stroke_px"]
    assert np.linalg.norm(np.subtract(end, start)) > 0.8 * np.linalg.norm(last - first)
    again = replace(drawing, axis=ObjectAxis(tuple(start), tuple(end)))
    assert answer(reconstruct(frame, again, ROBUST)) == told


def test_paper_method_claims_no_certainty():
    content = answer_for(cylinder(np.array([0, 0, 0.8]), np.array([0, 1.0, 0.3]), 0.08), PAPER)
    assert content["method"] == "paper"
    assert content["certain"] is False
    assert [name for name in UNKNOWN_TO_PAPER if content[name] is not None] == []
    assert all(candidate["interval_mm"] is None for candidate in content["candidates"])


def test_robust_method_says_what_it_rests_on():
    content = answer_for(cylinder(np.array([0, 0, 0.8]), np.array([0, 1.0, 0.3]), 0.08))
    assert content["certain"] is True
    known = [name for name in UNKNOWN_TO_PAPER if content[name] is not None]
    assert known == [name for name in UNKNOWN_TO_PAPER if name not in OF_SOME_THINGS]
    assert content["inlier_share"] > 0.99
    assert content["noise"]["stated"] is False
    assert content["ends"] == {"start": "open", "end": "open"}, "the stroke and the area end before the body"
    assert [candidate["possible"] for candidate in content["candidates"]] == [True, False, False]
    first, second, _ = (candidate["score"] for candidate in content["candidates"])
    assert content["margin"] == pytest.approx(first - second, abs=2e-4)
    assert all(low <= diameter <= high for _, diameter, low, high in content["profile"])


@by_both
def test_intervals_in_millimetres_and_degrees(method):
    body = cone(np.array([0, 0, 0.7]), np.array([0, 1.0, 0]), 0.1, 12, 0.2)
    result = reconstruct(exact_frame(body), drawing_along(body, 0.7), method)
    assert isinstance(result.fit, Fit)
    intervals = Intervals((0.09, 0.11), 0.002, np.radians(1.0), (np.radians(11.0), np.radians(13.0)), (0.19, 0.21))
    content = answer(replace(result, fit=replace(result.fit, intervals=intervals)))
    assert content["interval_mm"] == [90, 110]
    assert content["length_interval_mm"] == [190, 210]
    assert content["center_interval_mm"] == 2
    assert content["axis_interval_deg"] == 1
    assert content["half_angle_interval_deg"] == [11, 13]
    assert sorted(content) == sorted(FIELDS)


@by_both
def test_sphere_has_no_axis_and_a_cone_has_an_angle(method):
    ball = answer_for(Sphere(np.array([0, 0, 0.8]), np.array([0, 1.0, 0]), 0.1), method)
    assert (ball["kind"], ball["axis"], ball["length_mm"]) == ("sphere", None, None)
    assert ball["ends"] is ball["axis_interval_deg"] is None
    body = answer_for(cone(np.array([0, 0, 0.7]), np.array([0, 1.0, 0]), 0.1, 12, 0.2), method)
    assert body["kind"] == "cone"
    assert body["half_angle_deg"] == pytest.approx(12, abs=0.3)


@by_both
def test_rod_is_called_so_among_the_candidates(method):
    content = answer_for(cylinder(np.array([0, 0, 0.6]), np.array([0, 1.0, 0]), 0.02, 0.3), method)
    assert content["kind"] == "rod"
    assert content["candidates"][0]["kind"] == "rod"

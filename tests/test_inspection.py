"""What is shown of a result beyond its numbers: stages, residuals, candidates and distances."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.answers import answer_of
from app.inspection import line_in
from app.inspection_text import EXCLUDED_TIMES, candidates_html, distance_html, odds, residuals_html, speaks
from app.page import EndPointed, MeasuringChosen, OverlayChosen, PageState, StepChosen, page_step
from app.pictures import Pictures
from app.section_drawing import radius_interval_mm, section_svg, section_text
from app.stage_chart import STAGE_SERIES, stage_chart, stage_scales, stage_text
from rotrecon.camera import transform
from rotrecon.distance import Distance, distance_between
from rotrecon.frame import StereoNoise
from rotrecon.line_stages import line_of
from rotrecon.outcome import FailureReason, Fit, FitFailure
from rotrecon.reconstruction import Reconstruction
from rotrecon.residuals import BEFORE, BEHIND, Residuals, residuals_of, with_residuals
from rotrecon.settings import Settings
from rotrecon.simulation.simulate import simulate
from tests.legs import measured_leg

REFUSED = FitFailure(FailureReason.NOT_ROUND, "draw anew")
SECTION = 60


@pytest.fixture(scope="module")
def result() -> Reconstruction:
    return measured_leg()


def test_the_steps_of_a_line_end_with_what_was_segmented(result: Reconstruction) -> None:
    rows = np.flatnonzero(result.segmentation.kept.any(axis=1))
    for row in rows[:: len(rows) // 7]:
        line = line_of(result, int(row))
        assert np.array_equal(line.stages[-1].members, result.segmentation.kept[row])
        for before, after in zip(line.stages[:-1], line.stages[1:], strict=True):
            assert np.array_equal(after.members, (before.members & ~after.removed) | after.added)
            assert not (after.removed & ~before.members).any()
            assert not (after.added & before.members).any()
        counted = result.segmentation.counts(int(row))
        runs = [stage for stage in line.stages if stage.name.startswith("run")]
        assert [int(stage.removed.sum()) for stage in runs] == [
            counted.get(f"distant in run {number + 1}", 0) for number in range(len(runs))
        ]


def test_a_run_takes_away_what_is_farther_than_the_mean_it_shows(result: Reconstruction) -> None:
    row = int(np.flatnonzero(result.segmentation.kept.any(axis=1))[10])
    line = line_of(result, row)
    run, three_sigma = line.stages[1], line.stages[3]
    assert run.mean_m is not None
    assert (line.depth_m[run.removed] > run.mean_m).all()
    assert (line.depth_m[run.members] <= run.mean_m + 1e-5).all()
    assert three_sigma.mean_m == pytest.approx(float(result.segmentation.mean_m[-1, row]))
    assert three_sigma.reach_m is not None
    off = np.abs(line.depth_m[three_sigma.members] - three_sigma.mean_m)
    assert (off <= three_sigma.reach_m * 1.001).all()


def test_the_chart_shows_every_pixel_once(result: Reconstruction) -> None:
    line = line_in(result, SECTION)
    assert line is not None
    for number in range(len(line.stages)):
        columns = stage_chart(line, number)
        assert len(columns) == len(STAGE_SERIES)
        shown = np.isfinite(np.array(columns[4:])).sum(axis=0)
        assert np.array_equal(shown > 0, np.isfinite(line.depth_m))
        assert shown.max() == 1
    bottom, top = stage_scales(line)["y"]["range"]
    assert bottom < 1000 * np.nanmin(line.depth_m) < 1000 * np.nanmax(line.depth_m) < top
    assert "Step 1 of 7, all depths the arm can use" in stage_text(line, 0)
    assert "mean" in stage_text(line, 1)
    assert "Step 7 of 7" in stage_text(line, 99)
    assert len(stage_chart(None, 0)) == len(STAGE_SERIES)
    assert "No line" in stage_text(None, 0)


def test_every_step_is_shown_on_the_picture(result: Reconstruction) -> None:
    pictures = Pictures(result.frame)
    line = line_in(result, SECTION)
    assert line is not None
    shown = [pictures.step(result, SECTION, number) for number in range(len(line.stages))]
    assert all(image is not None and image.shape == shown[0].shape for image in shown if shown[0] is not None)
    assert pictures.step(replace(result, sections=None), SECTION, 0) is None
    plain = pictures.camera_view(result, 0.0, SECTION)
    for overlay in ("tool", "residuals"):
        assert (pictures.camera_view(result, 0.0, SECTION, overlay) != plain).any()
    assert (pictures.with_ends(plain, ((100.0, 100.0), (200.0, 120.0))) != plain).any()
    refused = replace(result, fit=REFUSED, solid=None, readings=())
    assert pictures.camera_view(refused, 0.0, 0, "tool").shape == plain.shape


def test_residuals_are_blue_inside_and_vermilion_outside(result: Reconstruction) -> None:
    found = residuals_of(result)
    assert found is not None
    assert isinstance(result.fit, Fit)
    points = result.frame.points_m.reshape(-1, 3)[found.pixel].astype(np.float64)
    assert np.allclose(found.off_m, result.fit.solid.distance(points), atol=1e-6)
    assert np.mean(np.abs(found.off_m) <= found.scale_m) >= 0.95
    ends = Residuals(np.arange(3, dtype=np.int32), np.array([-1.0, 0.0, 1.0]), 0.5).colors
    assert tuple(ends[0]) == BEHIND
    assert tuple(ends[2]) == BEFORE
    assert ends[1].min() > 240
    drawn = with_residuals(result.frame.image, found)
    assert np.array_equal(drawn.reshape(-1, 3)[found.pixel[0]], found.colors[0])
    assert residuals_of(replace(result, fit=REFUSED)) is None
    html = residuals_html(found)
    assert f"{1000 * found.scale_m:g} mm outside" in html
    assert residuals_html(None) == ""


def test_candidates_stand_side_by_side_with_what_speaks_for_each(result: Reconstruction) -> None:
    content = answer_of(result)
    html = candidates_html(result)
    assert html.count("<td>") == 4 * len(content["candidates"])
    chosen = {"kind": "cylinder", "score": 0.9, "possible": True}
    cone = {"kind": "cone", "score": 0.0996, "possible": True}
    ball = {"kind": "sphere", "score": 1e-9, "possible": False}
    straight = {"kind": "cone", "score": 0.5, "possible": False}
    assert speaks(chosen, [chosen, cone]) == "chosen: 9 times as credible as the next"
    assert "cannot be excluded: 9 times less credible only" in speaks(cone, [chosen, cone])
    assert speaks(ball, [chosen, ball]) == "excluded: more than 1000 times less credible"
    assert "tapers too little" in speaks(straight, [chosen, straight])
    assert "excludes none" in speaks({**cone, "possible": None}, [chosen, cone])
    assert speaks(chosen, [chosen]) == "chosen: the only one"
    assert pytest.approx(float(np.exp(Settings().excluded_cost)), abs=1) == EXCLUDED_TIMES
    assert odds(1.0, 0.0) == "more than 1000 times"
    assert candidates_html(None) == ""


def test_a_section_has_its_interval_as_a_ring(result: Reconstruction) -> None:
    interval = radius_interval_mm(result, SECTION)
    assert interval is not None
    low, high = interval
    assert f'stroke-width="{high - low:.3f}"' in section_svg(result, SECTION)
    assert "±" in section_text(result, SECTION)
    assert radius_interval_mm(replace(result, fit=REFUSED), SECTION) is None


def test_the_distance_between_two_points_is_that_of_the_cloud(result: Reconstruction) -> None:
    frame = result.frame
    v, u = np.nonzero(np.isfinite(frame.depth_m[40:-40, 40:-40]))
    pixels = [(float(u[at] + 40), float(v[at] + 40)) for at in (0, -1)]
    found = distance_between(frame, pixels[0], pixels[1])
    assert isinstance(found, Distance)
    points = [frame.points_m[int(y), int(x)].astype(np.float64) for x, y in pixels]
    assert found.length_m == pytest.approx(np.linalg.norm(points[0] - points[1]), rel=0.05)
    assert np.allclose(found.points_m, transform(frame.T_base_camera, points), atol=0.05)
    assert found.sigma_m is not None
    none_stated = distance_between(replace(frame, noise=None), pixels[0], pixels[1])
    assert isinstance(none_stated, Distance)
    assert none_stated.sigma_m is None
    holes = frame.points_m.copy()
    holes[:20, :20] = np.nan
    why = distance_between(replace(frame, points_m=holes), (5.0, 5.0), pixels[1])
    assert why == "there is no depth at the first point; point beside it"
    assert "second" in str(distance_between(frame, pixels[0], (-5.0, 3.0)))


def test_a_distance_errs_as_much_as_its_ends() -> None:
    scene = simulate("pipe", 0, noise=None)
    frame = replace(scene.frame, noise=StereoNoise(0.1, 0.2))
    first, second = (150.0, 240.0), (480.0, 240.0)
    exact = distance_between(frame, first, second)
    assert isinstance(exact, Distance)
    rng = np.random.default_rng(3)
    errs = []
    for _ in range(300):
        ends = []
        for pixel, point in zip((first, second), exact.points_m, strict=True):
            depth = float(np.linalg.inv(frame.T_base_camera)[2] @ [*point, 1])
            off = rng.normal(0, 0.2 * depth**2 / (frame.camera.focal_px * 0.1))
            ends.append(frame.camera.unproject(pixel, depth + off))
        errs.append(float(np.linalg.norm(ends[0] - ends[1])) - exact.length_m)
    assert exact.sigma_m == pytest.approx(np.std(errs), rel=0.2)


def test_measuring_takes_two_clicks_then_begins_anew(result: Reconstruction) -> None:
    page = page_step(PageState(), EndPointed((1.0, 2.0)), 0)
    assert page.ends_px == (), "only when it was asked for"
    page = page_step(page, MeasuringChosen(True), 0)
    assert "first point" in distance_html(result.frame, page.measuring, page.ends_px)
    for count, u in ((1, 200.0), (2, 300.0), (1, 250.0)):
        page = page_step(page, EndPointed((u, 200.0)), 0)
        assert len(page.ends_px) == count
    page = page_step(page, EndPointed((float("nan"), 0.0)), 0)
    assert len(page.ends_px) == 1
    page = page_step(page, EndPointed((300.0, 200.0)), 0)
    assert re.search(r'data-value="\d+\.\d+"', distance_html(result.frame, page.measuring, page.ends_px))
    assert distance_html(result.frame, False, ()) == ""
    assert page_step(page, MeasuringChosen(False), 0).ends_px == ()
    assert page_step(page, OverlayChosen("nonsense"), 0) == page  # type: ignore[arg-type]
    assert page_step(page, StepChosen(-4), 0).step == 0


@given(st.floats(0.01, 1.0), st.floats(1e-6, 1.0))
def test_odds_are_never_less_than_they_are(more: float, less: float) -> None:
    said = odds(more, less)
    assert said.startswith("more than") == (more / less > 1000)

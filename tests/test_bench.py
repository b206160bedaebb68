"""The benchmarks run, say what they should, and measure the program itself; how fast it is, no test says."""

from dataclasses import astuple

import numpy as np
import pytest

from app.bench.composition import Steps, compose
from app.bench.latency import release_latency
from app.bench.measuring import SETTINGS, by_program
from app.bench.paper_method import paper_method_document
from app.bench.poses import STEREO, poses
from app.bench.speed import speed_report
from app.bench.stereo_speed import stereo_report
from app.bench.variations import VARIATIONS


@pytest.fixture(scope="module")
def document() -> str:
    return paper_method_document(count=1, runs=1)


def rows_of(text: str, first_cell: str) -> list[list[str]]:
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line[:1] == "|"]
    return [row for row in rows if row[0] == first_cell]


def test_document_has_every_object_with_both_depths_beside_the_paper(document):
    header = rows_of(document, "object")[0]
    assert header[1:] == [
        "depth",
        *["first cut: bias, %", "median", "spread"],
        *["second cut: bias, %", "median", "spread"],
        *["refused", "recognised", "paper"],
    ]
    for name, paper in {"leg": "-11", "ball": "-11", "ball, eq. (16)": "-11", "wire": "-12"}.items():
        rows = rows_of(document, name)
        assert [row[1] for row in rows] == ["exact", "noisy"]
        assert {row[-1] for row in rows} == {paper}


def test_document_says_what_each_replacement_does_to_each_object(document):
    header = rows_of(document, "bias and spread, %")[0]
    assert header[1:] == [f"{name}, {cut} cut" for name in ("leg", "ball", "wire") for cut in ("first", "second")]
    for name in ("true mask for the segmentation of 3.2", "windows, no noise"):
        assert len(rows_of(document, name)[0]) == len(header)
    assert "nan" not in document


def test_composition_of_unchanged_steps_is_the_program():
    pose = next(poses("ball", 1))
    for frame in (pose.frame(None), pose.frame(STEREO)):
        composed = compose(frame, pose.drawing, SETTINGS, Steps())
        np.testing.assert_allclose(astuple(composed), astuple(by_program(frame, pose.drawing)), rtol=1e-12)


def test_no_two_variations_have_one_name():
    names = [variation.name for variation in VARIATIONS]
    assert len(set(names)) == len(names)


def test_speed_report_puts_figures_beside_their_targets():
    report = speed_report(sizes=(1_000, 10_000), runs=1, whole_frame=10_000)
    assert rows_of(report, "pixels")[0] == ["pixels", "median", "per pixel", "runs", "target"]
    for row, target in zip(rows_of(report, "10005"), ("< 100 ms", "< 10 ms"), strict=True):
        assert target in row[-1]
    for direction in ("vertical", "horizontal", "diagonal"):
        assert [row[1] for row in rows_of(report, direction)] == ["robust", "paper"]
        assert "MB" in rows_of(report, direction)[1][-1]
    assert "all, from drawing to Reconstruction" in report


def test_every_release_on_a_page_gets_its_latency():
    durations_s = release_latency(1, "paper").durations_s
    assert durations_s.shape == (1,)
    assert (durations_s > 0).all()


def test_matching_is_measured_beside_the_bare_call():
    text = stereo_report(runs=1)
    assert len(rows_of(text, "bare matcher call")) == 1
    whole = rows_of(text, "the whole frame at full resolution")[0]
    assert "ms: " in whole[2]
    assert "MB: " in whole[4]

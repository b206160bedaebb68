from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.segmentation import PixelHistory, segment
from rotrecon.settings import Settings

ALL_LINES = replace(Settings(), line_density=0.0)


def scans_one_by_one(depth, accepted, reach):
    """Equations (4) and (5) as the paper walks them, pixel by pixel."""
    kept = accepted.copy()
    for order, before in ((range(1, len(depth)), -1), (range(len(depth) - 2, -1, -1), 1)):
        for i in order:
            if kept[i + before] and abs(depth[i] - depth[i + before]) <= reach:
                kept[i] = True
    return kept


@st.composite
def sections(draw):
    rows, columns = draw(st.integers(1, 6)), draw(st.integers(2, 30))
    seed = draw(st.integers(0, 2**31))
    rng = np.random.default_rng(seed)
    depth = 1 + rng.integers(0, 4, (rows, columns)) * 0.05 + rng.normal(0, 0.01, (rows, columns))
    depth[rng.random((rows, columns)) < draw(st.floats(0, 0.3))] = np.nan
    return depth.astype(np.float32)


@settings(deadline=None)
@given(sections())
def test_vectorised_scans_give_the_result_of_the_two_walks(depth):
    usable = np.isfinite(depth)
    result = segment(depth, usable, np.ones_like(usable), ALL_LINES)
    close = usable & (result.removed_in_run == 0)
    accepted = close & (result.history & PixelHistory.OUTLIER == 0)
    for row in range(len(depth)):
        if close[row].any():
            reach = np.float32(max(3 * result.sigma_m[-1, row], ALL_LINES.distance_floor_m))
            assert np.array_equal(result.kept[row], scans_one_by_one(depth[row], accepted[row], reach))


@settings(deadline=None)
@given(sections())
def test_every_pixel_has_a_history_that_explains_it(depth):
    usable = np.isfinite(depth)
    result = segment(depth, usable, np.ones_like(usable), Settings())
    history = result.history
    grown = history & (PixelHistory.GROWN_FORWARD | PixelHistory.GROWN_BACKWARD) > 0
    dropped_before = history & (PixelHistory.DISTANT | PixelHistory.OUTLIER) > 0
    expected = (history & PixelHistory.DEPTH > 0) & (~dropped_before | grown)
    assert np.array_equal(result.kept, expected & (history & PixelHistory.SPARSE_LINE == 0))
    assert not result.kept[~usable].any()


def test_mean_and_sigma_are_those_of_one_section():
    depth = np.array([[1.0, 1.1, 2.0, np.nan], [3.0, 3.0, 3.0, 3.3]], dtype=np.float32)
    result = segment(depth, np.isfinite(depth), np.ones((2, 4), dtype=bool), ALL_LINES)
    assert result.mean_m[-1] == pytest.approx([1.05, 3.0], abs=1e-6)
    assert result.sigma_m[-1] == pytest.approx([0.05, 0.0], abs=1e-6)
    assert result.removed_in_run.tolist() == [[0, 0, 1, 0], [0, 0, 0, 1]]


def test_three_layers_need_two_runs():
    depth = np.tile(np.repeat([1.0, 2.0, 3.0], 20), (5, 1)).astype(np.float32)
    depth += np.linspace(0, 0.01, depth.shape[1], dtype=np.float32)
    usable = np.ones(depth.shape, dtype=bool)
    result = segment(depth, usable, usable, replace(ALL_LINES, layers=3))
    assert result.mean_m.shape == (2, 5)
    assert result.kept[:, :20].all()
    assert not result.kept[:, 20:].any()
    assert (result.removed_in_run[:, 40:] == 1).all()
    assert (result.removed_in_run[:, 20:28] == 2).all()


def test_counts_say_what_each_step_did():
    depth = np.tile(np.repeat([1.0, 2.0, 3.0], 20), (5, 1)).astype(np.float32)
    depth += np.linspace(0, 0.01, depth.shape[1], dtype=np.float32)
    usable = np.ones(depth.shape, dtype=bool)
    counts = segment(depth, usable, usable, replace(ALL_LINES, layers=3)).counts(2)
    assert counts["distant in run 1"] + counts["distant in run 2"] + counts["kept"] - counts["grown back"] == 60
    assert counts["kept"] == 20
    assert counts["distant in run 1"] >= 20


def test_missing_depth_stops_a_scan():
    depth = np.array([[1.0, 1.0, 1.01, np.nan, 1.02, 1.02, 1.5, 1.5]] * 3, dtype=np.float32)
    result = segment(depth, np.isfinite(depth), np.ones(depth.shape, dtype=bool), ALL_LINES)
    assert not result.kept[:, 3].any()


def test_sparse_longitudinal_lines_are_cut():
    depth = np.full((20, 30), 2.0, dtype=np.float32)
    depth[:, 10:20] = 1.0
    depth[:3, 5:10] = 1.0
    usable = np.ones(depth.shape, dtype=bool)
    result = segment(depth, usable, usable, Settings())
    assert result.kept[:, 10:20].all()
    assert not result.kept[:, :10].any()
    assert (result.history[:3, 5:10] & PixelHistory.SPARSE_LINE > 0).all()


def test_lines_with_little_depth_are_spared_when_coverage_is_asked_for():
    depth = np.full((20, 30), np.nan, dtype=np.float32)
    depth[:, 10:20] = np.linspace(1, 1.02, 20)[:, None]
    depth[:4, 5:10] = 1.0
    depth[4:20, 5:10] = 2.0
    usable = np.isfinite(depth)
    inside = np.ones_like(usable)
    assert not segment(depth, usable, inside, Settings()).kept[:, 7].any()
    assert segment(depth, usable, inside, replace(Settings(), line_coverage=0.5)).kept[:4, 7].all()


def test_sections_may_be_wider_than_a_short_integer_counts():
    depth = np.full((2, 40_000), 2.0, dtype=np.float32)
    depth[:, 38_000:] = np.linspace(1.0, 1.001, 2000)
    usable = np.ones(depth.shape, dtype=bool)
    assert np.flatnonzero(segment(depth, usable, usable, Settings()).kept[0]).tolist() == list(range(38_000, 40_000))

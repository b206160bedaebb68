"""Two things side by side are told from one, whatever its shape."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.bench.accuracy.unanswerable import AREAS
from rotrecon.answer import answer
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from rotrecon.two_objects import shows_two
from tests.recordings import DATA

PITCH_M = 0.001
ROWS = 40
widths = st.integers(20, 90)


def bulge(width_px: int) -> np.ndarray:
    """Depth (width,) across a rod that faces the camera."""
    x = np.linspace(-0.98, 0.98, width_px)
    return 0.8 - width_px / 2 * PITCH_M * np.sqrt(1 - x**2)


def sections(across: np.ndarray, seed: int) -> np.ndarray:
    return across + 0.0005 * np.random.default_rng(seed).standard_normal((ROWS, len(across)))


@given(widths, widths, st.integers(0, 20), st.integers(0, 9))
def test_two_bulges_are_two_things_also_with_a_gap_between(one, other, gap, seed):
    if min(one, other) < max(one, other) / 3:
        return
    across = np.concatenate([bulge(one), np.full(gap, np.nan), bulge(other)])
    assert shows_two(sections(across, seed), PITCH_M)


@given(widths, st.floats(-0.5, 0.5), st.integers(0, 9))
def test_one_bulge_a_tilted_plane_and_the_inside_of_a_pipe_are_one(width, slope, seed):
    tilted = slope * PITCH_M * np.arange(width)
    for across in (bulge(width), 0.8 + tilted, 1.6 - bulge(width)):
        assert not shows_two(sections(across, seed), PITCH_M)


def test_nothing_is_not_two():
    assert not shows_two(np.full((ROWS, 30), np.nan), PITCH_M)


@pytest.mark.parametrize(
    "area", [area for area in AREAS if str(area) in ("simulated: two rods 0", "simulated: two rods 1")], ids=str
)
def test_the_operator_is_told_to_draw_round_one_of_them(area):
    content = answer(reconstruct(*area.load(DATA), Settings()))
    assert content["diameter_mm"] is None
    assert "one of them" in content["reasons"][0]

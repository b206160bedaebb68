"""How far residuals err together: known autocorrelations are found, and what follows from them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotrecon.rays.correlation import LENGTHS_PX, Likeness, likeness_of
from rotrecon.simulation.stereo_noise import correlated_noise

SHAPE = (120, 160)
lengths = st.sampled_from([length for length in LENGTHS_PX if length >= 1.0])


def noise(length_px: float, seed: int, shape: tuple[int, int] = SHAPE) -> np.ndarray:
    return correlated_noise(shape, length_px, np.random.default_rng(seed))


def test_white_noise_is_independent():
    shares = [likeness_of(noise(0.0, seed)).independent_share for seed in range(9)]
    assert np.median(shares) > 0.95
    assert max(shares) == 1.0


@pytest.mark.parametrize("length_px", [1.5, 2.0, 3.0, 4.0])
@pytest.mark.parametrize("seed", range(3))
def test_length_of_correlated_noise_is_found(length_px, seed):
    found = likeness_of(noise(length_px, seed))
    assert found.length_px == length_px
    assert found.alike > 0.9
    assert found.independent_share == pytest.approx(1 / (np.pi * length_px**2), rel=0.1)


def test_noise_of_which_a_part_is_independent():
    mixed = np.sqrt(0.4) * noise(4.0, 1) + np.sqrt(0.6) * noise(0.0, 2)
    found = likeness_of(mixed)
    assert found.length_px == 4.0
    assert found.alike == pytest.approx(0.4, abs=0.05)


def test_what_is_unknown_is_left_out():
    residual = noise(3.0, 4)
    residual[np.random.default_rng(5).random(SHAPE) < 0.5] = np.nan
    assert likeness_of(residual).length_px == 3.0


@pytest.mark.parametrize("residual", [np.zeros(SHAPE), np.full(SHAPE, np.nan), np.ones((2, 2)), np.empty((0, 0))])
def test_what_says_nothing_is_independent(residual):
    assert likeness_of(residual).independent_share == 1.0


@given(st.floats(0.0, 1.0), lengths)
def test_independent_share_is_that_of_a_sum_over_a_plane(alike, length_px):
    """The variance of a mean of n alike errors is sigma^2 / n times the sum of their autocorrelation."""
    reach = np.arange(-60, 61)
    lag2 = (reach**2 + (reach**2)[:, None]).astype(float)
    total = 1.0 + alike * (np.exp(-lag2 / length_px**2).sum() - 1.0)
    assert Likeness(alike, length_px).independent_share == pytest.approx(1 / total, rel=1e-3)


@given(st.floats(0.0, 1.0), lengths, st.integers(0, 99))
def test_smearing_is_a_convolution_whose_sum_is_one_over_the_share(alike, length_px, seed):
    """A vector x, zero near the border, has x' C x = x . smeared(x), and sums to 1 / share times what it did."""
    likeness = Likeness(alike, length_px)
    image = np.zeros((90, 90))
    rows, columns = np.random.default_rng(seed).integers(40, 50, (2, 4))
    image[rows, columns] = 1.0
    smeared = likeness.smeared(image)
    assert smeared.sum() == pytest.approx(image.sum() / likeness.independent_share, rel=0.01)
    places = np.argwhere(image > 0)
    apart2 = ((places[:, None] - places) ** 2).sum(axis=-1)
    covariance = np.where(apart2 == 0, 1.0, alike * np.exp(-apart2 / length_px**2))
    assert (image * smeared).sum() == pytest.approx(covariance.sum(), rel=1e-3, abs=1e-6)


def test_smearing_is_symmetric_and_leaves_independent_errors_alone():
    likeness = Likeness(0.7, 3.0)
    rng = np.random.default_rng(0)
    one, other = rng.normal(size=(2, 40, 50))
    assert (one * likeness.smeared(other)).sum() == pytest.approx((other * likeness.smeared(one)).sum())
    assert Likeness(0.0, 0.0).smeared(one) is one

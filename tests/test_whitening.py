"""Depths less what their neighbours foretell: what is left is independent, and tells sizes more finely."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.bench.accuracy.clouds import CORRELATED, FULL_MODEL, cloud_of, pose_of
from rotrecon.noise import RayNoise
from rotrecon.rays.ball import Ball
from rotrecon.rays.correlation import Likeness, likeness_of
from rotrecon.rays.fitting import UNSCALED, Depths, Prediction
from rotrecon.rays.guard import Task, settle
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.ray_fit import RayFit, Sight, fine
from rotrecon.rays.surfaces import Surface, turn_of
from rotrecon.rays.whitening import Whitened, whitened
from rotrecon.simulation.stereo_noise import correlated_noise
from tests.bodies import CONE, CYLINDER, Body, body_at, depth_of, drawing_round, noisy_frame, patch_seen

SHAPE = (9, 11)
BALL = Ball(np.array([0.0, 0.0, 1.0]), 0.1, 700.0)
"""Any surface: what is left of depths is the same."""
likenesses = st.builds(Likeness, st.floats(0.0, 1.0), st.sampled_from([0.7, 2.0, 4.0, 8.0]))
masks = arrays(np.bool_, SHAPE)


@dataclass(frozen=True, eq=False)
class Errors(Depths):
    """Depths that are off by what they are told to be, and have derivatives as told."""

    columns: np.ndarray

    def predict(self, surface: Surface) -> Prediction:
        return Prediction(self.columns, UNSCALED, self.steps)


def whitened_errors(
    errors: np.ndarray, mask: np.ndarray, likeness: Likeness, columns: np.ndarray | None = None
) -> Whitened:
    """Errors (h, w) of the pixels of a mask (h, w)."""
    pixels = np.flatnonzero(mask).astype(np.int32)
    values = errors.ravel()[pixels]
    derivatives = np.zeros((1, len(pixels))) if columns is None else columns
    return whitened(
        Errors(np.zeros((3, len(pixels))), values, RayNoise(1.0, 0.0, 0.0, True), derivatives),
        pixels,
        mask.shape,
        likeness,
    )


@settings(deadline=None)
@given(masks, likenesses, st.integers(0, 99))
def test_weights_of_what_is_left_return_to_the_depths(mask, likeness, seed):
    """Summed with weights, what is left of errors is the errors with the weights returned."""
    rng = np.random.default_rng(seed)
    errors, weights = rng.normal(size=SHAPE), rng.normal(size=(1, int(mask.sum())))
    own = whitened_errors(errors, mask, likeness)
    assert weights @ own.predict(BALL).residual == pytest.approx(own.returned(weights) @ errors[mask])


@settings(deadline=None)
@given(masks, likenesses, st.integers(0, 99))
def test_derivatives_are_those_of_what_is_left(mask, likeness, seed):
    rng = np.random.default_rng(seed)
    errors, columns = rng.normal(size=SHAPE), rng.normal(size=(3, int(mask.sum())))
    own = whitened_errors(errors, mask, likeness, columns)
    for number, column in enumerate(columns):
        image = np.zeros(SHAPE)
        image[mask] = column
        moved = whitened_errors(image, mask, likeness).predict(BALL).residual
        np.testing.assert_allclose(own.predict(BALL).columns[number], moved, atol=1e-9)


@pytest.mark.parametrize("length_px", [1.5, 2.0, 3.0])
def test_errors_of_known_likeness_become_independent_and_stay_as_large(length_px):
    rng = np.random.default_rng(1)
    shape = (120, 160)
    errors = np.sqrt(0.8) * correlated_noise(shape, length_px, rng) + np.sqrt(0.2) * rng.normal(size=shape)
    left = whitened_errors(errors, np.ones(shape, dtype=np.bool_), Likeness(0.8, length_px)).predict(BALL).residual
    assert likeness_of(errors).alike > 0.7
    assert likeness_of(left.reshape(shape)).alike < 0.1
    assert np.std(left) == pytest.approx(1.0, abs=0.05)


def test_independent_errors_stay_as_they_are():
    errors = np.random.default_rng(2).normal(size=SHAPE)
    own = whitened_errors(errors, np.ones(SHAPE, dtype=np.bool_), Likeness(0.0, 0.0))
    np.testing.assert_allclose(own.predict(BALL).residual, errors.ravel(), atol=1e-12)


def radius_m(fit: RayFit, body: Body) -> float:
    """Of a lateral fit, in the middle of a body."""
    assert isinstance(fit.surface, Lateral)
    return float(fit.surface.radius_m + fit.surface.slope * fit.surface.heights(body.center_m[None])[0])


@pytest.mark.parametrize(("knees", "slope"), [(CYLINDER, 0.0), (CONE, 0.1875)], ids=["cylinder", "cone"])
def test_differences_tell_sizes_more_finely_and_know_it(knees, slope):
    body = body_at(knees, 3)
    depth_m, drawing = depth_of(body.solids()), drawing_round(body, body.low_m + 0.01, body.high_m - 0.01)
    start = body.lateral(0.0, slope, slope != 0)
    free, units = np.ones(len(start.units(1.0)), dtype=np.bool_), start.units(0.2)
    radii, said = np.empty((2, 12)), np.empty((2, 12))
    for seed in range(12):
        patch = patch_seen(noisy_frame(depth_m, seed, 0.15, 4.0), drawing)
        for number, sight in enumerate((Sight(), Sight(differences=True))):
            fit = fine(start, patch, units, free, sight)
            assert fit is not None
            radii[number, seed], said[number, seed] = radius_m(fit, body), np.sqrt(fit.covariance[4, 4])
    spread = np.sqrt(np.mean(np.square(radii - float(body.radius_at(np.array(0.0)))), axis=1))
    assert spread[1] < 0.6 * spread[0]
    assert np.median(said[1]) < 0.7 * np.median(said[0])


@pytest.mark.parametrize("cell", [*CORRELATED, FULL_MODEL], ids=lambda cell: cell.noise)
def test_differences_are_believed_only_where_limbs_do_not_mislead(cell):
    pose = pose_of("leg", 3)
    cloud, truth = cloud_of(pose, cell), pose.solid
    start = Lateral(truth.center_m, turn_of(truth.direction, -truth.center_m), 0.017, 0.0, 700.0, tapers=False)
    patch = patch_seen(cloud.frame, cloud.drawing)
    fit = settle(start, Task(patch, start.units(0.2), np.ones(5, dtype=np.bool_), ()))
    assert fit is not None
    assert fit.sight.differences == (cell != FULL_MODEL)
    if fit.sight.differences:
        assert abs(fit.surface.size_m - 0.018) < 3 * np.sqrt(fit.covariance[4, 4]) < 0.01 * 0.018

"""What is seen far behind an object limits its size, and nothing else does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.bench.accuracy.clouds import Cell, cloud_of, pose_of
from rotrecon.rays.ball import Ball
from rotrecon.rays.guard import Task, settle
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.passing import Passing, seen_behind
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import Sight, fine
from rotrecon.rays.surfaces import Surface, turn_of
from tests.bodies import CYLINDER, body_at, depth_of, drawing_round, noisy_frame, patch_seen

BODY = body_at(CYLINDER, 5)
PIPE = BODY.lateral()
BALL = Ball(np.array([0.02, -0.01, 0.7]), 0.035, 700.0)
few = settings(max_examples=20, deadline=None)


def as_wide(radius_m: float) -> Lateral:
    return Lateral(PIPE.center_m, PIPE.turn, radius_m, 0.0, PIPE.focal_px, tapers=False)


@pytest.fixture(scope="module")
def patch() -> Patch:
    """A cylinder of which every twentieth pixel, at random, sees what is far behind through it."""
    depth_m = depth_of(BODY.solids())
    outlier = np.random.default_rng(1).random(depth_m.shape) < 1 / 20
    far_m = np.where(outlier, depth_m.max(), depth_m)
    return patch_seen(noisy_frame(far_m, 0), drawing_round(BODY, BODY.low_m + 0.01, BODY.high_m - 0.01))


def test_what_is_seen_beside_an_object_asks_for_nothing_of_its_true_size(patch):
    passing, border = seen_behind(PIPE, patch, 1.0)
    assert passing.rays.shape[1] > 500
    residual = passing.predict(PIPE).residual
    assert np.mean(residual > 0.1) < 0.003, "hardly an outlier is believed"
    assert np.abs(np.median(border.predict(PIPE).residual * border.sigma_px)) < 1.0


@few
@given(st.floats(1.02, 1.3))
def test_a_surface_that_would_hide_what_is_seen_is_too_large(patch, growth):
    passing, _ = seen_behind(PIPE, patch, 1.0)
    told = passing.predict(as_wide(growth * PIPE.radius_m))
    assert (told.residual > 0).sum() > 50
    assert told.columns[4] @ told.residual < 0, "the residual is predicted to shrink with the radius"
    assert np.mean(passing.predict(as_wide(PIPE.radius_m / growth)).residual > 0) < 0.003


@pytest.mark.parametrize("surface", [PIPE, BALL], ids=["pipe", "ball"])
def test_derivatives_are_those_of_how_far_rays_pass_inside(surface: Surface):
    rng = np.random.default_rng(3)
    toward = surface.center_m / surface.center_m[2]
    rays = np.stack([*(toward[:2, None] + rng.uniform(-0.08, 0.08, (2, 9000))), np.ones(9000)])
    # nearer to the outline than that it counts, and the scale hardly changes
    near_px = np.abs(surface.gap(rays)[0]) * 1000
    passing, step = Passing(np.ascontiguousarray(rays[:, near_px < 1]), 700.0), 1e-7
    told = passing.predict(surface)
    assert (told.residual > 0).sum() > 20
    assert (told.residual == 0).sum() > 20
    for number, column in enumerate(told.columns):
        move = np.zeros(len(told.columns))
        move[number] = step
        ahead, behind = (passing.predict(surface.stepped(way * move)).residual for way in (1, -1))
        # a residual is seen less predicted
        np.testing.assert_allclose(-(ahead - behind) / (2 * step), column, rtol=0.03, atol=0.03 * np.abs(column).max())


@pytest.mark.parametrize("seed", [23, 85, 134])
def test_a_wire_of_which_little_is_seen_is_not_thicker_than_the_wall_beside_it_lets_it_be(seed):
    cloud = cloud_of(pose_of("wire", seed), Cell("white", 0.5, 0.2, 120.0))
    patch = patch_seen(cloud.frame, cloud.drawing)
    truth = cloud.truth
    start = Lateral(truth.center_m, turn_of(truth.direction, -truth.center_m), truth.radius_m, 0.0, 700.0, tapers=False)
    free, units = np.ones(5, dtype=np.bool_), start.units(0.4)
    limited = settle(start, Task(patch, units, free, ()))
    assert limited is not None
    assert limited.sight.limited
    assert -0.1 < limited.surface.size_m / truth.radius_m - 1 < 0.02
    freely = fine(start, patch, units, free, Sight())
    assert freely is not None
    assert freely.surface.size_m > 1.05 * truth.radius_m, "depths alone would have it"

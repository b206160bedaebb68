"""A fit refined against the pictures: laws of what is made of it."""

from dataclasses import replace

import numpy as np
import pytest

from rotrecon.outcome import Fit
from rotrecon.photometry.refinement import others_of, refined, sought, weighed
from rotrecon.rays.hypotheses import Held
from rotrecon.rays.robust import Ranked
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from tests.carried import ASIDE, off, refinement_of, sigma_of, turned
from tests.pairs import BALL, CONE, LEG, pair


@pytest.mark.parametrize(("shape", "most"), [(LEG, 0.01), (BALL, 0.006), (CONE, 0.012)], ids=["leg", "ball", "cone"])
def test_a_surface_that_is_off_comes_home(shape, most):
    for seed in (1, 2):
        one = pair(shape, "fine", seed)
        found = refinement_of(one, off(one.surface))
        error = found.climbed.surface.size_m / one.surface.size_m - 1
        assert abs(error) < most
        assert abs(error) * one.surface.size_m < 3.5 * sigma_of(found)
        assert sigma_of(found) < most * one.surface.size_m


def test_gain_and_offset_of_a_picture_do_not_move_the_answer():
    one = pair(LEG, "fine", 3)
    first, second = one.frame.views
    dimmed = np.rint(0.8 * second.image.astype(float) + 12).astype(np.uint8)
    changed = replace(one.frame, views=(first, replace(second, image=dimmed)))
    plain, dim = (refinement_of(one, off(one.surface), frame) for frame in (None, changed))
    assert abs(plain.climbed.surface.size_m - dim.climbed.surface.size_m) < sigma_of(plain)


def test_a_strip_that_is_hidden_does_not_move_the_answer():
    one = pair(LEG, "fine", 3)
    first, second = one.frame.views
    hidden = second.image.copy()
    hidden[:, 95:107] = (30, 160, 40)
    changed = replace(one.frame, views=(first, replace(second, image=hidden)))
    plain, cut = (refinement_of(one, off(one.surface), frame) for frame in (None, changed))
    apart = abs(plain.climbed.surface.size_m - cut.climbed.surface.size_m)
    assert apart < 1.96 * np.hypot(sigma_of(plain), sigma_of(cut))


def test_the_answer_is_the_same_wherever_the_base_is():
    T = turned(ASIDE)
    T[:3, 3] = (0.7, -2.0, 0.4)
    here, there = pair(CONE, "fine", 1), pair(CONE, "fine", 1, T_base_camera=T)
    first, second = (refinement_of(one, off(one.surface)).climbed.surface for one in (here, there))
    assert np.allclose(first.center_m, second.center_m, atol=1e-9)
    assert first.size_m == pytest.approx(second.size_m, abs=1e-9)


def test_a_third_view_makes_the_answer_surer_and_no_more_than_it_may():
    three = pair(LEG, "fine", 2, baselines_m=(0.0, 0.06, 0.12))
    two = replace(three.frame, views=three.frame.views[:2])
    more, less = refinement_of(three, off(three.surface)), refinement_of(three, off(three.surface), two)
    assert 0.2 * sigma_of(less) < sigma_of(more) < sigma_of(less)


def test_depth_that_the_pictures_tell_is_nearer_to_the_truth_than_what_was_matched():
    one = pair(LEG, "fine", 1)
    scene = one.scene()
    found = refinement_of(one, off(one.surface))
    changed = (found.depth_m != scene.patch.depth_m) & np.isfinite(scene.patch.depth_m)
    exact = one.surface.trace(scene.patch.rays).depth_m
    assert changed.sum() > 500
    before, after = (np.std((depth - exact)[changed]) for depth in (scene.patch.depth_m, found.depth_m))
    assert after < 0.5 * before


def test_without_another_view_there_is_nothing_to_refine_against():
    one = pair(LEG, "fine", 1)
    scene = one.scene()
    fit = one.fit_from(scene, one.surface)
    assert others_of(replace(one.frame, views=one.frame.views[:1])) == ()
    assert others_of(replace(one.frame, views=())) == ()
    assert refined(Ranked("cylinder", one.surface, fit, 0.0), scene, ()) is None


def test_the_drawing_and_the_pictures_alone_lead_to_the_object():
    one = pair(LEG, "fine", 4)
    scene = one.scene()
    fit = one.fit_from(scene, one.surface)
    wrong = replace(scene, patch=replace(scene.patch, depth_m=np.full_like(scene.patch.depth_m, 0.6)))
    found = weighed(sought(wrong, Held(None, None), fit, others_of(one.frame)))
    assert found[0].shape.shape in ("cylinder", "cone")
    assert found[0].shape.cost == 0.0
    assert found[0].climbed.surface.size_m == pytest.approx(one.surface.size_m, rel=0.02)


@pytest.mark.parametrize("views", [0, 2])
def test_the_whole_path_is_closer_with_the_pictures_than_without(views):
    one = pair(LEG, "fine", 5)
    result = reconstruct(replace(one.frame, views=one.frame.views[:views]), one.drawing, Settings())
    assert isinstance(result.fit, Fit)
    error = result.fit.solid.radius_m / one.surface.size_m - 1
    low, high = result.fit.intervals.diameter_m
    assert low <= 2 * one.surface.size_m <= high
    assert abs(error) < (0.006 if views else 0.05)


@pytest.mark.parametrize(("share", "kept"), [(0.9, True), (0.5, False)])
def test_a_fit_whose_size_the_pictures_change_by_much_was_no_start(share, kept):
    one = pair(LEG, "fine", 1)
    scene = one.scene()
    narrow = replace(one.surface, radius_m=share * one.surface.size_m)
    found = refined(Ranked("cylinder", narrow, one.fit_from(scene, narrow), 0.0), scene, others_of(one.frame))
    assert (found is not None) == kept

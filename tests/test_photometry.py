"""Refinement against the pictures: laws of its parts, and of what it makes of a fit."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.arrays import Floats
from rotrecon.camera import inverse, transform
from rotrecon.frame import View
from rotrecon.outcome import Fit
from rotrecon.photometry.agreement import Agreement, shades_of
from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.outlines import CarriedOutline
from rotrecon.photometry.refinement import Refinement, others_of, refined, sought, weighed
from rotrecon.photometry.smearing import smeared_apart
from rotrecon.photometry.splines import SCIPY, SUPPORT_PX, Spline, spline_of
from rotrecon.photometry.sureness import outlined, sigma_by_outline
from rotrecon.photometry.visible import clear_of, outward, seen_too
from rotrecon.rays.ball import Ball
from rotrecon.rays.fitting import Outline
from rotrecon.rays.hypotheses import Held
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.limbs import limbs_of
from rotrecon.rays.robust import Ranked
from rotrecon.rays.surfaces import Surface, turn_of
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from tests.pairs import BALL, CAMERA, CONE, LEG, Pair, painted, pair

ASIDE = np.array([[0.998, 0.02, -0.06, -0.06], [-0.02, 0.9998, 0.0, 0.004], [0.06, 0.0012, 0.998, 0.01], [0, 0, 0, 1]])


def turned(T: Floats) -> Floats:
    """The same pose with an exact rotation."""
    left, _, right = np.linalg.svd(T[:3, :3])
    result = T.copy()
    result[:3, :3] = left @ right
    return result


CARRIER = Carrier(CAMERA, turned(ASIDE))
LEANING = np.array([0.3, 0.9, 0.2]) / np.linalg.norm([0.3, 0.9, 0.2])
MIDDLE = np.array([0.01, 0.0, 0.4])
SURFACES: list[Surface] = [
    Lateral(MIDDLE, turn_of(LEANING, -MIDDLE), 0.03, 0.0, CAMERA.focal_px, tapers=False),
    Lateral(MIDDLE, turn_of(LEANING, -MIDDLE), 0.04, 0.2, CAMERA.focal_px, tapers=True),
    Ball(MIDDLE, 0.05, CAMERA.focal_px),
]


def agreement_of(surface: Surface) -> Agreement:
    """Of pictures painted without error, over the pixels that both cameras see well."""
    v, u = np.indices((CAMERA.height, CAMERA.width)).reshape(2, -1)
    rays = CAMERA.unproject(np.stack([u, v], axis=-1), np.ones(u.size)).T
    usable = surface.trace(rays).hit & (surface.off_middle(rays) < 0.7)
    usable[usable] = seen_too(surface, rays[:, usable], CARRIER)
    other = Spline(SCIPY.spline_filter(painted(surface, CAMERA, CARRIER.T_view_reference)), np.zeros(2))
    usable &= other.within(CARRIER.carried(rays, surface.trace(rays).depth_m)[0])
    grey = painted(surface, CAMERA, np.eye(4)).ravel()[usable]
    shades = shades_of(outward(surface, (rays * surface.trace(rays).depth_m)[:, usable]))
    return Agreement(rays[:, usable], grey, shades, other, CARRIER)


@pytest.mark.parametrize("surface", SURFACES, ids=["cylinder", "cone", "ball"])
def test_pictures_agree_that_are_blurred_along_their_own_pixels(surface):
    blur_px = 2.0
    exact = agreement_of(surface)
    there, _ = CARRIER.carried(exact.rays, surface.meet(exact.rays)[0])
    size = np.array([[CAMERA.width], [CAMERA.height]])
    # what is beyond a picture's border is not in its blur
    inside = [(one > 4 * blur_px) & (one < size - 4 * blur_px) for one in (CAMERA.project(exact.rays.T).T, there)]
    exact = exact.chosen(np.concatenate(inside).all(axis=0))
    pictures = [painted(surface, CAMERA, pose) for pose in (np.eye(4), CARRIER.T_view_reference)]
    first, second = (cv2.GaussianBlur(picture, (0, 0), blur_px) for picture in pictures)
    place = np.rint(CAMERA.project(exact.rays.T)).astype(int)
    other = Spline(SCIPY.spline_filter(second), np.zeros(2))
    grey = first[place[:, 1], place[:, 0]]
    lacking = smeared_apart(surface, exact.rays, CAMERA, CARRIER, other, blur_px)
    apart, together = (
        np.std(replace(exact, grey=one, other=other).predict(surface).residual) for one in (grey, grey - lacking)
    )
    assert together < 0.4 * apart


def refinement_of(one: Pair, start: Surface, frame=None) -> Refinement:
    scene = one.scene()
    fit = one.fit_from(scene, start)
    shape = "sphere" if isinstance(start, Ball) else "cone" if start.tapers else "cylinder"
    found = refined(Ranked(shape, start, fit, 0.0), scene, others_of(frame or one.frame))
    assert found is not None
    return found


def off(surface: Surface, share: float = 0.04) -> Surface:
    """A surface that a matcher might have led to: too wide, too far, a little turned."""
    step = np.zeros(len(surface.units(1.0)))
    step[-2 if isinstance(surface, Lateral) and surface.tapers else -1] = share * surface.size_m
    step[1] = 0.002
    return surface.stepped(step)


def sigma_of(found: Refinement) -> float:
    place = 3 if isinstance(found.climbed.surface, Ball) else 4
    fit = found.shape.fit
    assert fit is not None
    return float(np.sqrt(fit.covariance[place, place]))


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10**6))
def test_a_spline_passes_through_the_pixels_and_knows_its_own_slope(seed):
    rng = np.random.default_rng(seed)
    image = rng.integers(0, 256, (30, 40, 3), dtype=np.uint8)
    spline = spline_of(image, np.zeros(2), np.array([39.0, 29.0]), 0.0)
    whole = rng.integers(8, 22, (2, 20)).astype(np.float64)
    grey = image[whole[1].astype(int), whole[0].astype(int)] @ np.array([0.299, 0.587, 0.114])
    assert np.allclose(spline.at(whole).grey, grey, atol=1e-6)
    place = rng.uniform(SUPPORT_PX + 0.1, 25, (2, 20))
    small = np.array([[1e-5], [0.0]])
    at = spline.at(place)
    assert np.allclose(at.by_u, (spline.at(place + small).grey - spline.at(place - small).grey) / 2e-5, atol=1e-4)
    small = small[::-1]
    assert np.allclose(at.by_v, (spline.at(place + small).grey - spline.at(place - small).grey) / 2e-5, atol=1e-4)


def test_points_are_carried_to_where_the_other_camera_sees_them():
    rays = np.stack([np.linspace(-0.2, 0.2, 9), np.linspace(0.1, -0.1, 9), np.ones(9)])
    depth = np.linspace(0.3, 0.6, 9)
    place, by_depth = CARRIER.carried(rays, depth)
    assert np.allclose(place.T, CAMERA.project(transform(CARRIER.T_view_reference, (rays * depth).T)))
    change = (CARRIER.carried(rays, depth + 1e-7)[0] - CARRIER.carried(rays, depth - 1e-7)[0]) / 2e-7
    assert np.allclose(by_depth, change, rtol=1e-5, atol=1e-3)
    assert np.allclose(transform(CARRIER.T_view_reference, CARRIER.center_m), 0)


@pytest.mark.parametrize("surface", SURFACES, ids=["cylinder", "cone", "ball"])
def test_pictures_without_error_agree_at_the_truth_whatever_their_gain_and_offset(surface):
    agreement = agreement_of(surface)
    assert len(agreement) > 500
    assert np.abs(agreement.predict(surface).residual).max() < 0.3
    dimmed = replace(agreement, grey=0.7 * agreement.grey + 20)
    assert np.abs(dimmed.predict(surface).residual).max() < 0.3
    assert np.abs(agreement.predict(off(surface)).residual).max() > 3


@pytest.mark.parametrize("surface", SURFACES, ids=["cylinder", "cone", "ball"])
def test_the_derivatives_of_brightness_are_its_differences(surface):
    agreement = agreement_of(surface)
    # with noise, which small steps do not make any pixel an outlier of
    noise = 0.3 * np.random.default_rng(2).standard_normal(len(agreement))
    agreement = replace(agreement, grey=agreement.grey + noise)
    columns = agreement.predict(surface).columns
    for number, unit in enumerate(np.eye(len(surface.units(1.0)))):
        there, back = (agreement.predict(surface.stepped(sign * 1e-6 * unit)).residual for sign in (1, -1))
        # which leave out that the weights of gain, offset and shades change too
        assert np.allclose(columns[number], (back - there) / 2e-6, atol=0.04 * np.abs(columns[number]).max())


@pytest.mark.parametrize("surface", SURFACES, ids=["cylinder", "cone", "ball"])
def test_an_outline_seen_by_another_camera_has_the_derivatives_of_its_differences(surface):
    rng = np.random.default_rng(4)
    rays = np.concatenate([rng.uniform(-0.3, 0.3, (2, 9000)), np.ones((1, 9000))])
    edges = CarriedOutline(Outline(rays, np.ones(9000), CAMERA.focal_px), CARRIER)
    edges = edges.chosen(np.abs(edges.predict(surface).residual) < 0.4)
    assert len(edges) > 20
    columns = edges.predict(surface).columns
    for number, unit in enumerate(np.eye(len(surface.units(1.0)))):
        there, back = (edges.predict(surface.stepped(sign * 1e-6 * unit)).residual for sign in (1, -1))
        assert np.allclose(columns[number], (back - there) / 2e-6, atol=0.05 * np.abs(columns[number]).max())


def test_pixels_that_the_other_camera_sees_from_aside_are_left_out():
    scene = pair(LEG, seed=1).scene()
    surface = pair(LEG, seed=1).surface
    rays = scene.patch.rays[:, clear_of(surface, scene.patch)]
    far = np.eye(4)
    far[0, 3] = -0.5
    seen = seen_too(surface, rays, Carrier(CAMERA, far))
    assert seen_too(surface, rays, Carrier(CAMERA, np.eye(4))).all()
    assert 0 < seen.sum() < len(seen)


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


@pytest.mark.parametrize("shape", [LEG, BALL], ids=["leg", "ball"])
def test_a_plain_object_sought_by_its_pictures_is_doubted_or_right(shape):
    for seed in (1, 2):
        one = pair(shape, "plain", seed)
        scene = one.scene()
        fit = one.fit_from(scene, one.surface)
        unknown = replace(scene, patch=replace(scene.patch, depth_m=np.full_like(scene.patch.depth_m, np.nan)))
        for best in weighed(sought(unknown, Held(None, None), fit, others_of(one.frame)))[:1]:
            error_m = abs(best.climbed.surface.size_m - one.surface.size_m)
            assert error_m < 3.5 * sigma_of(best) or best.doubts
            assert sigma_of(best) > 0.003 * one.surface.size_m or error_m < 0.003 * one.surface.size_m


def test_a_camera_at_the_same_place_is_carried_to_itself():
    view = View(np.zeros((CAMERA.height, CAMERA.width, 3), dtype=np.uint8), CAMERA, turned(ASIDE))
    frame = replace(pair().frame, T_base_camera=turned(ASIDE), views=(view, view))
    carrier = others_of(frame)[0].carrier
    assert np.allclose(carrier.T_view_reference, np.eye(4))
    assert np.allclose(inverse(carrier.T_view_reference), np.eye(4))


def outline_of(surface: Surface, focal_px: float) -> Outline:
    """The limbs of a surface as a camera sees them, to a tenth of a pixel."""
    point_px = limbs_of(surface, CAMERA, np.linspace(-0.1, 0.1, 41)).point_px
    return Outline(CAMERA.unproject(point_px, np.ones(len(point_px))).T, np.full(len(point_px), 0.1), focal_px)


def test_outlines_along_the_line_between_the_cameras_tell_no_size():
    T_view_reference = np.eye(4)
    T_view_reference[0, 3] = -0.06
    carrier = Carrier(CAMERA, T_view_reference)
    sigma_m: list[float] = []
    for direction in (np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])):
        surface = Lateral(MIDDLE, turn_of(direction, -MIDDLE), 0.03, 0.0, CAMERA.focal_px, tapers=False)
        seen = outline_of(surface, CAMERA.focal_px)
        other = CarriedOutline(outline_of(carrier.surface(surface), CAMERA.focal_px), carrier)
        sigma_m.append(sigma_by_outline(surface, [seen, other], np.ones(5, dtype=np.bool_), 0.2))
        assert sigma_by_outline(surface, [seen], np.ones(5, dtype=np.bool_), 0.2) > 0.1 * surface.radius_m
    across, along = sigma_m
    assert across < 0.01 * 0.03
    assert along > 0.1 * 0.03


@pytest.mark.parametrize("wrong_px", [0.0, 3.0])
def test_outlines_that_lie_apart_tell_no_size(wrong_px):
    carrier = Carrier(CAMERA, turned(ASIDE))
    surface = Lateral(MIDDLE, turn_of(np.array([0.0, 1.0, 0.0]), -MIDDLE), 0.03, 0.0, CAMERA.focal_px, tapers=False)
    free = np.ones(5, dtype=np.bool_)
    wider = replace(carrier.surface(surface), radius_m=0.03 + wrong_px * MIDDLE[2] / CAMERA.focal_px)
    seen = outline_of(surface, CAMERA.focal_px)
    other = CarriedOutline(outline_of(wider, CAMERA.focal_px), carrier)
    assert sigma_by_outline(surface, [seen, other], free, 0.2) < 0.01 * 0.03
    assert outlined(surface, [seen, other], free, 0.2) == (wrong_px == 0.0)


def test_an_arc_of_a_ball_tells_no_size():
    ball, free = Ball(MIDDLE, 0.05, CAMERA.focal_px), np.ones(4, dtype=np.bool_)
    carrier = Carrier(CAMERA, turned(ASIDE))
    both = [
        outline_of(ball, CAMERA.focal_px),
        CarriedOutline(outline_of(carrier.surface(ball), CAMERA.focal_px), carrier),
    ]
    assert outlined(ball, both, free, 0.1)
    assert not outlined(ball, [one.chosen(np.arange(len(one)) < len(one) // 3) for one in both], free, 0.1)
    assert not outlined(ball, [], free, 0.1)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_plain_ball_is_as_wide_as_its_outlines(seed):
    one = pair(BALL, "plain", seed)
    found = refinement_of(one, off(one.surface, 0.02))
    assert found.held
    assert found.climbed.surface.size_m == pytest.approx(one.surface.size_m, rel=0.01)

"""What pictures from several places have in common: laws of the parts of a refinement against them."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.camera import inverse, transform
from rotrecon.frame import View
from rotrecon.photometry.agreement import Agreement, shades_of
from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.outlines import CarriedOutline
from rotrecon.photometry.refinement import others_of
from rotrecon.photometry.smearing import smeared_apart
from rotrecon.photometry.splines import SCIPY, SUPPORT_PX, Spline, spline_of
from rotrecon.photometry.visible import clear_of, outward, seen_too
from rotrecon.rays.fitting import Outline
from rotrecon.rays.surfaces import Surface
from tests.carried import ASIDE, CARRIER, SURFACES, off, turned
from tests.pairs import CAMERA, LEG, painted, pair


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


def test_a_camera_at_the_same_place_is_carried_to_itself():
    view = View(np.zeros((CAMERA.height, CAMERA.width, 3), dtype=np.uint8), CAMERA, turned(ASIDE))
    frame = replace(pair().frame, T_base_camera=turned(ASIDE), views=(view, view))
    carrier = others_of(frame)[0].carrier
    assert np.allclose(carrier.T_view_reference, np.eye(4))
    assert np.allclose(inverse(carrier.T_view_reference), np.eye(4))

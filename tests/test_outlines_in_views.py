"""Sizes that outlines in several pictures tell, of plain objects above all."""

from dataclasses import replace

import numpy as np
import pytest

from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.outlines import CarriedOutline
from rotrecon.photometry.refinement import others_of, sought, weighed
from rotrecon.photometry.sureness import outlined, sigma_by_outline
from rotrecon.rays.ball import Ball
from rotrecon.rays.fitting import Outline
from rotrecon.rays.hypotheses import Held
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.limbs import limbs_of
from rotrecon.rays.surfaces import Surface, turn_of
from tests.carried import ASIDE, MIDDLE, off, refinement_of, sigma_of, turned
from tests.pairs import BALL, CAMERA, LEG, pair


def outline_of(surface: Surface, focal_px: float) -> Outline:
    """The limbs of a surface as a camera sees them, to a tenth of a pixel."""
    point_px = limbs_of(surface, CAMERA, np.linspace(-0.1, 0.1, 41)).point_px
    return Outline(CAMERA.unproject(point_px, np.ones(len(point_px))).T, np.full(len(point_px), 0.1), focal_px)


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

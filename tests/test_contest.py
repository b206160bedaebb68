"""Edges of something else, to which an outline was taken: texture has the last word."""

from dataclasses import replace

import numpy as np
import pytest

from rotrecon.photometry import climbing
from rotrecon.photometry.climbing import Climbed, climb, edges_of
from rotrecon.photometry.refinement import others_of
from rotrecon.photometry.sureness import covariance_of
from rotrecon.rays.fitting import Outline
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.limbs import limbs_of
from rotrecon.simulation.surfaces import Texture
from tests.pairs import CONE, Pair, pair

ALL = np.ones(6, dtype=np.bool_)
WRONG_SLOPE = 0.05
"""By which the cone would be steeper whose outline stands in for the true one."""


def climbed_in(one: Pair) -> Climbed:
    found = climb(one.surface, ALL, 1.0, one.scene(), others_of(one.frame))
    assert found is not None
    return found


def sigma_of(found: Climbed, shape: tuple[int, int]) -> float:
    """Standard error of the slope."""
    matches = tuple(zip(found.matches, found.sharpened.changes, strict=True))
    covariance = covariance_of(found.surface, matches, found.edges, found.free, shape)
    return float(np.sqrt(covariance[5, 5]))


def false_edges(one: Pair) -> Outline:
    """The outline of a cone of another half angle in the reference picture."""
    assert isinstance(one.surface, Lateral)
    camera, false = one.frame.camera, replace(one.surface, slope=one.surface.slope + WRONG_SLOPE)
    point_px = limbs_of(false, camera, np.linspace(-0.06, 0.06, 121)).point_px
    rays = camera.unproject(point_px, np.ones(len(point_px))).T
    return Outline(np.ascontiguousarray(rays), np.full(len(point_px), 0.3), camera.focal_px)


@pytest.mark.parametrize("always", [False, True], ids=["at first", "wherever they are sought"])
def test_a_cone_whose_outline_is_something_elses_is_where_its_texture_has_it(monkeypatch, always):
    one = pair(CONE, "coarse", 1)
    false = false_edges(one)
    calls: list[int] = []

    def edges(surface, scene, others):
        calls.append(1)
        return [false] if always or len(calls) == 1 else edges_of(surface, scene, others)

    monkeypatch.setattr(climbing, "edges_of", edges)
    found = climbed_in(one)
    assert isinstance(found.surface, Lateral)
    sigma = sigma_of(found, one.scene().patch.shape)
    assert sigma < WRONG_SLOPE / 4
    assert isinstance(one.surface, Lateral)
    assert abs(found.surface.slope - one.surface.slope) < 3 * sigma
    assert found.contested == always
    assert bool(found.edges) != always


def test_texture_does_not_contest_an_objects_own_outline():
    textures: tuple[Texture, ...] = ("fine", "coarse", "weak")
    for seed, texture in enumerate(textures):
        assert not climbed_in(pair(CONE, texture, seed)).contested

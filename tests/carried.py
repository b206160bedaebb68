"""Surfaces seen by a second camera, aside of the first and turned, and what is made of a pair of pictures of them."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.refinement import Refinement, others_of, refined
from rotrecon.rays.ball import Ball
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.robust import Ranked
from rotrecon.rays.surfaces import Surface, turn_of
from tests.pairs import CAMERA, Pair

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

"""Boxes in every attitude, and bars that are not round."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.primitives import Frustum, Sphere
from rotrecon.simulation.arrangements.placing import (
    AHEAD,
    Arrangement,
    Maker,
    before_camera,
    direction,
    log_uniform,
    standing,
)
from rotrecon.simulation.raycast import Box, Prism, Stretched

THIN_M, THICK_M = 0.015, 0.3
"""Smallest and largest box."""


def face_on(rng: np.random.Generator) -> Arrangement:
    """A box that shows one face."""
    return _box(rng, rng.uniform(-4, 4), direction(rng, 5))


def edge_on(rng: np.random.Generator) -> Arrangement:
    """A box that shows two faces alike, the edge between them drawn as an axis."""
    return _box(rng, 45 + rng.uniform(-8, 8), direction(rng, 25), slimmest=0.8)


def corner_on(rng: np.random.Generator) -> Arrangement:
    """A box that shows three faces."""
    return _box(rng, 45 + rng.uniform(-10, 10), direction(rng, 50, 25), slimmest=0.7)


def any_box(rng: np.random.Generator) -> Arrangement:
    """A box in any attitude, drawn along any of its edges."""
    return _box(rng, rng.uniform(0, 90), direction(rng, 60))


def square_bar(rng: np.random.Generator) -> Arrangement:
    """A bar of square section."""
    half_m = log_uniform(rng, THIN_M, 0.1) / 2
    return _bar(Box((half_m, half_m, rng.uniform(0.15, 0.25))), rng)


def flat_bar(rng: np.random.Generator) -> Arrangement:
    """A bar of rectangular section."""
    half_m = log_uniform(rng, THIN_M, 0.1) / 2
    return _bar(Box((half_m, half_m * rng.uniform(0.3, 0.8), rng.uniform(0.15, 0.25))), rng)


def three_sided_bar(rng: np.random.Generator) -> Arrangement:
    """A bar of triangular section."""
    return _bar(Prism(3, log_uniform(rng, THIN_M, 0.08) / 3, rng.uniform(0.3, 0.5)), rng)


def six_sided_bar(rng: np.random.Generator) -> Arrangement:
    """A bar of hexagonal section, thick enough for its sides to be told apart."""
    return _bar(Prism(6, rng.uniform(0.04, 0.1), rng.uniform(0.3, 0.4)), rng)


def pyramid(rng: np.random.Generator) -> Arrangement:
    """The frustum of a pyramid of four sides."""
    inradius_m, lean = rng.uniform(0.03, 0.08), np.deg2rad(rng.uniform(10, 25))
    return _bar(Prism(4, inradius_m, inradius_m * rng.uniform(1.0, 2.5), lean * rng.choice([-1, 1])), rng)


def oval_bar(rng: np.random.Generator) -> Arrangement:
    """A bar of elliptic section, twice as wide as thick."""
    half_m = log_uniform(rng, 0.04, 0.12) / 2
    return _bar(Stretched(Frustum("cylinder", np.zeros(3), AHEAD, rng.uniform(0.3, 0.4), half_m), (1.0, 0.5, 1.0)), rng)


def egg(rng: np.random.Generator) -> Arrangement:
    """An ellipsoid whose three axes differ."""
    scale = (1.0, float(rng.uniform(0.45, 0.6)), float(rng.uniform(1.4, 1.8)))
    return _bar(Stretched(Sphere(np.zeros(3), AHEAD, rng.uniform(0.04, 0.09)), scale), rng)


def _box(rng: np.random.Generator, roll_deg: float, axis: Floats, slimmest: float = 0.3) -> Arrangement:
    """A box of any size whose edges differ in length by so much at most, drawn along one of them."""
    half_m = log_uniform(rng, THIN_M, THICK_M) / 2
    sides = (half_m * rng.uniform([slimmest] * 3, 1.0)).clip(THIN_M / 2)
    box = Box((float(sides[0]), float(sides[1]), float(sides[2])))
    return standing(box, before_camera(box, rng, roll_deg, axis), rng)


def _bar(shape: Box | Prism | Stretched, rng: np.random.Generator) -> Arrangement:
    """Something long, turned any way about its length."""
    return standing(shape, before_camera(shape, rng, rng.uniform(-90, 90), direction(rng, 35)), rng)


BOXY: dict[str, Maker] = {
    "face on": face_on,
    "edge on": edge_on,
    "corner on": corner_on,
    "any box": any_box,
    "square bar": square_bar,
    "flat bar": flat_bar,
    "three-sided bar": three_sided_bar,
    "six-sided bar": six_sided_bar,
    "pyramid": pyramid,
    "oval bar": oval_bar,
    "egg": egg,
}

"""Textures by how easily a matcher finds its way on them, fixed to the body like every other."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.primitives import Simple
from rotrecon.simulation.scenery import SOLID_LATTICE
from rotrecon.simulation.texture import Material, NoiseMaterial, Octave, linear_light

Texture = Literal["fine", "coarse", "weak", "repetitive", "plain"]
TEXTURES: tuple[Texture, ...] = get_args(Texture)
GRAIN_M = 0.003
"""Of a fine texture: three pixels at 0.9 m and a focal length of 900 px, over two at 1.2 m, so that it is resolved."""
PERIOD_M = 0.012
"""Of a regular pattern: twelve pixels at 0.9 m, several times within any range of disparity that is searched."""


@dataclass(frozen=True, eq=False)
class OneColour:
    """No texture at all."""

    colour: Floats
    """(3,) linear light in 0..1."""

    def __post_init__(self) -> None:
        freeze(self)

    def albedo(self, points_m: Floats) -> Floats:
        """See `Material.albedo`."""
        return np.broadcast_to(self.colour, points_m.shape)


@dataclass(frozen=True, eq=False)
class Weave:
    """A pattern that repeats along the body's axis and around it."""

    radius_m: float
    """Where the pattern has its period around; it fades toward the axis, where turns become too short for it."""
    colours: Floats
    """(2, 3) linear light in 0..1, of its dark and light places."""

    def __post_init__(self) -> None:
        freeze(self)

    def albedo(self, points_m: Floats) -> Floats:
        """See `Material.albedo`."""
        x, y, z = np.moveaxis(points_m, -1, 0)
        turns = max(round(2 * np.pi * self.radius_m / PERIOD_M), 1)
        fading = np.minimum(np.hypot(x, y) / self.radius_m, 1)
        share = 0.5 + 0.25 * (np.sin(2 * np.pi / PERIOD_M * z) + fading * np.sin(turns * np.arctan2(y, x)))
        return self.colours[0] + share[:, None] * (self.colours[1] - self.colours[0])


def textured(texture: Texture, shape: Simple) -> Callable[[np.random.Generator], Material]:
    """What makes the material of a solid with one of `TEXTURES`; ValueError for another name."""
    if texture not in TEXTURES:
        raise ValueError(f"there is no texture {texture!r}; there are {', '.join(TEXTURES)}")
    return lambda rng: _material(texture, shape, rng)


def _material(texture: Texture, shape: Simple, rng: np.random.Generator) -> Material:
    if texture == "plain":
        return OneColour(linear_light([(150, 146, 138)])[0])
    if texture == "repetitive":
        return Weave(shape.radius_m, linear_light([(70, 68, 64), (190, 186, 178)]))
    cells = (0.012, 0.03, 0.06) if texture == "coarse" else (GRAIN_M, 2 * GRAIN_M, 5 * GRAIN_M)
    weak, strong = [(132, 128, 120), (146, 142, 134)], [(40, 40, 42), (104, 98, 90), (156, 150, 140), (214, 210, 200)]
    octaves = tuple(Octave((cell, cell, cell), weight) for cell, weight in zip(cells, (1.0, 0.8, 0.6), strict=True))
    colours = linear_light(weak if texture == "weak" else strong)
    return NoiseMaterial(octaves, colours, rng.random(SOLID_LATTICE, np.float32))

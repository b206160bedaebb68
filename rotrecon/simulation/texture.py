"""What surfaces look like: noise fixed to the body, so that every camera sees a spot in the same colour."""

from dataclasses import dataclass
from itertools import product
from typing import Any, Protocol

import numpy as np

from rotrecon.arrays import Cloud, Floats, freeze

GAMMA = 2.2
"""Of the display: pictures hold intensity to the power of 1 / 2.2."""
CONTRAST = 1.1
"""Brings the sum of octaves, which gathers round its middle, to most of the colour ramp."""
OCTAVE_SHIFT = 17.37
"""Cells by which octaves are shifted against each other: they share a lattice and must not line up."""


class Material(Protocol):
    """Anything that has a colour at every point of a body."""

    def albedo(self, points_m: Floats) -> Floats:
        """Linear-light colours (N, 3) in 0..1 at points (N, 3) in body coordinates."""
        ...


@dataclass(frozen=True)
class Octave:
    """One scale of a texture."""

    cell_m: tuple[float, float, float]
    """Size of a grain along the body's x, y and z."""
    weight: float


@dataclass(frozen=True, eq=False)
class NoiseMaterial:
    """Colours of a ramp, chosen by value noise of several octaves."""

    octaves: tuple[Octave, ...]
    ramp: Floats
    """(K, 3) linear-light colours for values from 0 to 1."""
    lattice: Cloud
    """(n, n) for a flat body, (n, n, n) for a solid one; random in 0..1; n, a power of two, is its period."""
    bands: float = 0.0
    """Above zero the ramp is run through so many times, which draws contour lines: the grain of wood."""

    def __post_init__(self) -> None:
        freeze(self)

    def albedo(self, points_m: Floats) -> Floats:
        """See `Material.albedo`."""
        dimensions = self.lattice.ndim
        value = np.zeros(len(points_m), dtype=np.float32)
        for number, octave in enumerate(self.octaves):
            cells = points_m[:, :dimensions] / np.array(octave.cell_m[:dimensions])
            noise = value_noise(cells + OCTAVE_SHIFT * number, self.lattice)
            value += np.float32(octave.weight) * (noise - np.float32(0.5))
        value *= np.float32(CONTRAST / np.sqrt(sum(octave.weight**2 for octave in self.octaves)))
        value += np.float32(0.5)
        if self.bands > 0:
            value = 0.5 - 0.5 * np.cos(2 * np.pi * np.float32(self.bands) * value)
        knots = np.linspace(0, 1, len(self.ramp))
        channels = [np.interp(value, knots, self.ramp[:, channel]) for channel in range(3)]
        return np.stack(channels, axis=-1)


@dataclass(frozen=True, eq=False)
class Football:
    """Leather as a truncated icosahedron: twelve dark pentagons, twenty light hexagons, seams."""

    leather: Material

    def albedo(self, points_m: Floats) -> Floats:
        """See `Material.albedo`."""
        height = points_m @ _football_faces().T / np.linalg.norm(points_m, axis=-1, keepdims=True)
        face = height.argmax(axis=-1)
        second, best = np.partition(height, -2, axis=-1)[:, -2:].T
        shade = np.where(face < 12, 0.10, 1.0) * np.where(best - second < 0.007, 0.35, 1.0)
        return self.leather.albedo(points_m) * shade[:, None]


def value_noise(cells: Floats, lattice: Cloud) -> Cloud:
    """Smooth noise (N,) in 0..1 at points (N, D) counted in cells of a lattice (n, ...) of D dimensions."""
    size, dimensions = lattice.shape[0], lattice.ndim
    floor = np.floor(cells)
    part = (cells - floor).astype(np.float32)
    part = part * part * (3 - 2 * part)
    whole = floor.astype(np.int32)
    corners: list[tuple[Any, Any]] = [(np.int32(0), np.float32(1))]
    for axis in range(dimensions):
        low, high = whole[:, axis] & (size - 1), (whole[:, axis] + 1) & (size - 1)
        sides = ((low, 1 - part[:, axis]), (high, part[:, axis]))
        corners = [(index * size + step, weight * share) for index, weight in corners for step, share in sides]
    flat = lattice.reshape(-1)
    total = np.zeros(len(cells), dtype=np.float32)
    for index, weight in corners:
        total += weight * flat[index]
    return total


def linear_light(colours: list[tuple[int, int, int]]) -> Floats:
    """Linear-light colours (K, 3) in 0..1 of display colours in 0..255."""
    return (np.array(colours) / 255.0) ** GAMMA


def _football_faces() -> Floats:
    """Normals (32, 3) of the faces over their distances; a direction meets the face of its largest product.

    Distances 2.32744 of pentagons and 2.26728 of hexagons are those of the solid with unit edges.
    """
    golden = (1 + np.sqrt(5)) / 2
    signs = list(product((-1, 1), repeat=2))
    pentagons = [np.roll([0, a, b * golden], turn) for a, b in signs for turn in range(3)]
    hexagons = [np.roll([0, a * golden, b / golden], turn) for a, b in signs for turn in range(3)]
    hexagons += [np.array(corner, dtype=float) for corner in product((-1, 1), repeat=3)]
    normals = np.array(pentagons + hexagons)
    distance = np.repeat([2.32744, 2.26728], [len(pentagons), len(hexagons)])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True) / distance[:, None]

"""What simulated things are made of and what stands behind them."""

from collections.abc import Callable

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import PinholeCamera, inverse, rotate, transform
from rotrecon.primitives import basis_across
from rotrecon.simulation.raycast import Plane
from rotrecon.simulation.rendering import Body
from rotrecon.simulation.texture import Football, Material, NoiseMaterial, Octave, linear_light

FLAT_LATTICE = (256, 256)
"""Cells of a plane's noise: with grains of 5 mm it repeats after 1.3 m."""
SOLID_LATTICE = (64, 64, 64)
"""Cells of a solid's noise: with grains of 2 mm it repeats after 0.13 m, which octaves of other sizes hide."""

MaterialMaker = Callable[[np.random.Generator], Material]


def wood(rng: np.random.Generator) -> Material:
    """Oiled wood, its grain along z."""
    octaves = (_grain(0.030, 0.5, 1.0), _grain(0.007, 0.12, 0.35), _grain(0.0022, 0.02, 0.35))
    colours = [(104, 66, 36), (150, 102, 60), (181, 133, 84), (204, 160, 110)]
    return NoiseMaterial(octaves, linear_light(colours), rng.random(SOLID_LATTICE, np.float32), bands=3.0)


def leather_ball(rng: np.random.Generator) -> Material:
    """A football that has been played with."""
    octaves = (_grain(0.050, 0.050, 0.8), _grain(0.008, 0.008, 0.8), _grain(0.003, 0.003, 0.9))
    colours = [(140, 128, 108), (205, 200, 188), (232, 229, 221), (246, 245, 240)]
    return Football(NoiseMaterial(octaves, linear_light(colours), rng.random(SOLID_LATTICE, np.float32)))


def weathered_cable(rng: np.random.Generator) -> Material:
    """A street wire: grey sheath, streaks along z, dust."""
    octaves = (_grain(0.012, 0.09, 0.8), _grain(0.004, 0.018, 0.8), _grain(0.002, 0.003, 0.9))
    colours = [(38, 40, 44), (78, 80, 84), (112, 113, 114), (168, 166, 158)]
    return NoiseMaterial(octaves, linear_light(colours), rng.random(SOLID_LATTICE, np.float32))


def rusty_steel(rng: np.random.Generator) -> Material:
    """A steel pipe with rust coming through."""
    octaves = (_grain(0.060, 0.090, 1.0), _grain(0.015, 0.020, 0.6), _grain(0.003, 0.004, 0.6))
    colours = [(92, 48, 28), (134, 78, 46), (128, 124, 120), (150, 152, 154), (176, 180, 184)]
    return NoiseMaterial(octaves, linear_light(colours), rng.random(SOLID_LATTICE, np.float32))


def terracotta(rng: np.random.Generator) -> Material:
    """Fired clay with lime spots."""
    octaves = (_grain(0.040, 0.015, 0.7), _grain(0.008, 0.006, 0.7), _grain(0.0025, 0.0025, 0.8))
    colours = [(118, 58, 38), (172, 92, 62), (192, 112, 78), (218, 168, 138)]
    return NoiseMaterial(octaves, linear_light(colours), rng.random(SOLID_LATTICE, np.float32))


def concrete(rng: np.random.Generator) -> Material:
    """A cast wall: clouds, marks of the boards it was cast in along x, pores."""
    octaves = (
        Octave((0.45, 0.30, 1.0), 0.8),
        Octave((2.0, 0.11, 1.0), 0.7),
        Octave((0.05, 0.035, 1.0), 0.5),
        Octave((0.012, 0.012, 1.0), 0.6),
        Octave((0.005, 0.005, 1.0), 0.5),
    )
    colours = [(104, 101, 96), (138, 135, 129), (152, 149, 143), (166, 163, 158), (186, 184, 179)]
    return NoiseMaterial(octaves, linear_light(colours), rng.random(FLAT_LATTICE, np.float32))


def earth(rng: np.random.Generator) -> Material:
    """Trodden ground with grit."""
    octaves = (Octave((0.3, 0.3, 1.0), 0.7), Octave((0.03, 0.03, 1.0), 0.7), Octave((0.006, 0.006, 1.0), 0.9))
    colours = [(58, 50, 40), (96, 85, 68), (118, 106, 86), (150, 138, 116)]
    return NoiseMaterial(octaves, linear_light(colours), rng.random(FLAT_LATTICE, np.float32))


def plane_behind(
    camera: PinholeCamera, T_base_camera: Floats, normal: Floats, depth_m: float, material: Material
) -> Body:
    """A plane that faces the camera and is nowhere in the picture nearer than a depth.

    `normal` is (3,), unit, in base coordinates, on the camera's side; the texture's x axis is level.
    """
    corners = np.array([[u, v] for u in (0, camera.width - 1) for v in (0, camera.height - 1)])
    rays = camera.unproject(corners, np.ones(4))
    toward = -rotate(inverse(T_base_camera), normal)
    distance_m = depth_m * float((rays @ toward).max())
    across, up = basis_across(normal, np.array([0.0, 0.0, 1.0]))
    pose = np.eye(4)
    pose[:3, :3] = np.stack([across, up, normal], axis=1)
    pose[:3, 3] = transform(T_base_camera, distance_m * toward)
    return Body(Plane(), pose, material)


def _grain(across_m: float, along_m: float, weight: float) -> Octave:
    return Octave((across_m, across_m, along_m), weight)

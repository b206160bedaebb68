"""Walls, tables, planks, corners, steps and bumps: large surfaces that a drawing cuts a piece out of."""

from dataclasses import replace

import numpy as np

from rotrecon.primitives import basis_across
from rotrecon.simulation.arrangements.placing import (
    Arrangement,
    Maker,
    ahead,
    along_or_across,
    before_camera,
    direction,
    log_uniform,
    moved,
    patch,
    plane,
    pose,
    standing,
    wall_at,
)
from rotrecon.simulation.raycast import Box, Prism, Stretched

ROOM_M = 1.0
"""Half length of what is larger than the picture."""
BLOCK = Box((ROOM_M, ROOM_M, ROOM_M))


def wall(rng: np.random.Generator) -> Arrangement:
    """A wall, seen more or less from the front."""
    return patch(wall_at(rng.uniform(0.6, 1.4), rng, 55), rng)


def table(rng: np.random.Generator) -> Arrangement:
    """A table top, seen from where a person sits."""
    lean = np.deg2rad(rng.uniform(45, 75))
    return patch(plane(ahead(rng, 0.5, 1.0), np.array([0, -np.sin(lean), -np.cos(lean)])), rng)


def bumpy(rng: np.random.Generator) -> Arrangement:
    """Rock, cloth, a heap of sand."""
    bumps = (float(rng.uniform(0.004, 0.025)), float(rng.uniform(20, 60)))
    return replace((wall, table)[rng.integers(2)](rng), bumps=bumps)


def plank(rng: np.random.Generator) -> Arrangement:
    """A plank's broad face."""
    box = Box((rng.uniform(0.03, 0.1), rng.uniform(0.005, 0.015), rng.uniform(0.15, 0.3)))
    return standing(box, before_camera(box, rng, rng.uniform(-20, 20), direction(rng, 35)), rng)


def roof(rng: np.random.Generator) -> Arrangement:
    """Two planes that meet at a blunt ridge, the ridge drawn as an axis."""
    half_width_m, half_angle = rng.uniform(0.04, 0.2), np.deg2rad(rng.uniform(50, 80))
    # a triangle of inradius 1 is 3 high and sqrt(12) wide; its edge at -x is turned toward the camera
    scale = (half_width_m / np.tan(half_angle) / 3, half_width_m / np.sqrt(3), 1.0)
    ridge = Stretched(Prism(3, 1.0, rng.uniform(0.2, 0.4)), scale)
    return standing(ridge, before_camera(ridge, rng, rng.uniform(-10, 10) - 90, direction(rng, 30)), rng)


def outside_corner(rng: np.random.Generator) -> Arrangement:
    """The corner of a house."""
    middle = ahead(rng, 0.6)
    house = pose(middle, direction(rng, 30), 45 + rng.uniform(-20, 20))
    corner = house @ moved(np.array([-ROOM_M, -ROOM_M, 0]))
    return along_or_across(((BLOCK, corner),), middle, house[:3, 2], rng)


def inside_corner(rng: np.random.Generator) -> Arrangement:
    """Where two walls meet, or two walls and the floor."""
    crease, middle = direction(rng, 30), ahead(rng, 0.7, 1.4)
    aside, toward = basis_across(crease, -middle)
    lean, turn = np.deg2rad(rng.uniform([15, -10], [60, 10]))
    walls = [plane(middle, np.cos(angle) * toward + np.sin(angle) * aside) for angle in (turn + lean, turn - lean)]
    if rng.random() < 0.4:
        walls.append(plane(middle + 0.1 * crease, -crease))
    return along_or_across(tuple(walls), middle, crease, rng)


def step(rng: np.random.Generator) -> Arrangement:
    """The edge of a board before a wall."""
    middle = ahead(rng)
    board = pose(middle, direction(rng, 20))
    behind = plane(middle - log_uniform(rng, 0.015, 0.25) * board[:3, 1], board[:3, 1])
    edge = board @ moved(np.array([ROOM_M, -ROOM_M, 0]))
    return along_or_across(((BLOCK, edge), behind), middle, board[:3, 2], rng)


def staircase(rng: np.random.Generator) -> Arrangement:
    """Steps, from the front and above."""
    tread_m, rise_m = rng.uniform(0.03, 0.09, 2)
    stairs = pose(ahead(rng, 0.7, 1.1), direction(rng, 10), rng.uniform(20, 60))
    corner, onward = np.array([-ROOM_M, -ROOM_M, 0]), np.array([tread_m, -rise_m, 0])
    placed = tuple((BLOCK, stairs @ moved(corner + number * onward)) for number in range(-5, 6))
    along = stairs[:3, 2] if rng.random() < 0.5 else stairs[:3, :3] @ onward / np.linalg.norm(onward)
    return along_or_across(placed, stairs[:3, 3].copy(), along, rng)


FLAT: dict[str, Maker] = {
    "wall": wall,
    "table": table,
    "plank": plank,
    "bumpy": bumpy,
    "roof": roof,
    "outside corner": outside_corner,
    "inside corner": inside_corner,
    "step": step,
    "staircase": staircase,
}

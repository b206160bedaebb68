"""More than one thing in the area, a piece of one, or none."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import transform
from rotrecon.primitives import Sphere, basis_across
from rotrecon.simulation.arrangements.boxy import any_box
from rotrecon.simulation.arrangements.flat import table, wall
from rotrecon.simulation.arrangements.placing import (
    AHEAD,
    BEHIND_M,
    Arrangement,
    Maker,
    Placed,
    ahead,
    corners,
    direction,
    log_uniform,
    moved,
    patch,
    pose,
    rod,
    wall_at,
)
from rotrecon.simulation.raycast import Box


def two_rods(rng: np.random.Generator) -> Arrangement:
    """Two rods side by side, the stroke between them."""
    radius_m, along, middle = log_uniform(rng, 0.015, 0.05) / 2, direction(rng, 30), ahead(rng)
    aside, toward = basis_across(along, -middle)
    apart_m, shift_m = radius_m * rng.uniform(1.0, 1.6), 0.1 * radius_m * rng.normal()
    rods = [rod(middle + s * (apart_m * aside + shift_m * toward), along, radius_m, 0.15) for s in (-1, 1)]
    outline = np.concatenate([corners(*placed) for placed in rods])
    return Arrangement((*rods, _behind(middle, rng)), middle + np.outer([-0.1, 0.1], along), outline)


def crossing_rods(rng: np.random.Generator) -> Arrangement:
    """Two rods that cross, the stroke between their directions."""
    radii_m, half_angle = rng.uniform(0.008, 0.03, 2), np.deg2rad(rng.uniform(15, 45))
    along, middle = direction(rng, 15), ahead(rng)
    aside, toward = basis_across(along, -middle)
    first, second = (np.cos(half_angle) * along + s * np.sin(half_angle) * aside for s in (-1, 1))
    rods = (rod(middle, first, radii_m[0]), rod(middle + radii_m.sum() * toward, second, radii_m[1]))
    reach_m = radii_m.sum() / np.sin(half_angle) * rng.uniform(0.8, 1.5)
    ends = middle + np.outer([-reach_m, reach_m], along)
    half_width_m = reach_m * np.tan(half_angle) + radii_m.max()
    outline = np.concatenate([ends + s * half_width_m * aside for s in (-1, 1)])
    return Arrangement((*rods, _behind(middle, rng)), ends, outline)


def handle(rng: np.random.Generator) -> Arrangement:
    """The handle of a mug, alone: a bent rod, the stroke from one end to the other."""
    bend_m, thickness_m, pieces = rng.uniform(0.02, 0.035), rng.uniform(0.004, 0.007), 12
    middle = ahead(rng, 0.3, 0.6)
    angle = np.deg2rad(np.linspace(-100, 100, pieces + 1))
    bow = bend_m * np.stack([np.cos(angle), np.zeros(pieces + 1), np.sin(angle)], axis=1)
    path = transform(pose(middle, direction(rng, 40), rng.uniform(0, 60)), bow)
    links: list[Placed] = []
    for start, end in pairwise(path):
        half_m = float(np.linalg.norm(end - start)) / 2
        links.append(rod((start + end) / 2, (end - start) / (2 * half_m), thickness_m, half_m + 0.3 * thickness_m))
    outline = np.concatenate([corners(*link) for link in links])
    return Arrangement((*links, _behind(middle, rng, 0.05)), path[[0, -1]], outline)


def half_hidden(rng: np.random.Generator) -> Arrangement:
    """A pipe of which a box leaves one side to be seen, the stroke on the box beside it."""
    radius_m, along, middle = rng.uniform(0.03, 0.05), direction(rng, 20), ahead(rng, 0.6)
    aside, toward = basis_across(along, -middle)
    half_m = rng.uniform(0.9, 1.1) * radius_m
    place = middle + (rng.uniform(0.3, 0.7) * radius_m - half_m) * aside + (radius_m + half_m + 0.01) * toward
    hider = (Box((half_m, half_m, 0.12)), pose(place, along, rng.uniform(-10, 10)))
    placed = (rod(middle, along, radius_m, 0.15), hider)
    stroke = place + 0.6 * half_m * aside + half_m * toward + np.outer([-0.09, 0.09], along)
    return Arrangement((*placed, _behind(middle, rng)), stroke, np.concatenate([corners(*body) for body in placed]))


def heap(rng: np.random.Generator) -> Arrangement:
    """Boxes with small round things among them, the stroke right through."""
    middle = ahead(rng, 0.4, 0.9)
    placed = [_in_heap(number, middle, rng) for number in range(8)]
    turn = rng.uniform(0, 2 * np.pi)
    stroke = middle + np.outer([-0.06, 0.06], [np.cos(turn), np.sin(turn), 0])
    outline = np.concatenate([corners(*body) for body in placed])
    return Arrangement((*placed, _behind(middle, rng, 0.05)), stroke, outline)


def background(rng: np.random.Generator) -> Arrangement:
    """A wall far behind everything."""
    return patch(wall_at(rng.uniform(2.5, 4.0), rng, 20), rng, rng.uniform(1.0, 3.0))


def hole(rng: np.random.Generator) -> Arrangement:
    """Glass, or glare: no depth at all."""
    return replace(wall(rng), kept_share=0.0)


def few_pixels(rng: np.random.Generator) -> Arrangement:
    """Depth here and there, of a table or a box."""
    return replace((table, any_box)[rng.integers(2)](rng), kept_share=float(rng.choice([3e-4, 1e-3, 3e-3, 1e-2])))


def false_matches(rng: np.random.Generator) -> Arrangement:
    """Depth that is nothing but chance."""
    return replace(wall(rng), scattered=True)


def _in_heap(number: int, middle_m: Floats, rng: np.random.Generator) -> Placed:
    """Two in three are boxes; what is round is smaller, and lies farther out."""
    turn, is_round = rng.uniform(0, 2 * np.pi), number % 3 == 2
    away_m = rng.uniform(0.05, 0.08) if is_round else rng.uniform(0.0, 0.06)
    place = middle_m + np.array([away_m * np.cos(turn), away_m * np.sin(turn), rng.uniform(-0.04, 0.04)])
    if not is_round:
        x, y, z = rng.uniform(0.012, 0.045, 3)
        return Box((x, y, z)), pose(place, direction(rng, 80), rng.uniform(0, 90))
    if number == 2:
        return Sphere(np.zeros(3), AHEAD, rng.uniform(0.012, 0.02)), moved(place)
    return rod(place, direction(rng, 60), rng.uniform(0.01, 0.015), rng.uniform(0.02, 0.04))


def _behind(middle_m: Floats, rng: np.random.Generator, nearest_m: float = BEHIND_M) -> Placed:
    return wall_at(float(middle_m[2]) + rng.uniform(nearest_m, BEHIND_M), rng, 35)


CLUTTERED: dict[str, Maker] = {
    "two rods": two_rods,
    "crossing rods": crossing_rods,
    "handle": handle,
    "half hidden": half_hidden,
    "heap": heap,
}
EMPTY: dict[str, Maker] = {
    "background": background,
    "hole": hole,
    "few pixels": few_pixels,
    "false matches": false_matches,
}

"""Which line of contrast near a predicted outline is the outline, to half a pixel."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Floats, freeze
from rotrecon.compiled import MATRIX, VECTOR, compiled

STEP_PX = 0.5
"""Distance of the samples along a normal, and of the lines tried; each is then moved onto its own edges."""
BEYOND_PX = 3.0
"""How far profiles go on beyond the reach, so that lines may leave it at their ends."""
ALONG_PX = 4.0
"""Standard deviation of the average along the outline: it takes texture away, and an outline bends little in it."""
GRADIENT_PX = 1.0
"""Standard deviation across: an edge in a picture is about that wide, noise and the texture's finest part are not."""
LEAST_GRADIENT = 1.0
"""Grey levels a pixel: the noise of a plain surface, averaged like this, stays below."""
INSIDE_SHARE = 0.8
"""Of the half width, how far inward edges are looked for: beyond are those of the other side."""
TILT_RAD = float(np.deg2rad(2.5))
"""Largest turn between a prediction and its outline: a fit to a short arc of depth is off by one or two degrees."""
SAG_PX = 0.5
"""Largest bend between them: more of it, and a line finds a way through anybody's texture."""
ROUND_RAD = np.pi / 2
"""An outline that turns by more is moved and blown up, not tilted and bent."""
ROUND_STEP_PX = 0.75
"""Of the moves tried of a round outline."""
NEAR_PX = 0.6
"""Standard deviation of an edge from a line it counts for: half a step of the lines, and the spread of the edges."""
SAME_LINE_PX = 1.75
"""Edges nearer to a line than this are its own: blur does not let two lines be told apart in less."""
ROWS = 64
"""Points that vote, spread over the outline: neighbours see the same texture."""
OUTER_SHARE = 0.8
"""Of the best support, what the outermost line needs: highlights, shades and prints run along the inside of a limb."""
ONE = np.ones(1)
"""Weights that leave values as they are."""
BEND_PRIOR = 0.02
"""Weight of no bend against all votes, where lines are moved onto edges."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """Predicted points of an outline, in order along it."""

    point_px: Floats
    """(N, 2)"""
    normal_px: Floats
    """(N, 2) unit, away from the object."""
    half_width_px: Floats
    """(N,) of the object."""

    def __post_init__(self) -> None:
        freeze(self)

    def __len__(self) -> int:
        return len(self.half_width_px)

    @cached_property
    def spacing_px(self) -> float:
        """Distance of neighbours."""
        return float(np.median(np.linalg.norm(np.diff(self.point_px, axis=0), axis=1)))

    @cached_property
    def is_round(self) -> bool:
        """Whether its normals turn so much that a move along one of them is none along another."""
        return float(np.abs(np.diff(np.unwrap(np.arctan2(*self.normal_px.T[::-1])))).sum()) > ROUND_RAD

    def shapes(self) -> Floats:
        """How far its points go along their normals, (N, 3), where the whole is moved by 1 px in one of three ways.

        A straight stretch is shifted, tilted, bent; a round one grows, and goes to the right, and down.
        """
        first = np.ones(len(self))
        if self.is_round:
            return np.stack([first, *self.normal_px.T], axis=1)
        steps = np.linalg.norm(np.diff(self.point_px, axis=0), axis=1)
        place = np.concatenate([[0.0], np.cumsum(steps)]) / max(float(steps.sum()), STEP_PX)
        along = 2 * place - 1
        return np.stack([first, along, along**2 - 1 / 3], axis=1)

    def profiles_at(self, offset_px: Floats, across_px: Floats) -> Floats:
        """Places (N, T, 2) at signed distances (T,) along the normals from points moved by (N,)."""
        return self.point_px[:, None] + (offset_px[:, None] + across_px)[..., None] * self.normal_px[:, None]


@dataclass(frozen=True, eq=False)
class Line:
    """A smooth line close to the predicted one."""

    offset_px: Floats
    """(N,) along the normals."""
    support: float
    """From 0 to 1: mean over the points of how strong their edge on the line is, over their strongest one."""
    runner_up: float
    """The support of the best other line, counted without the edges of this one."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class _Votes:
    """Edges across every normal."""

    across_px: Floats
    """(T,) signed distance from the prediction, outward."""
    place_px: Floats
    """(N, T) the same of the steepest place itself, where there is an edge."""
    share: Floats
    """(N, T) strength over that of the strongest edge on the same normal; 0 where there is no edge."""


def bell(sigma: float) -> Floats:
    """Weights of a Gaussian average, to four standard deviations."""
    half = int(np.ceil(4 * sigma))
    weights = np.exp(-0.5 * (np.arange(-half, half + 1) / sigma) ** 2)
    return weights / weights.sum()


def filtered(values: NDArray[np.floating[Any]], down: Floats, right: Floats = ONE) -> Floats:
    """Values (N, T) or (N, T, 3) correlated with weights along both; at the borders the outermost go on."""
    result = cv2.sepFilter2D(values, cv2.CV_64F, right, down, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(result, dtype=np.float64)


def find_line(picture: NDArray[np.float32], stretch: Stretch, reach_px: float) -> Line:
    """The outermost well supported line of edges within reach; `picture` is (H, W, 3) in display values."""
    votes = _votes(picture, stretch, reach_px)
    shapes = stretch.shapes()
    shift, bend = _moves(stretch, reach_px)
    rows = np.linspace(0, len(stretch) - 1, min(len(stretch), ROWS)).round().astype(np.intp)
    places = (bend @ shapes[rows, 1:].T - votes.across_px[0]) / STEP_PX
    support = _support(votes.share[rows], shift / STEP_PX, places)
    best = support.max(axis=1)
    around = np.concatenate([[0.0], best, [0.0]])
    tops = (best >= OUTER_SHARE * best.max()) & (best >= around[:-2]) & (best >= around[2:])
    chosen = int(np.flatnonzero(tops)[-1])
    start = shapes @ np.array([shift[chosen], *bend[support[chosen].argmax()]])
    offset = _onto_edges(votes, shapes, start)
    others = np.where(np.abs(votes.across_px - offset[:, None]) < SAME_LINE_PX, 0.0, votes.share)
    return Line(offset, float(best[chosen]), float(_support(others[rows], shift / STEP_PX, places).max()))


def _votes(picture: NDArray[np.float32], stretch: Stretch, reach_px: float) -> _Votes:
    count = int(np.ceil((reach_px + BEYOND_PX) / STEP_PX))
    across = STEP_PX * np.arange(-count, count + 1, dtype=np.float64)
    place = stretch.profiles_at(np.zeros(len(stretch)), across).astype(np.float32)
    # bilinear and rounded to 1/32 px, which is enough for half a pixel
    colour = np.asarray(cv2.remap(picture, place[..., 0], place[..., 1], cv2.INTER_LINEAR), dtype=np.float32)
    wide = bell(GRADIENT_PX / STEP_PX)
    slope = np.gradient(wide) / STEP_PX
    change = cv2.sepFilter2D(
        colour, cv2.CV_32F, slope, bell(ALONG_PX / stretch.spacing_px), borderType=cv2.BORDER_REPLICATE
    )
    strength = np.sqrt((change**2).sum(axis=2))
    before, here, after = strength[:, :-2], strength[:, 1:-1], strength[:, 2:]
    edge = (here >= before) & (here > after) & (here > LEAST_GRADIENT)
    edge &= across[1:-1] >= -INSIDE_SHARE * stretch.half_width_px[:, None]
    curved = np.maximum(2 * here - before - after, 1e-12)
    steepest = across[1:-1] + STEP_PX * ((after - before) / (2 * curved)).clip(-0.5, 0.5)
    strongest = np.where(edge, here, LEAST_GRADIENT).max(axis=1, keepdims=True)
    share = np.where(edge, here / strongest, 0.0).astype(np.float64)
    return _Votes(across[1:-1], steepest, share)


def _moves(stretch: Stretch, reach_px: float) -> tuple[Floats, Floats]:
    """What is tried of the first shape (A,), and of the two others (B, 2)."""
    if stretch.is_round:
        moves = np.arange(-reach_px, reach_px + ROUND_STEP_PX / 2, ROUND_STEP_PX)
        return moves, np.stack(np.meshgrid(moves, moves, indexing="ij"), axis=-1).reshape(-1, 2)
    half_length = stretch.spacing_px * len(stretch) / 2
    count = int(np.ceil(np.tan(TILT_RAD) * half_length / STEP_PX))
    tilts, sags = STEP_PX * np.arange(-count, count + 1, dtype=np.float64), np.array([-SAG_PX, 0.0, SAG_PX])
    bend = np.stack(np.meshgrid(tilts, sags, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.arange(-reach_px, reach_px + STEP_PX / 2, STEP_PX), bend


def _support(share: Floats, shift: Floats, places: Floats) -> Floats:
    """Support (A, B) of lines at places (B, R), in steps, moved by shifts (A,); edges are where `share` (R, T) says."""
    near = share.copy()
    for step in range(1, round(2 * NEAR_PX / STEP_PX) + 1):
        faded = share * np.exp(-0.5 * (step * STEP_PX / NEAR_PX) ** 2)
        np.maximum(near[:, step:], faded[:, :-step], out=near[:, step:])
        np.maximum(near[:, :-step], faded[:, step:], out=near[:, :-step])
    near[:, [0, -1]] = 0.0
    return _counted(near, shift, places)


@compiled(MATRIX, VECTOR, MATRIX)
def _counted(near: Floats, shift: Floats, places: Floats) -> Floats:
    """Mean (A, B) over rows R of what `near` (R, T) holds at the places (B, R) nearest to shifted lines."""
    last, rows = near.shape[1] - 1, near.shape[0]
    mean = np.zeros((len(shift), len(places)))
    for a in range(len(shift)):
        for b in range(len(places)):
            total = 0.0
            for row in range(rows):
                total += near[row, min(max(int(np.rint(shift[a] + places[b, row])), 0), last)]
            mean[a, b] = total / rows
    return mean


def _onto_edges(votes: _Votes, shapes: Floats, start_px: Floats) -> Floats:
    """A line (N,) moved, by least squares, onto the edges beside it."""
    line, rows = start_px, np.arange(len(start_px))
    for near in (1.5, 1.0):
        own = np.where(np.abs(votes.across_px - line[:, None]) < near, votes.share, 0.0)
        best = own.argmax(axis=1)
        weight = own[rows, best]
        held = np.diag([1e-9, 1e-9, BEND_PRIOR * len(rows)])
        normal = shapes.T @ (shapes * weight[:, None]) + held
        line = line + shapes @ np.linalg.solve(normal, shapes.T @ (weight * (votes.place_px[rows, best] - line)))
    return line

"""Which line of contrast near a predicted outline is the outline, to half a pixel."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Floats, freeze
from rotrecon.edges.line_loops import STEP_PX, onto_edges, samples_at, steepest, support_of

BEYOND_PX = 3.0
"""How far profiles go on beyond the reach, so that lines may leave it at their ends."""
ALONG_PX = 4.0
"""Standard deviation of the average along the outline: it takes texture away, and an outline bends little in it."""
GRADIENT_PX = 1.0
"""Standard deviation across: an edge in a picture is about that wide, noise and the texture's finest part are not."""
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
SAME_LINE_PX = 1.75
"""Edges nearer to a line than this are its own: blur does not let two lines be told apart in less."""
ROWS = 64
"""Points that vote, spread over the outline: neighbours see the same texture."""
OUTER_SHARE = 0.8
"""Of the best support, what the outermost line needs: highlights, shades and prints run along the inside of a limb."""
ONE = np.ones(1)
"""Weights that leave values as they are."""


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
        x, y = self.normal_px.T
        turn = np.arctan2(x[:-1] * y[1:] - y[:-1] * x[1:], x[:-1] * x[1:] + y[:-1] * y[1:])
        return float(np.abs(turn).sum()) > ROUND_RAD

    @cached_property
    def shapes(self) -> Floats:
        """How far its points go along their normals, (N, 3), where the whole is moved by 1 px in one of three ways.

        A straight stretch is shifted, tilted, bent; a round one grows, and goes to the right, and down.
        """
        shapes = np.ones((len(self), 3))
        if self.is_round:
            shapes[:, 1:] = self.normal_px
            return shapes
        steps = np.linalg.norm(np.diff(self.point_px, axis=0), axis=1)
        place = np.concatenate([[0.0], np.cumsum(steps)]) / max(float(steps.sum()), STEP_PX)
        along = 2 * place - 1
        shapes[:, 1], shapes[:, 2] = along, along**2 - 1 / 3
        return shapes


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


SLOPE = np.gradient(bell(GRADIENT_PX / STEP_PX)) / STEP_PX
"""Weights of a Gaussian derivative."""


def filtered(values: NDArray[np.floating[Any]], down: Floats, right: Floats = ONE) -> Floats:
    """Values (N, T) or (N, T, 3) correlated with weights along both; at the borders the outermost go on."""
    result = cv2.sepFilter2D(values, cv2.CV_64F, right, down, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(result, dtype=np.float64)


def find_line(picture: NDArray[np.float32], stretch: Stretch, reach_px: float, spread_px: float) -> Line:
    """The outermost well supported line of edges within reach; `picture` is (H, W, 3) in display values.

    Of others what is farther from the prediction counts less, by Cauchy's distribution of a spread.
    """
    votes, shapes = _votes(picture, stretch, reach_px), stretch.shapes
    shift, bend = _moves(stretch, reach_px)
    rows = np.linspace(0, len(stretch) - 1, min(len(stretch), ROWS)).round().astype(np.intp)
    places = (bend @ shapes[rows, 1:].T - votes.across_px[0]) / STEP_PX
    support = support_of(votes.share[rows], shift / STEP_PX, places)
    best = support.max(axis=1)
    around = np.concatenate([[0.0], best, [0.0]])
    tops = (best >= OUTER_SHARE * best.max()) & (best >= around[:-2]) & (best >= around[2:])
    chosen = int(np.flatnonzero(tops)[-1])
    start = shapes @ np.array([shift[chosen], *bend[support[chosen].argmax()]])
    offset = onto_edges(votes.across_px, votes.place_px, votes.share, shapes, start)
    others = np.where(np.abs(votes.across_px - offset[rows, None]) < SAME_LINE_PX, 0.0, votes.share[rows])
    credit = np.minimum((1 + (shift[chosen] / spread_px) ** 2) / (1 + (shift / spread_px) ** 2), 1.0)
    runner_up = credit * support_of(others, shift / STEP_PX, places).max(axis=1)
    return Line(offset, float(best[chosen]), float(runner_up.max()))


def _votes(picture: NDArray[np.float32], stretch: Stretch, reach_px: float) -> _Votes:
    count = int(np.ceil((reach_px + BEYOND_PX) / STEP_PX))
    across = STEP_PX * np.arange(-count, count + 1, dtype=np.float64)
    u, v = samples_at(stretch.point_px, stretch.normal_px, across)
    # bilinear and rounded to 1/32 px, which is enough for half a pixel
    colour = np.asarray(cv2.remap(picture, u, v, cv2.INTER_LINEAR), dtype=np.float32)
    along = bell(ALONG_PX / stretch.spacing_px)
    change = cv2.sepFilter2D(colour, cv2.CV_32F, SLOPE, along, borderType=cv2.BORDER_REPLICATE)
    change = np.asarray(change, dtype=np.float32)
    return _Votes(across[1:-1], *steepest(change, across, -INSIDE_SHARE * stretch.half_width_px))


def _moves(stretch: Stretch, reach_px: float) -> tuple[Floats, Floats]:
    """What is tried of the first shape (A,), and of the two others (B, 2)."""
    if stretch.is_round:
        moves = np.arange(-reach_px, reach_px + ROUND_STEP_PX / 2, ROUND_STEP_PX)
        return moves, _pairs(moves, moves)
    half_length = stretch.spacing_px * len(stretch) / 2
    # a line whose ends are out of reach is another's
    count = int(np.ceil(min(np.tan(TILT_RAD) * half_length, reach_px) / STEP_PX))
    tilts, sags = STEP_PX * np.arange(-count, count + 1, dtype=np.float64), np.array([-SAG_PX, 0.0, SAG_PX])
    return np.arange(-reach_px, reach_px + STEP_PX / 2, STEP_PX), _pairs(tilts, sags)


def _pairs(first: Floats, second: Floats) -> Floats:
    return np.column_stack([np.repeat(first, len(second)), np.tile(second, len(first))])

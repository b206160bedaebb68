"""Where the object's colour gives way to the background's along profiles across an outline, to a fraction of a pixel.

The step is where all that is seen is most likely, so that a texture is not taken for an edge and the more even side
says more of where it ends.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.edges.edge_lines import bell, filtered
from rotrecon.edges.edge_model import CORRELATED_PX, Model, Profiles, model_of
from rotrecon.edges.line_loops import UNHELD, smooth_line

CLEAR_PX = 2.0
"""Distance from the edge where a colour is one side's alone, in pictures that are not blurred."""
CLEAR_BLURS = 3.0
"""The same in pictures that are, in standard deviations of the blur: 0.1 % of the other side is left."""
PLACES_PX = np.arange(-1.25, 1.26, 0.25)
"""Where the step is tried, from a line that is right to half a pixel; likelihoods are parabolas over a quarter."""
NO_STEP_PX = np.array([-100.0, 100.0])
"""Places beyond any profile: all that is seen is the background, or the object."""
BLURS_PX = np.array([0.3, 0.42, 0.6, 0.85, 1.2])
"""Standard deviations of the blur that are tried: a pixel's own area is 0.3 to 0.4, a recorded picture's about 1."""
BLUR_ROWS = 3
"""Every so many profiles are enough to find the blur."""
ALONG_PX = 4.0
"""Standard deviation of the average of log-likelihoods along the outline: a profile alone is lost in texture."""
OFF_PX = 0.75
"""Steps farther off the line are of something else: a handle, a label, a thing behind."""
NARROWING_PX = (2.0, 1.0, OFF_PX, OFF_PX)
"""Distances up to which steps have a say in their line, at first of all places tried."""
BEND_PRIOR = 0.05
"""Weight of no bend against all steps."""
SYSTEMATIC_SHARE = 0.05
"""Of the blur: what does not average out on rendered pictures, as shading is not linear, and blur no Gaussian."""
LOCAL_ERROR_PX = 0.09
"""What the steps of `CORRELATED_PX` err by together, however clear they are (measured on rendered pictures)."""
LARGEST_ERROR_PX = 1.25
"""Of a single step, by its likelihood: with more, it may be anywhere among the places tried."""
CAUTION = 1.35
"""Factor on the scatter: that of three colours, and of a texture which may run all along the outline."""


@dataclass(frozen=True, eq=False)
class Steps:
    """Where the steps are on the profiles of a stretch."""

    offset_px: Floats
    """(N,) from the predicted points; NaN where there is none, or not on the line."""
    sigma_px: Floats
    """(N,) standard errors: taken as independent, they have together the standard error of their mean."""
    contrast: Floats
    """(N,) distance of the two colours, in standard deviations of their textures and the noise."""
    mean_sigma_px: float
    """Standard error of the mean offset."""
    blur_px: float
    line_px: Floats
    """(N,) the smooth line through most of them, from the predicted points."""

    def __post_init__(self) -> None:
        freeze(self)


def find_steps(stretches: Sequence[Profiles]) -> list[Steps]:
    """The steps on all sides of one object, which share the blur of the picture."""
    models = [model_of(profiles, CLEAR_PX) for profiles in stretches]
    blur_px = _blur(models)
    if CLEAR_BLURS * blur_px > CLEAR_PX:
        models = [model_of(profiles, CLEAR_BLURS * blur_px) for profiles in stretches]
    return [_steps(profiles, model, blur_px) for profiles, model in zip(stretches, models, strict=True)]


def _blur(models: list[Model]) -> float:
    places = np.array([-0.5, 0.0, 0.5])
    place, blur = np.tile(places, len(BLURS_PX)), np.repeat(BLURS_PX, len(places))
    total = np.zeros(len(BLURS_PX))
    for model in models:
        likely = model.log_likelihood(place, blur, BLUR_ROWS).sum(axis=(1, 2))
        total += likely.reshape(len(BLURS_PX), -1).max(axis=1)
    best = int(total[1:-1].argmax()) + 1
    away, _ = _vertex(total[best - 1], total[best], total[best + 1])
    return float(np.exp(np.interp(best + away, np.arange(len(total)), np.log(BLURS_PX))))


def _vertex(before: Floats, here: Floats, after: Floats) -> tuple[Floats, Floats]:
    """Place of a parabola's top from the middle of three samples, at most one away, and its curvature downward."""
    curvature = np.maximum(2 * here - before - after, 1e-9)
    return ((after - before) / (2 * curvature)).clip(-1, 1), curvature


def _steps(profiles: Profiles, model: Model, blur_px: float) -> Steps:
    places = np.concatenate([PLACES_PX, NO_STEP_PX])
    by_channel = model.log_likelihood(places, np.full(len(places), blur_px))
    spacing = profiles.stretch.spacing_px
    alone, without = np.split(by_channel.sum(axis=1).T, [len(PLACES_PX)], axis=1)
    along = bell(ALONG_PX / spacing)
    likely = filtered(alone, along)
    # counted, not added up: a profile that is sure of its step must not outvote its neighbours
    stepped = filtered((alone.max(axis=1) > without.max(axis=1)).astype(np.float64)[:, None], along)[:, 0]
    top, rows = likely[:, 1:-1].argmax(axis=1) + 1, np.arange(len(likely))
    before, here, after = (likely[rows, top + side] for side in (-1, 0, 1))
    apart = float(PLACES_PX[1] - PLACES_PX[0])
    away, curvature = _vertex(before, here, after)
    place, weight = PLACES_PX[top] + apart * away, curvature / apart**2
    found = (here >= before) & (here >= after) & (weight > LARGEST_ERROR_PX**-2) & (stepped > 0.5)
    correlated = CORRELATED_PX / spacing
    weight /= 1 + weight * correlated * LOCAL_ERROR_PX**2
    line = _line(profiles.stretch.shapes, place, weight * found)
    found &= np.abs(place - line) < OFF_PX
    if not found.any():
        nothing = np.full(len(place), np.nan)
        return Steps(nothing, nothing, model.contrast, np.inf, blur_px, profiles.line.offset_px)
    total = float(weight[found].sum())
    scatter = _scatter(np.where(found, weight * (place - line), 0.0), round(correlated)) / total**2
    scatter += _disagreement(by_channel[:, :, found], line[found])
    sigma = float(np.sqrt((SYSTEMATIC_SHARE * blur_px) ** 2 + CAUTION**2 * scatter))
    offset = np.where(found, profiles.line.offset_px + place, np.nan)
    sigmas = sigma * np.sqrt(total / weight)
    return Steps(offset, sigmas, model.contrast, sigma, blur_px, profiles.line.offset_px + line)


def _line(shapes: Floats, place: Floats, weight: Floats) -> Floats:
    """The line (N,) through most of the steps (N,): biweight, ever narrower."""
    line = np.zeros(len(place))
    for width in NARROWING_PX:
        trusted = weight * (1 - ((place - line) / width) ** 2).clip(0, 1) ** 2
        line = smooth_line(shapes, trusted, place, UNHELD, BEND_PRIOR * float(trusted.sum()) + UNHELD)
    return line


def _scatter(score: Floats, lags: int) -> float:
    """Variance of a sum of values (N,) that are correlated over some lags: Newey and West 1987."""
    total = float((score**2).sum())
    for lag in range(1, min(lags, len(score) - 1) + 1):
        total += 2 * (1 - lag / (lags + 1)) * float((score[lag:] * score[:-lag]).sum())
    return max(total, 0.0)


def _disagreement(by_channel: Floats, line: Floats) -> float:
    """Variance of the mean offset by what three channels say of it; `by_channel` (K, 3, N), `line` (N,)."""
    apart = float(PLACES_PX[1] - PLACES_PX[0])
    near = np.rint((line - PLACES_PX[0]) / apart).astype(np.intp).clip(1, len(PLACES_PX) - 2)
    rows = np.arange(len(line))
    likely = [by_channel[near + side, :, rows].sum(axis=0) for side in (-1, 0, 1)]
    away, weight = _vertex(likely[0], likely[1], likely[2])
    away, share = apart * away, weight / weight.sum()
    return float((share * (away - (share * away).sum()) ** 2).sum() / 2)

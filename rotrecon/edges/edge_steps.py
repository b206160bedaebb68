"""Where the object's colour gives way to the background's along profiles across an outline, to a fraction of a pixel.

Either side is a level that changes slowly along the outline, and a texture. Across it the background changes linearly,
the object as Lambert's law has it for something turned. A texture is a Gaussian process whose covariance in colour and
whose correlation across are those seen beside the edge. A pixel of the edge shows both sides in proportion to the area
they cover. The step is where all that is most likely, so that a texture is not taken for an edge and the more even side
says more of where it ends.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr  # pyright: ignore[reportMissingTypeStubs, reportUnknownVariableType]

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.edges.edge_lines import Line, Stretch, bell, filtered

CLEAR_PX = 2.0
"""Distance from the edge where a colour is one side's alone, in pictures that are not blurred."""
CLEAR_BLURS = 3.0
"""The same in pictures that are, in standard deviations of the blur: 0.1 % of the other side is left."""
LEAST_ZONE_PX = 1.0
"""Least width of a zone where a colour is one side's alone: with less, there is no telling how it changes."""
LEVEL_PX = 15.0
"""Standard deviation of the average along the outline that is a side's level there."""
PLACES_PX = np.arange(-1.25, 1.26, 0.25)
"""Where the step is tried, from a line that is right to half a pixel; likelihoods are parabolas over a quarter."""
NO_STEP_PX = np.array([-100.0, 100.0])
"""Places beyond any profile: all that is seen is the background, or the object."""
BLURS_PX = np.array([0.3, 0.42, 0.6, 0.85, 1.2])
"""Standard deviations of the blur that are tried: a pixel's own area is 0.3 to 0.4, a recorded picture's about 1."""
BLUR_ROWS = 3
"""Every so many profiles are enough to find the blur."""
NOISE = 0.005
"""Noise of linear light, of 1: an 8 bit camera's, in the middle of its range."""
COLOUR_FLOOR = 1e-6
"""Least variance of a colour, so that a perfectly even side has one."""
BENT_SHARE = 0.5
"""Of an even surface's light, how much changes from its middle to its limb in the root of the distance: about as much
as comes from a lamp beside the camera."""
SHADING_NOISE = NOISE / 3
"""What a mean along the outline errs by: blur and Lambert's law leave that much."""
CORRELATION = (0.05, 0.9)
"""Bounds of a texture's correlation over one pixel: estimates from few samples beyond them mean nothing."""
ALONG_PX = 4.0
"""Standard deviation of the average of log-likelihoods along the outline: a profile alone is lost in texture."""
OFF_PX = 0.75
"""Steps farther off the line are of something else: a handle, a label, a thing behind."""
BEND_PRIOR = 0.05
"""Weight of no bend against all steps."""
CORRELATED_PX = 10.0
"""Distance along the outline within which steps err together: the average over likelihoods, and the texture's grain."""
SYSTEMATIC_SHARE = 0.1
"""Of the blur: what does not average out on rendered pictures, as shading is not linear, and blur no Gaussian."""
LARGEST_ERROR_PX = 1.25
"""Of a single step, by its likelihood: with more, it may be anywhere among the places tried."""
CAUTION = 1.5
"""Factor on the scatter: that of three colours, and of a texture which may run all along the outline."""


@dataclass(frozen=True, eq=False)
class Profiles:
    """Colours across a line near an outline."""

    stretch: Stretch
    line: Line
    across_px: Floats
    """(T,) signed distance from the line, outward; 1 px apart where that is clear of the edge."""
    light: Floats
    """(N, T, 3) linear light."""
    deep_px: Floats
    """(D,) distances farther inside, which tell how the object is shaded."""
    deep: Floats
    """(N, D, 3) linear light there."""


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


@dataclass(frozen=True, eq=False)
class _Side:
    """One side's colours, in three channels whose textures are independent."""

    level: Floats
    """(3, T, N)"""
    covariance: Floats
    """(3, T, T) of the texture."""


@dataclass(frozen=True, eq=False)
class _Shading:
    """How a turned surface's light changes toward its limb, the same all along the stretch.

    Light by Lambert's law is linear in the surface's normal, which turns away with the root of the distance from the
    limb: a line and that root are fitted to what is seen between the zone beside the edge and the object's middle.
    """

    across_px: Floats
    """(T,) where it is wanted."""
    zone: Bools
    """(T,) where levels are taken."""
    half_width_px: float
    seen_px: Floats
    """(D,) where it was seen."""
    light: Floats
    """(D, 3) that was seen there."""
    doubt: Floats
    """(3,) variance of what was seen, over that of the root's amount that is expected."""

    def at(self, place_px: Floats) -> Floats:
        """Light (K, T, 3) over the mean of the zone, with the limb at one of K places."""
        line = np.stack([np.ones(len(self.seen_px)), self.seen_px], axis=1)
        fit = np.linalg.pinv(line)
        bent = self._bent(place_px, self.seen_px)
        own = bent - bent @ fit.T @ line.T
        amount = (own @ self.light) / ((own**2).sum(axis=1)[:, None] + self.doubt)
        slope = fit[1] @ self.light - (bent @ fit[1])[:, None] * amount
        shape = self._bent(place_px, self.across_px)[..., None] * amount[:, None]
        shape = shape + self.across_px[:, None] * slope[:, None]
        return shape - shape[:, self.zone].mean(axis=1, keepdims=True)

    def _bent(self, place_px: Floats, across_px: Floats) -> Floats:
        """Cosine (K, D) of the surface's angle to the picture's plane across the stretch."""
        depth = ((place_px[:, None] - across_px) / self.half_width_px).clip(0, 1)
        return np.sqrt(depth * (2 - depth))


@dataclass(frozen=True, eq=False)
class _Model:
    across_px: Floats
    seen: Floats
    """(3, T, N)"""
    inner: _Side
    outer: _Side
    shading: _Shading
    channels: Floats
    """(3, 3) of colours."""
    noise: Floats
    """(3,) variance."""
    contrast: Floats
    """(N,)"""

    def log_likelihood(self, place_px: Floats, blur_px: Floats, every: int = 1) -> Floats:
        """Of steps at K places with K blurs: (K, 3, N), by channel; `every` so many profiles."""
        inner = _covered((place_px[:, None] - self.across_px) / blur_px[:, None])[:, None]
        outer = 1 - inner
        covariance = self.inner.covariance * inner[..., None] * inner[..., None, :]
        covariance += self.outer.covariance * outer[..., None] * outer[..., None, :]
        covariance += self.noise[:, None, None] * np.eye(len(self.across_px))
        root = np.linalg.cholesky(covariance)
        step = self.inner.level[..., ::every] - self.outer.level[..., ::every]
        step = step + (self.shading.at(place_px) @ self.channels).transpose(0, 2, 1)[..., None]
        rest = (self.seen - self.outer.level)[..., ::every] - inner[..., None] * step
        white = np.linalg.inv(root) @ rest
        spread = np.log(np.diagonal(root, axis1=-2, axis2=-1)).sum(axis=-1)
        return -0.5 * np.einsum("kctn,kctn->kcn", white, white) - spread[..., None]


def find_steps(stretches: Sequence[Profiles]) -> list[Steps]:
    """The steps on all sides of one object, which share the blur of the picture."""
    models = [_model(profiles, CLEAR_PX) for profiles in stretches]
    blur_px = _blur(models)
    if CLEAR_BLURS * blur_px > CLEAR_PX:
        models = [_model(profiles, CLEAR_BLURS * blur_px) for profiles in stretches]
    return [_steps(profiles, model, blur_px) for profiles, model in zip(stretches, models, strict=True)]


def _covered(distance: Floats) -> Floats:
    """The normal distribution's integral: how much of a blurred pixel lies inside an edge, at distances from it."""
    return np.asarray(ndtr(distance), dtype=np.float64)


def _model(profiles: Profiles, clear_px: float) -> _Model:
    across, light = profiles.across_px, profiles.light
    clear = min(clear_px, -float(across[0]) - LEAST_ZONE_PX)
    along_rows = LEVEL_PX / profiles.stretch.spacing_px
    shading = _shading(profiles, across <= -clear)
    shape = shading.at(np.zeros(1))[0]
    inner_level, inner_texture = _level(light, across <= -clear, shape, along_rows)
    outer_level, outer_texture = _level(light, across >= clear, _slope(across, light, across >= clear), along_rows)
    # the channels in which both textures are uncorrelated
    whiten = np.linalg.inv(np.linalg.cholesky(_covariance(outer_texture)))
    ratio, turn = np.linalg.eigh(whiten @ _covariance(inner_texture) @ whiten.T)
    channels = np.asarray(whiten.T @ turn, dtype=np.float64)
    noise = NOISE**2 * (channels**2).sum(axis=0)
    inner = _Side(_planes((inner_level - shape) @ channels), _process(across, inner_texture @ channels, ratio))
    outer = _Side(_planes(outer_level @ channels), _process(across, outer_texture @ channels, np.ones(3)))
    at_edge = int(np.abs(across).argmin())
    difference = inner.level[:, at_edge] - outer.level[:, at_edge]
    contrast = np.sqrt((difference**2 / (ratio + 1 + noise)[:, None]).sum(axis=0))
    return _Model(across, _planes(light @ channels), inner, outer, shading, channels, noise, contrast)


def _level(light: Floats, zone: Bools, shape: Floats, along_rows: float) -> tuple[Floats, Floats]:
    """A side's level (N, T, 3), which has a shape (T, 3) across, and its texture (N, Z, 3) where it is alone."""
    level = filtered(light[:, zone].mean(axis=1), bell(along_rows))[:, None] + shape
    return level, light[:, zone] - level[:, zone]


def _slope(across_px: Floats, light: Floats, zone: Bools) -> Floats:
    """What (T, 3) a background's light changes by across, carried on from the zone where it is alone."""
    distance = across_px - across_px[zone].mean()
    mean = light[:, zone].mean(axis=0)
    return distance[:, None] * (distance[zone] @ mean / (distance[zone] ** 2).sum())


def _shading(profiles: Profiles, zone: Bools) -> _Shading:
    across = np.concatenate([profiles.deep_px, profiles.across_px[zone]])
    seen = np.concatenate([profiles.deep, profiles.light[:, zone]], axis=1)
    light = np.median(seen, axis=0)
    independent = max(len(seen) * profiles.stretch.spacing_px / CORRELATED_PX, 1.0)
    expected = BENT_SHARE * np.abs(light).mean(axis=0)
    variance = (seen - light).var(axis=(0, 1)) / independent + SHADING_NOISE**2
    # on what is too narrow to be seen farther inside, blur would pass for shading
    doubt = variance / np.maximum(expected**2, COLOUR_FLOOR) if len(profiles.deep_px) else np.full(3, np.inf)
    half_width_px = float(np.median(profiles.stretch.half_width_px))
    return _Shading(profiles.across_px, zone, half_width_px, across, light, doubt)


def _covariance(texture: Floats) -> Floats:
    flat = texture.reshape(-1, 3)
    return flat.T @ flat / len(flat) + COLOUR_FLOOR * np.eye(3)


def _process(across_px: Floats, texture: Floats, variance: Floats) -> Floats:
    """Covariance (3, T, T) of a texture (N, Z, 3), 1 px apart, whose correlation falls off exponentially."""
    together = (texture[:, 1:] * texture[:, :-1]).mean(axis=(0, 1))
    correlation = (together / ((texture**2).mean(axis=(0, 1)) + COLOUR_FLOOR)).clip(*CORRELATION)
    return variance[:, None, None] * correlation[:, None, None] ** np.abs(across_px[:, None] - across_px)


def _planes(light: Floats) -> Floats:
    return np.ascontiguousarray(light.transpose(2, 1, 0))


def _blur(models: list[_Model]) -> float:
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


def _steps(profiles: Profiles, model: _Model, blur_px: float) -> Steps:
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
    line = _line(profiles.stretch.shapes(), place, weight * found)
    found &= np.abs(place - line) < OFF_PX
    if not found.any():
        nothing = np.full(len(place), np.nan)
        return Steps(nothing, nothing, model.contrast, np.inf, blur_px, profiles.line.offset_px)
    total = float(weight[found].sum())
    scatter = _scatter(np.where(found, weight * (place - line), 0.0), round(CORRELATED_PX / spacing)) / total**2
    scatter += _disagreement(by_channel[:, :, found], line[found])
    sigma = float(np.sqrt((SYSTEMATIC_SHARE * blur_px) ** 2 + CAUTION**2 * scatter))
    offset = np.where(found, profiles.line.offset_px + place, np.nan)
    sigmas = sigma * np.sqrt(total / weight)
    return Steps(offset, sigmas, model.contrast, sigma, blur_px, profiles.line.offset_px + line)


def _line(shapes: Floats, place: Floats, weight: Floats) -> Floats:
    """The line (N,) through most of the steps (N,): biweight, ever narrower."""
    line = np.zeros(len(place))
    for width in (1.0, OFF_PX, OFF_PX, OFF_PX):
        trusted = weight * (1 - ((place - line) / width) ** 2).clip(0, 1) ** 2
        normal = shapes.T @ (shapes * trusted[:, None])
        normal += np.diag([1e-9, 1e-9, BEND_PRIOR * normal[0, 0] + 1e-9])
        line = shapes @ np.linalg.solve(normal, shapes.T @ (trusted * place))
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

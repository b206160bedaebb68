"""What is seen across an outline: two sides, each a level and a texture, and a step between them.

Either side is a level that changes slowly along the outline, and a texture. Across it the background changes linearly,
the object as Lambert's law has it for something turned. A texture is a Gaussian process whose covariance in colour and
whose correlation across are those seen beside the edge. A pixel of the edge shows both sides in proportion to the area
they cover.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr  # pyright: ignore[reportMissingTypeStubs, reportUnknownVariableType]

from rotrecon.arrays import Floats
from rotrecon.edges.edge_lines import ONE, Line, Stretch, bell, filtered
from rotrecon.edges.shading import Shading, shading_of
from rotrecon.edges.step_likelihood import log_likelihoods

LEAST_ZONE_PX = 1.0
"""Least width of a zone where a colour is one side's alone: with less, there is no telling how it changes."""
LEVEL_PX = 15.0
"""Standard deviation of the average along the outline that is a side's level there."""
NOISE = 0.005
"""Noise of linear light, of 1: an 8 bit camera's, in the middle of its range."""
COLOUR_FLOOR = 1e-6
"""Least variance of a colour, so that a perfectly even side has one."""
CORRELATION = (0.05, 0.9)
"""Bounds of a texture's correlation over one pixel: estimates from few samples beyond them mean nothing."""
CORRELATED_PX = 10.0
"""Distance along the outline within which steps err together: the average over likelihoods, and the texture's grain."""


@dataclass(frozen=True, eq=False)
class Profiles:
    """Colours across a line near an outline."""

    stretch: Stretch
    line: Line
    across_px: Floats
    """(T,) signed distance from the line, outward; 1 px apart where that is clear of the edge."""
    light: Floats
    """(3, T, N) linear light."""
    deep_px: Floats
    """(D,) distances farther inside, which tell how the object is shaded."""
    deep: Floats
    """(3, D, N) linear light there."""


@dataclass(frozen=True, eq=False)
class Model:
    """What is expected of profiles, and what was seen, in three channels whose textures are independent."""

    across_px: Floats
    seen: Floats
    """(3, T, N) less the level of the background."""
    step: Floats
    """(3, N) by how much the object's level is above the background's, each in its own zone."""
    background: Floats
    """(3, T) what the background changes by across."""
    inner: Floats
    """(3, T, T) covariance of the object's texture."""
    outer: Floats
    """(3, T, T) of the background's."""
    shading: Shading
    channels: Floats
    """(3, 3) of colours."""
    noise: Floats
    """(3,) variance."""
    contrast: Floats
    """(N,)"""

    def log_likelihood(self, place_px: Floats, blur_px: Floats, every: int = 1) -> Floats:
        """Of steps at K places with K blurs: (K, 3, N), by channel; `every` so many profiles."""
        inner = _covered((place_px[:, None] - self.across_px) / blur_px[:, None])
        shape = np.ascontiguousarray((self.shading.at(place_px) @ self.channels).transpose(2, 0, 1))
        shape -= self.background[:, None]
        seen, step = (np.ascontiguousarray(of_all[..., ::every]) for of_all in (self.seen, self.step))
        return log_likelihoods(inner, shape, seen, step, self.inner, self.outer, self.noise)


def _covered(distance: Floats) -> Floats:
    """The normal distribution's integral: how much of a blurred pixel lies inside an edge, at distances from it."""
    return np.asarray(ndtr(distance), dtype=np.float64)


def model_of(profiles: Profiles, clear_px: float) -> Model:
    """Of profiles on which a colour is one side's alone so far from the line."""
    across, light = profiles.across_px, profiles.light
    clear = min(clear_px, -float(across[0]) - LEAST_ZONE_PX)
    inside = light[:, : int(np.searchsorted(across, -clear, side="right"))]
    outside = light[:, int(np.searchsorted(across, clear)) :]
    along = bell(LEVEL_PX / profiles.stretch.spacing_px)
    shading = _shading(profiles, inside)
    shape, slope = shading.at(np.zeros(1))[0].T, _slope(across, outside)
    inner_level, inner_texture = _level(inside, shape[:, : inside.shape[1]], along)
    outer_level, outer_texture = _level(outside, slope[:, -outside.shape[1] :], along)
    # the channels in which both textures are uncorrelated
    whiten = np.linalg.inv(np.linalg.cholesky(_covariance(outer_texture)))
    ratio, turn = np.linalg.eigh(whiten @ _covariance(inner_texture) @ whiten.T)
    channels = np.asarray(whiten.T @ turn, dtype=np.float64)
    noise = NOISE**2 * (channels**2).sum(axis=0)
    step = channels.T @ (inner_level - outer_level)
    at_edge = int(np.abs(across).argmin())
    difference = step + channels.T @ (shape - slope)[:, at_edge, None]
    return Model(
        across_px=across,
        seen=_turned(light - outer_level[:, None] - slope[..., None], channels),
        step=step,
        background=channels.T @ slope,
        inner=_process(across, _turned(inner_texture, channels), ratio),
        outer=_process(across, _turned(outer_texture, channels), np.ones(3)),
        shading=shading,
        channels=channels,
        noise=noise,
        contrast=np.sqrt((difference**2 / (ratio + 1 + noise)[:, None]).sum(axis=0)),
    )


def _level(light: Floats, shape: Floats, along: Floats) -> tuple[Floats, Floats]:
    """A side's level (3, N) where it is alone, with a shape (3, Z) across, and its texture (3, Z, N) there."""
    level = filtered(light.mean(axis=1), ONE, along)
    return level, light - level[:, None] - shape[..., None]


def _slope(across_px: Floats, light: Floats) -> Floats:
    """What (3, T) a background's light changes by across, carried on from the zone (3, Z, N) where it is alone."""
    zone = across_px[-light.shape[1] :]
    distance, own = across_px - zone.mean(), zone - zone.mean()
    return (light.mean(axis=2) @ own / (own @ own))[:, None] * distance


def _shading(profiles: Profiles, inside: Floats) -> Shading:
    """Of the object, from its light (3, Z, N) beside the edge and farther inside."""
    stretch, zone = profiles.stretch, inside.shape[1]
    seen_px = np.concatenate([profiles.deep_px, profiles.across_px[:zone]])
    seen = np.concatenate([profiles.deep, inside], axis=1)
    independent = max(len(stretch) * stretch.spacing_px / CORRELATED_PX, 1.0)
    return shading_of(profiles.across_px, zone, float(np.median(stretch.half_width_px)), seen_px, seen, independent)


def _covariance(texture: Floats) -> Floats:
    flat = texture.reshape(3, -1)
    return flat @ flat.T / flat.shape[1] + COLOUR_FLOOR * np.eye(3)


def _process(across_px: Floats, texture: Floats, variance: Floats) -> Floats:
    """Covariance (3, T, T) of a texture (3, Z, N), 1 px apart, whose correlation falls off exponentially."""
    together = (texture[:, 1:] * texture[:, :-1]).mean(axis=(1, 2))
    correlation = (together / ((texture**2).mean(axis=(1, 2)) + COLOUR_FLOOR)).clip(*CORRELATION)
    return variance[:, None, None] * correlation[:, None, None] ** np.abs(across_px[:, None] - across_px)


def _turned(light: Floats, channels: Floats) -> Floats:
    """Colours (3, ...) in other channels (3, 3)."""
    return (channels.T @ light.reshape(3, -1)).reshape(light.shape)

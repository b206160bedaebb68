"""What is seen across an outline: two sides, each a level and a texture, and a step between them.

Either side is a level that changes slowly along the outline, and a texture. Across it the background changes linearly,
the object as Lambert's law has it for something turned. A texture is a Gaussian process whose covariance in colour and
whose correlation across are those seen beside the edge. A pixel of the edge shows both sides in proportion to the area
they cover.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr  # pyright: ignore[reportMissingTypeStubs, reportUnknownVariableType]

from rotrecon.arrays import Bools, Floats
from rotrecon.edges.edge_lines import Line, Stretch, bell, filtered
from rotrecon.edges.shading import Shading, shading_of

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
    """(N, T, 3) linear light."""
    deep_px: Floats
    """(D,) distances farther inside, which tell how the object is shaded."""
    deep: Floats
    """(N, D, 3) linear light there."""


@dataclass(frozen=True, eq=False)
class _Side:
    """One side's colours, in three channels whose textures are independent."""

    level: Floats
    """(3, T, N)"""
    covariance: Floats
    """(3, T, T) of the texture."""


@dataclass(frozen=True, eq=False)
class Model:
    """What is expected of profiles, and what was seen."""

    across_px: Floats
    seen: Floats
    """(3, T, N)"""
    inner: _Side
    outer: _Side
    shading: Shading
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


def _covered(distance: Floats) -> Floats:
    """The normal distribution's integral: how much of a blurred pixel lies inside an edge, at distances from it."""
    return np.asarray(ndtr(distance), dtype=np.float64)


def model_of(profiles: Profiles, clear_px: float) -> Model:
    """Of profiles on which a colour is one side's alone so far from the line."""
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
    difference = (inner_level[:, at_edge] @ channels).T - outer.level[:, at_edge]
    contrast = np.sqrt((difference**2 / (ratio + 1 + noise)[:, None]).sum(axis=0))
    return Model(across, _planes(light @ channels), inner, outer, shading, channels, noise, contrast)


def _level(light: Floats, zone: Bools, shape: Floats, along_rows: float) -> tuple[Floats, Floats]:
    """A side's level (N, T, 3), which has a shape (T, 3) across, and its texture (N, Z, 3) where it is alone."""
    level = filtered(light[:, zone].mean(axis=1), bell(along_rows))[:, None] + shape
    return level, light[:, zone] - level[:, zone]


def _slope(across_px: Floats, light: Floats, zone: Bools) -> Floats:
    """What (T, 3) a background's light changes by across, carried on from the zone where it is alone."""
    distance = across_px - across_px[zone].mean()
    mean = light[:, zone].mean(axis=0)
    return distance[:, None] * (distance[zone] @ mean / (distance[zone] ** 2).sum())


def _shading(profiles: Profiles, zone: Bools) -> Shading:
    seen_px = np.concatenate([profiles.deep_px, profiles.across_px[zone]])
    seen = np.concatenate([profiles.deep, profiles.light[:, zone]], axis=1)
    stretch = profiles.stretch
    independent = max(len(stretch) * stretch.spacing_px / CORRELATED_PX, 1.0)
    return shading_of(profiles.across_px, zone, float(np.median(stretch.half_width_px)), seen_px, seen, independent)


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

"""How far two views agree in brightness over a surface, pixel by pixel of the reference picture."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.compiled import FLOAT, MATRIX, VECTOR, compiled
from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.splines import Spline
from rotrecon.rays.fitting import UNSCALED, Prediction
from rotrecon.rays.losses import robust_scale, tukey
from rotrecon.rays.surfaces import Surface
from rotrecon.rays.traces import Rays

BRIGHTNESS_ROUNDS = 2
"""Reweighted rounds for gain and offset: the surface's own rounds go on from there."""
SHADE_LEVELS = 2.0
"""Grey levels by which light may come back differently to two cameras: a hundredth of what an 8 bit picture shows."""
LARGEST_SIGMA = 10.0
"""Grey levels by which pictures differ at a start."""
TOLD = 1e-15
"""Share of the largest eigenvalue of what all terms tell below which a direction is told nothing."""
LEAST_SIGMA = 1e-6
"""Grey; of pictures that agree to the last digit."""


@dataclass(frozen=True, eq=False)
class Change:
    """Residuals of pixels, and how each changes with the pixel's depth."""

    residual: Floats
    """(N,) grey values."""
    by_depth: Floats
    """(N,) of the predicted, grey values a metre."""
    px_by_depth: Floats
    """(N,) shift in the other picture, px a metre."""


@dataclass(frozen=True, eq=False)
class Agreement:
    """Grey values of the reference picture, which the other one has where the surface carries them.

    Gain and offset between the pictures are found anew for every surface, and the derivatives are those at the best
    gain and offset (variable projection, Kaufman 1975). So is how the light on it changes with the place it is seen
    from: no real surface is quite Lambert's, and what shading alone says of a size is off by several percent.
    """

    rays: Rays
    """(3, N) of the reference camera."""
    grey: Floats
    """(N,) of its picture, there, as if it were blurred along the other's pixels; see `smeared_apart`."""
    shades: Floats
    """(T, N) how light that comes back may differ between the views, each of about 1; see `shades_of`."""
    other: Spline
    """The other view's picture."""
    carrier: Carrier

    def __post_init__(self) -> None:
        freeze(self)

    def __len__(self) -> int:
        return len(self.grey)

    def predict(self, surface: Surface) -> Prediction:
        """Residuals and derivatives in grey values."""
        trace = surface.trace(self.rays)
        seen, by_depth, _ = self._seen(trace.depth_m)
        residual, weighted, inverse = self._balanced(seen)
        columns = trace.gradient * (trace.scale * by_depth)
        return Prediction(columns - (columns @ weighted.T) @ inverse @ self._terms, UNSCALED, residual)

    def along_rays(self, surface: Surface) -> Change:
        """Residuals, and how they change with each pixel's own depth by what is no shading."""
        seen, by_depth, px_by_depth = self._seen(surface.meet(self.rays)[0])
        terms = self._terms[1:]
        shading = by_depth @ terms.T @ np.linalg.pinv(terms @ terms.T, hermitian=True) @ terms
        return Change(self._balanced(seen)[0], by_depth - shading, np.hypot(*px_by_depth))

    def _seen(self, depth_m: Floats) -> tuple[Floats, Floats, Floats]:
        """What the other picture shows (N,), its change by depth (N,), and the place's (2, N)."""
        place_px, by_depth = self.carrier.carried(self.rays, depth_m)
        seen = self.other.at(place_px)
        by_depth[np.isnan(by_depth)] = 0.0
        return seen.grey, seen.by_u * by_depth[0] + seen.by_v * by_depth[1], by_depth

    @cached_property
    def _terms(self) -> Floats:
        """(2 + T, N) what gain, offset and shades change."""
        return np.concatenate([[self.grey - self.grey.mean(), np.ones(len(self.grey))], self.shades])

    @cached_property
    def _held(self) -> Floats:
        """(2 + T,) information that there is of each before anything is seen."""
        return np.concatenate([np.zeros(2), np.full(len(self.shades), SHADE_LEVELS**-2)])

    @cached_property
    def _at_first(self) -> Floats:
        """(2 + T, 2 + T) their covariance where every pixel counts alike."""
        return _covariance(self._terms, self._terms, self._held, LARGEST_SIGMA)

    def _balanced(self, seen: Floats) -> tuple[Floats, Floats, Floats]:
        """Residual (N,) without gain, offset and shades; their weighted terms (2 + T, N) and covariance."""
        return _balanced(self._terms, seen, self._held, self._at_first)

    def chosen(self, index: Indices | Bools) -> "Agreement":
        """Some of the pixels."""
        rays = np.ascontiguousarray(self.rays[:, index])
        return replace(self, rays=rays, grey=self.grey[index], shades=self.shades[:, index])


@compiled(MATRIX, MATRIX, VECTOR, FLOAT)
def _covariance(weighted: Floats, terms: Floats, held: Floats, sigma: float) -> Floats:
    """Covariance (k, k) of the amounts of terms (k, N); it is zero in directions that are told nothing."""
    information = weighted @ terms.T + np.diag(held) * sigma**2
    values, vectors = np.linalg.eigh(information)
    least = TOLD * np.abs(values).max()
    inverse = np.zeros(len(values))
    for i in range(len(values)):
        if abs(values[i]) > least:
            inverse[i] = 1.0 / values[i]
    return (vectors * inverse) @ vectors.T


@compiled(MATRIX, VECTOR, VECTOR, MATRIX)
def _balanced(terms: Floats, seen: Floats, held: Floats, at_first: Floats) -> tuple[Floats, Floats, Floats]:
    """See `Agreement._balanced`."""
    residual = (at_first @ (terms @ seen)) @ terms - seen
    weighted, inverse = terms.copy(), at_first.copy()
    for _ in range(BRIGHTNESS_ROUNDS):
        sigma = max(robust_scale(residual), LEAST_SIGMA)
        weighted = terms * tukey(residual / sigma)[1]
        inverse = _covariance(weighted, terms, held, sigma)
        residual = (inverse @ (weighted @ seen)) @ terms - seen
    return residual, weighted, inverse


def shades_of(normals: Floats) -> Floats:
    """How light may vary (8, N) over normals (3, N): the spherical harmonics of first and second order.

    Those are all that a matt surface gives back of any light, to 1 % (Basri and Jacobs 2003).
    """
    x, y, z = normals
    return np.stack([x, y, z, x * y, y * z, z * x, x * x - y * y, 3 * z * z - 1])

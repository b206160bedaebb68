"""Which depths near the limbs can be believed: all, those that a matching window explains, or only inner ones."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.fitting import Outline
from rotrecon.patch import Patch
from rotrecon.ray_fit import RayFit, Sight, fine
from rotrecon.surfaces import Surface

MATCHED = 0.25
"""Errors less alike than this are not those of matching windows, which is what limbs suffer from."""
INNER_GUARD = 0.65
"""Share of the radius within which depth is taken as it is: surfaces turn away by less than 40 degrees there."""
GUARDS = (0.95, 0.9, 0.85, 0.8, 0.75, 0.7)
"""Tried in turn where neither all depths nor a window agree with the inner ones."""
WINDOW_OVER_CORRELATION = 1.6
"""A window's side over the length at which errors it smooths are alike to 1/e."""
LARGEST_WINDOW_PX = 11
ROUGHER = 1.1
"""Depths that err in one way alone do not become rougher toward the limbs by more than this, and by chance."""
CHANCE = 2.5
"""Standard deviations by which a size may differ from that of the inner depths."""
CORRECTION_DOUBT = 0.25
"""Standard deviation of a correction for the limbs, over the correction."""
FEWEST_INDEPENDENT = 8.0
"""Inner depths that are fewer than that can judge nothing."""

Outlines = tuple[tuple[Outline, float], ...]


@dataclass(frozen=True, eq=False)
class Task:
    """What is to be fitted."""

    patch: Patch
    units: Floats
    free: Bools
    outlines: Outlines


def settle(surface: Surface, task: Task) -> RayFit | None:
    """The fit to as many depths as agree with the inner ones (Hausman 1978: an efficient estimate is believed while it
    agrees with one that rests on less)."""
    whole = _fit(surface, task, Sight())
    if whole is None or surface.side > 0 or whole.likeness.alike < MATCHED:
        return whole
    inner = _fit(whole.surface, task, Sight(guard=INNER_GUARD))
    window_px = _odd(WINDOW_OVER_CORRELATION * max(whole.likeness.length_px, task.patch.noise.correlation_px))
    windowed = _fit(surface, task, Sight(window_px)) if 3 <= window_px <= LARGEST_WINDOW_PX else None
    smoothest = min((fit for fit in (whole, windowed) if fit), key=lambda fit: fit.sigma)
    if inner is None or _agrees(smoothest, inner):
        return smoothest if smoothest is whole else _doubting(smoothest, whole)
    for guard in GUARDS:
        guarded = _fit(inner.surface, task, Sight(guard=guard))
        if guarded is not None and _agrees(guarded, inner):
            return _doubting(guarded, whole)
    return _doubting(inner, whole)


def _fit(surface: Surface, task: Task, sight: Sight) -> RayFit | None:
    return fine(surface, task.patch, task.units, task.free, sight, task.outlines)


def _agrees(fit: RayFit, inner: RayFit) -> bool:
    """Whether a fit to more depths is as smooth as the inner one, and of the same size."""
    independent = max(inner.independent, FEWEST_INDEPENDENT)
    rougher = fit.sigma > inner.sigma * (ROUGHER + 1.0 / np.sqrt(2.0 * independent))
    variance = np.maximum(np.diag(inner.covariance) - np.diag(fit.covariance), 0.0)[_size_of(fit)]
    apart = abs(fit.surface.size_m - inner.surface.size_m)
    return not rougher and bool(apart <= CHANCE * np.sqrt(variance) + 1e-6)


def _doubting(fit: RayFit, whole: RayFit) -> RayFit:
    """A fit whose radius is less sure by a share of what the limbs, taken as they are, would have changed."""
    place = _size_of(fit)
    covariance = fit.covariance.copy()
    covariance[place, place] += (CORRECTION_DOUBT * (fit.surface.size_m - whole.surface.size_m)) ** 2
    return replace(fit, covariance=covariance)


def _size_of(fit: RayFit) -> int:
    """Place of the radius among the parameters."""
    return 3 if len(fit.free) == 4 else 4


def _odd(value: float) -> int:
    return 2 * int(value / 2) + 1

"""Which depths near the limbs can be believed: all, those that a matching window explains, or only inner ones."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.rays.doubting import doubting, sizes_of
from rotrecon.rays.fitting import Outlines
from rotrecon.rays.losses import tukey
from rotrecon.rays.passing import pull_of
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import FINE_ROUNDS, MOST_DIFFERENCES, RayFit, Sight, by_differences, fine, predicted
from rotrecon.rays.surfaces import Surface

MATCHED = 0.25
"""Errors less alike than this are not those of matching windows, which is what limbs suffer from."""
INNER_GUARD = 0.6
"""Share of the radius within which depth is taken as it is: surfaces turn away by less than 40 degrees there."""
GUARDS = (0.7, 0.75, 0.8, 0.85, 0.9, 0.95)
"""The widest that agrees with the inner depths is sought where neither all depths nor a window do."""
WINDOW_OVER_CORRELATION = 1.6
"""A window's side over the length at which errors it smooths are alike to 1/e."""
LARGEST_WINDOW_PX = 11
ROUGHER = 1.1
"""Depths that err in one way alone do not become rougher toward the limbs by more than this, and by chance."""
CHANCE, SUSPICION = 3.5, 1.0
"""Standard deviations by which inner depths may be explained worse, and by which a size may differ from theirs."""
WINDOWS_AT_MOST = 1.3
"""Times as rough as the inner ones, at most, windows alone make all depths (measured on simulated stereo)."""
DECISIVE = 1.03
"""Ratio of their roughness at which the limbs themselves decide between windows and none."""
BORNE_OUT, TELLS_MORE = 5.0, 0.9
"""Standard deviations of a fit by which differences of its depths may have another size, and most they may have of its
own."""
LITTLE = 0.1
"""Standard deviations that are not worth another fit."""
SCOUTS = 3000
"""Depths whose differences are asked first."""
FEWEST_INDEPENDENT = 8.0
"""Inner depths that are fewer than that can judge nothing."""


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
    if whole is None or surface.side > 0:
        return whole
    if whole.likeness.alike < MATCHED:
        return _fit(whole.surface, task, Sight(limited=True)) if _hides_much(whole, task.patch) else whole
    differenced = _by_differences(whole, task)
    if differenced is not None:
        return differenced
    inner = _fit(whole.surface, task, Sight(guard=INNER_GUARD))
    window_px = _odd(WINDOW_OVER_CORRELATION * max(whole.likeness.length_px, task.patch.noise.correlation_px))
    explicable = inner is None or whole.sigma < WINDOWS_AT_MOST * inner.sigma
    windowed = None
    if explicable and 3 <= window_px <= LARGEST_WINDOW_PX:
        windowed = _fit(surface, task, Sight(window_px))
    smoothest = min((fit for fit in (whole, windowed) if fit), key=lambda fit: fit.sigma)
    roughest = max((fit for fit in (whole, windowed) if fit), key=lambda fit: fit.sigma)
    decisive = roughest.sigma > DECISIVE * smoothest.sigma
    if inner is None or (_as_smooth(smoothest, inner) and (decisive or _explains(smoothest, inner, task.patch))):
        return smoothest if smoothest is whole else doubting(smoothest, whole)
    best, narrow, wide = inner, 0, len(GUARDS)
    while narrow < wide:
        middle = (narrow + wide) // 2
        guarded = _fit(whole.surface, task, Sight(guard=GUARDS[middle]))
        if guarded is not None and _as_smooth(guarded, inner) and _as_large(guarded, inner):
            best, narrow = guarded, middle + 1
        else:
            wide = middle
    return doubting(best, whole)


def _fit(surface: Surface, task: Task, sight: Sight) -> RayFit | None:
    return fine(surface, task.patch, task.units, task.free, sight, task.outlines)


def _hides_much(fit: RayFit, patch: Patch) -> bool:
    """Whether what is seen behind a fit to depths would move it by more than a little of what it may be off."""
    pull = pull_of(fit.surface, patch, fit.sigma)
    return float(pull @ fit.covariance @ pull) > LITTLE**2


def _by_differences(whole: RayFit, task: Task) -> RayFit | None:
    """The fit to differences of depths, or None where it contradicts that to the depths: limbs mislead it first.

    Where only errors are alike they agree, and differences tell more (Gauss and Markov).
    """
    sizes = slice(whole.surface.size_place, None)
    plain = whole.covariance[sizes, sizes]
    fit = replace(whole, sight=Sight(differences=True))
    for most, rounds in ((SCOUTS, 1), (MOST_DIFFERENCES, FINE_ROUNDS)):
        fit = by_differences(fit, task.patch, task.units, most, rounds)
        apart = sizes_of(fit.surface) - sizes_of(whole.surface)
        both = plain + fit.covariance[sizes, sizes]
        # two that end at the same limit have not been compared
        if not apart.any() or not np.isfinite(both).all():
            return None
        if apart @ np.linalg.pinv(both, hermitian=True) @ apart > BORNE_OUT**2:
            return None
    return fit if np.linalg.det(fit.covariance[sizes, sizes]) < TELLS_MORE**2 * np.linalg.det(plain) else None


def _as_smooth(fit: RayFit, inner: RayFit) -> bool:
    """Whether a fit to more depths is as smooth as the inner one."""
    independent = max(inner.independent, FEWEST_INDEPENDENT)
    return fit.sigma <= inner.sigma * (ROUGHER + 0.5 / np.sqrt(2.0 * independent))


def _explains(fit: RayFit, inner: RayFit, patch: Patch) -> bool:
    """Whether a fit to more depths explains the inner ones nearly as well as their own fit does.

    Twice the difference of the costs has a chi-square distribution with as many degrees as parameters (Wilks 1938).
    """
    own, other = (
        float(tukey(predicted(patch, inner.pixels, one.surface, Sight()).residual / inner.sigma)[0].sum())
        for one in (inner, fit)
    )
    degrees = int(inner.free.sum())
    return 2 * inner.likeness.independent_share * (other - own) <= degrees + CHANCE * np.sqrt(2 * degrees)


def _as_large(fit: RayFit, inner: RayFit) -> bool:
    """Whether a fit to more depths has the size of the inner one, as nearly as where limbs are seen to mislead."""
    variance = np.maximum(np.diag(inner.covariance) - np.diag(fit.covariance), 0.0)[fit.surface.size_place]
    apart = abs(fit.surface.size_m - inner.surface.size_m)
    return bool(apart <= SUSPICION * np.sqrt(variance) + 1e-6)


def _odd(value: float) -> int:
    """The odd number nearest to a value, of two the smaller."""
    return 2 * int(np.ceil(value / 2)) - 1

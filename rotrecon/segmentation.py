"""Which pixels of each cross segment belong to the closest object, by depth alone (paper 3.2)."""

from dataclasses import dataclass
from enum import IntFlag

import numpy as np

from rotrecon.arrays import Bools, Bytes, Cloud, Floats, freeze
from rotrecon.settings import Settings


class PixelHistory(IntFlag):
    """What befell a pixel on its way through paper 3.2; several may be true of one pixel."""

    DEPTH = 1
    """It has a depth the arm can use."""
    DISTANT = 2
    """Farther than its section's mean in one of the runs of steps 1 to 3."""
    OUTLIER = 4
    """More than three sigma from the mean, equation (3)."""
    GROWN_FORWARD = 8
    """Brought back by the scan along the section, equation (4)."""
    GROWN_BACKWARD = 16
    """Brought back by the scan the other way, equation (5)."""
    SPARSE_LINE = 32
    """On a longitudinal line with too few segmented pixels, equation (6)."""


@dataclass(frozen=True, eq=False)
class Segmentation:
    """The object's pixels, and why every other pixel is not one; S sections of W pixels, N - 1 runs."""

    kept: Bools
    """(S, W) the segmented object."""
    history: Bytes
    """(S, W) PixelHistory flags."""
    removed_in_run: Bytes
    """(S, W) the run, from 1, that called the pixel distant; 0 for none."""
    mean_m: Floats
    """(runs, S) mean depth of what each run left, equation (1); the last row is used by (3)."""
    sigma_m: Floats
    """(runs, S) standard deviation of what each run left, equation (2); the last row is used by (3) to (5)."""
    line_density: Floats
    """(W,) share of segmented pixels among a longitudinal line's pixels with depth, equation (6)."""
    line_coverage: Floats
    """(W,) share of pixels with depth among a longitudinal line's pixels, equation (6)."""

    def __post_init__(self) -> None:
        freeze(self)

    def counts(self, row: int) -> dict[str, int]:
        """How many pixels of one section have depth, and each step of paper 3.2 removed, brought back and left."""
        history, removed_in_run = self.history[row], self.removed_in_run[row]
        runs = {f"distant in run {run}": removed_in_run == run for run in range(1, removed_in_run.max(initial=1) + 1)}
        grown = PixelHistory.GROWN_FORWARD | PixelHistory.GROWN_BACKWARD
        steps = {
            "with depth": history & PixelHistory.DEPTH > 0,
            **runs,
            "outlier": history & PixelHistory.OUTLIER > 0,
            "grown back": history & grown > 0,
            "on a sparse line": history & PixelHistory.SPARSE_LINE > 0,
            "kept": self.kept[row],
        }
        return {step: int(members.sum()) for step, members in steps.items()}


def segment(depth_m: Cloud, usable: Bools, inside: Bools, settings: Settings) -> Segmentation:
    """Segment the closest object in every section at once.

    `depth_m` (S, W) is depth along the camera's z, `usable` (S, W) says where it is known and within the arm's
    limits, `inside` (S, W) where the cell lies in the area. Pixels that are not usable are in no set, and stop a scan.
    """
    close, removed_in_run, means, sigmas = _remove_distant(depth_m, usable, settings)
    mean, sigma = means[-1], sigmas[-1]
    reach = np.maximum(settings.sigma_factor * sigma, settings.distance_floor_m).astype(np.float32)[:, None]
    outlier = close & ~_within(depth_m, mean.astype(np.float32)[:, None], reach)
    accepted = close & ~outlier
    linked = np.zeros_like(usable)
    linked[:, 1:] = usable[:, 1:] & usable[:, :-1] & _within(depth_m[:, 1:], depth_m[:, :-1], reach)
    forward = _scan(accepted, linked)
    backward = _scan_back(forward, linked)
    density, coverage = _line_shares(backward, usable, inside)
    sparse = (density < settings.line_density) & (coverage < settings.line_coverage)
    history = usable * np.uint8(PixelHistory.DEPTH)
    history |= (removed_in_run > 0) * np.uint8(PixelHistory.DISTANT)
    history |= outlier * np.uint8(PixelHistory.OUTLIER)
    history |= (forward & ~accepted) * np.uint8(PixelHistory.GROWN_FORWARD)
    history |= (backward & ~forward) * np.uint8(PixelHistory.GROWN_BACKWARD)
    history |= (backward & sparse) * np.uint8(PixelHistory.SPARSE_LINE)
    return Segmentation(backward & ~sparse, history, removed_in_run, means, sigmas, density, coverage)


def _remove_distant(depth_m: Cloud, usable: Bools, settings: Settings) -> tuple[Bools, Bytes, Floats, Floats]:
    """Steps 1 to 3 of paper 3.2, N - 1 times: drop what is farther than its section's mean, equations (1), (2)."""
    close = usable.copy()
    removed_in_run = np.zeros(usable.shape, dtype=np.uint8)
    mean, sigma = _mean_and_sigma(depth_m, close)
    means, sigmas = [mean], [sigma]
    for run in range(1, settings.layers):
        limit = (mean + settings.distance_floor_m).astype(np.float32)[:, None]
        distant = close & (depth_m > limit)
        removed_in_run[distant] = run
        close &= ~distant
        mean, sigma = _mean_and_sigma(depth_m, close)
        means.append(mean)
        sigmas.append(sigma)
    first_shown = min(1, len(means) - 1)
    return close, removed_in_run, np.array(means[first_shown:]), np.array(sigmas[first_shown:])


def _mean_and_sigma(depth_m: Cloud, members: Bools) -> tuple[Floats, Floats]:
    """Mean and standard deviation (S,) of each section's members; NaN for a section without any."""
    count = members.sum(axis=1).astype(np.float64)
    count[count == 0] = np.nan
    mean = np.where(members, depth_m, 0).sum(axis=1, dtype=np.float64) / count
    deviation = depth_m - mean.astype(np.float32)[:, None]
    np.copyto(deviation, 0, where=~members)
    return mean, np.sqrt(np.square(deviation, out=deviation).sum(axis=1, dtype=np.float64) / count)


def _within(depth_m: Cloud, reference_m: Cloud, reach_m: Cloud) -> Bools:
    """Where (S, W) a depth lies no farther than `reach_m` (S, 1) from another."""
    apart = depth_m - reference_m
    return np.abs(apart, out=apart) <= reach_m


def _scan(accepted: Bools, linked: Bools) -> Bools:
    """Equation (4) for all sections: a pixel joins when an unbroken chain of links leads to it from an accepted one.

    `linked` (S, W) says that a pixel is within three sigma of the one before it. The chain that holds pixel w starts
    at the last broken link; w joins when the last accepted pixel up to w lies in that chain.
    """
    column = np.arange(accepted.shape[1], dtype=np.min_scalar_type(-accepted.shape[1]))
    chain_start = np.where(linked, column[:1], column)
    np.maximum.accumulate(chain_start, axis=1, out=chain_start)
    last_accepted = np.where(accepted, column, column.dtype.type(-1))
    np.maximum.accumulate(last_accepted, axis=1, out=last_accepted)
    return last_accepted >= chain_start


def _scan_back(accepted: Bools, linked: Bools) -> Bools:
    """Equation (5): the same scan from the other end."""
    mirrored_links = np.zeros_like(linked)
    mirrored_links[:, 1:] = linked[:, :0:-1]
    return _scan(accepted[:, ::-1], mirrored_links)[:, ::-1]


def _line_shares(kept: Bools, usable: Bools, inside: Bools) -> tuple[Floats, Floats]:
    """The two ratios (W,) of equation (6) for every longitudinal line; 0 for a line without pixels."""
    in_cloud = usable.sum(axis=0)
    density = kept.sum(axis=0) / np.maximum(in_cloud, 1)
    coverage = in_cloud / np.maximum(inside.sum(axis=0), 1)
    return density, coverage

"""The paper's method with one of its steps, or one error of its camera, replaced by the truth."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from app.bench.composition import Mask, Steps
from app.bench.poses import STEREO, Pose
from rotrecon.arrays import Bools, Indices
from rotrecon.simulation.stereo_noise import StereoErrors


@dataclass(frozen=True)
class Variation:
    """What is replaced, in words and in deed."""

    name: str
    steps: Callable[[Pose], Steps]
    errors: StereoErrors | None = STEREO


def _paper(pose: Pose) -> Steps:
    return Steps()


def _true_mask(pose: Pose) -> Mask:
    shows_object = pose.simulated.view.mask.ravel()

    def mask(kept: Bools, pixel: Indices) -> Bools:
        return shows_object[pixel] & (pixel >= 0)

    return mask


def _limbs_cut(pixels: int) -> Mask:
    """What 3.2 keeps, less the outermost pixels at both ends of each section."""

    def mask(kept: Bools, pixel: Indices) -> Bools:
        return kept & (kept.cumsum(axis=1) > pixels) & (kept[:, ::-1].cumsum(axis=1)[:, ::-1] > pixels)

    return mask


def _limbs_lost(pose: Pose, share: float) -> Mask:
    """The true mask, less a share of each section's pixels at each end."""
    whole = _true_mask(pose)

    def mask(kept: Bools, pixel: Indices) -> Bools:
        object_pixels = whole(kept, pixel)
        rank = object_pixels.cumsum(axis=1)
        lost = share * object_pixels.sum(axis=1, keepdims=True)
        return object_pixels & (rank > lost) & (rank <= rank[:, -1:] - lost)

    return mask


def _lost(share: float) -> Callable[[Pose], Steps]:
    return lambda pose: Steps(mask=_limbs_lost(pose, share))


EXACT = Variation("exact depth", _paper, None)
EXACT_UNREJECTED = Variation("exact depth, nothing rejected", lambda pose: Steps(reject=False), None)
NOISY = Variation("the paper's method", _paper)
NOISY_UNREJECTED = Variation("no centre and no radius rejected", lambda pose: Steps(reject=False))
LIMBS_CUT = Variation("4 px cut off both ends of each section", lambda pose: Steps(mask=_limbs_cut(4)))
TRUE_MASK = Variation("true mask for the segmentation of 3.2", lambda pose: Steps(mask=_true_mask(pose)))
ALL_POINTS = Variation("circle through all points, not three", lambda pose: Steps(least_squares=True))

STEPS_REPLACED = (
    NOISY,
    TRUE_MASK,
    Variation("2 px cut off both ends of each section", lambda pose: Steps(mask=_limbs_cut(2))),
    LIMBS_CUT,
    ALL_POINTS,
    Variation("true axis for the second cut", lambda pose: Steps(axis=pose.axis)),
    NOISY_UNREJECTED,
    Variation(
        "true mask, all points, true axis",
        lambda pose: Steps(mask=_true_mask(pose), axis=pose.axis, least_squares=True),
    ),
)

NO_WINDOWS = Variation("noise, no windows", _paper, replace(STEREO, window_px=1))
WHITE_ALL_POINTS = Variation(
    "white noise, no windows, all points",
    lambda pose: Steps(least_squares=True),
    replace(STEREO, window_px=1, correlation_px=0.0),
)

ERRORS_REPLACED = (
    NOISY,
    Variation("windows, no noise", _paper, replace(STEREO, disparity_sigma_px=0.0)),
    Variation("windows that do not grow the outline", _paper, replace(STEREO, foreground_share=0.5)),
    NO_WINDOWS,
    Variation("white noise, no windows", _paper, replace(STEREO, window_px=1, correlation_px=0.0)),
    WHITE_ALL_POINTS,
)

LIMBS_LOST = tuple(
    Variation(f"{100 * share:.0f} % of the width lost at each limb, exact depth", _lost(share), None)
    for share in (0.0, 0.05, 0.15, 0.25)
)

VARIATIONS = (EXACT, EXACT_UNREJECTED, *STEPS_REPLACED, *ERRORS_REPLACED[1:], *LIMBS_LOST)

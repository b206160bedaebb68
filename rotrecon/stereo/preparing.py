"""What several views tell before any pixel is matched: which pairs are worth it, and where to look."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Cloud, Floats, freeze
from rotrecon.frame import FrameUnavailable, View
from rotrecon.stereo.epipolar import FEWEST, check_epipolar
from rotrecon.stereo.exposure import exposure_problem
from rotrecon.stereo.features import Features, features_of
from rotrecon.stereo.geometry import pair_of
from rotrecon.stereo.limits import NEAREST_M, Limits, depth_limits
from rotrecon.stereo.rectification import Rectification
from rotrecon.stereo.scouting import scout, span
from rotrecon.workspace import Workspace

FEATURE_MARGIN = 0.25
"""Of the disparity of the nearest and the farthest feature: surfaces reach nearer and farther than their features."""
TAIL = 0.005
"""Share of features and scouted pixels at either end that may be wrong."""
FEWEST_SCOUTED = 30
"""Pixels at a quarter of the resolution: fewer are no surface."""
NEAR = 0.9
"""Quantile of disparities: nearer surfaces are few."""
LEAST_PARALLAX_PX = 6.0
"""Disparity of the nearest surfaces below which their depth would err by 3 % and more."""
GOOD_PARALLAX_PX = 60.0
"""Disparity that is worth moving the camera for: depth then errs by some 0.3 %."""
MOST_PAIRS = 4
"""More pairs take time and share the reference's picture: a fifth one lessens the noise by less than a twentieth."""


@dataclass(frozen=True, eq=False)
class Pair:
    """The reference and one other view, ready to be matched."""

    number: int
    """Of the other view, counted from 0, which is the reference."""
    rectification: Rectification
    scouted: Cloud
    """(h / 4, w / 4) inverse depth along the reference's z, 1/m; NaN where there is none."""
    inverse_depths: tuple[float, float]
    """Smallest and largest that surfaces have, 1/m."""
    features: Floats
    """(N, 2) pixels of the reference with features that lie on their rows."""
    moved: Floats
    """(M, 2) pixels of the reference whose features have left their rows together: something has moved."""
    epipolar_error_px: float | None
    """How far features lie off their rows, in the median; None for too few to say."""

    parallax_px: float
    """Disparity of near surfaces: nine of ten are smaller."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class Prepared:
    """Views with the pairs that are worth matching, the best first."""

    views: tuple[View, ...]
    workspace: Workspace
    pairs: tuple[Pair, ...]
    left_out: tuple[str, ...]
    """Why other views are not used."""


def prepare(views: tuple[View, ...], workspace: Workspace) -> Prepared | FrameUnavailable:
    """Choose the pairs of the first view with the others that are worth matching; or say why there are none."""
    if (problem := exposure_problem(views[0].image.reshape(-1, 3))) is not None:
        return FrameUnavailable(f"the picture of view 1 {problem}")
    reference = features_of(views[0])
    limits = depth_limits(workspace, views[0].T_base_camera)
    found = [_prepare_pair(views, number, reference, limits) for number in range(1, len(views))]
    pairs = sorted((pair for pair in found if isinstance(pair, Pair)), key=lambda pair: -pair.parallax_px)
    left_out = tuple(f"view {number}: {why}" for number, why in enumerate(found, 2) if isinstance(why, str))
    if not pairs:
        return FrameUnavailable("the views cannot be matched with the first one: " + "; ".join(left_out))
    return Prepared(views, workspace, tuple(pairs[:MOST_PAIRS]), left_out)


def _prepare_pair(views: tuple[View, ...], number: int, reference: Features, limits: Limits) -> Pair | str:
    if (problem := exposure_problem(views[number].image.reshape(-1, 3))) is not None:
        return f"its picture {problem}"
    rectification = pair_of(views, number, limits)
    if isinstance(rectification, str):
        return rectification
    checked = check_epipolar(rectification, reference, features_of(views[number]))
    if isinstance(checked, str):
        return checked
    if len(checked.good.disparity_px) < FEWEST:
        return (
            f"only {len(checked.good.disparity_px)} features of view 1 are found in it: too little contrast to check "
            "the poses, and noise may be matched with noise; light the scene, or project a pattern on it"
        )
    scouted = scout(rectification, limits)
    inverse_depths = _where_to_look(checked.good.inverse_depths(rectification), scouted, limits)
    parallax_px = float(np.quantile(checked.good.disparity_px, NEAR))
    if parallax_px < LEAST_PARALLAX_PX:
        needed_m = rectification.baseline_m * GOOD_PARALLAX_PX / max(parallax_px, 1.0)
        return (
            f"its camera is only {1000 * rectification.baseline_m:.0f} mm beside that of view 1, which moves near "
            f"surfaces by {parallax_px:.1f} px; move it by {1000 * needed_m:.0f} mm or more"
        )
    good_px = checked.good.reference_px
    return Pair(number, rectification, scouted, inverse_depths, good_px, checked.moved, checked.error_px, parallax_px)


def _where_to_look(features: Floats, scouted: Cloud, limits: Limits) -> tuple[float, float]:
    """Inverse depths (1/m) between which surfaces lie: as the limits say, else as features and scouted pixels show."""
    low = None if limits.farthest_m is None else 1 / limits.farthest_m
    high = None if limits.nearest_m is None else 1 / limits.nearest_m
    if low is not None and high is not None:
        return (low, high)
    spans = (span(features.astype(np.float32), TAIL, FEWEST), span(scouted, TAIL, FEWEST_SCOUTED))
    seen = [ends for ends in spans if ends is not None]
    if low is None:
        low = max(min(end for end, _ in seen) * (1 - FEATURE_MARGIN), 0.0)
    if high is None:
        high = min(max(end for _, end in seen) * (1 + FEATURE_MARGIN), 1 / NEAREST_M)
    return (low, max(low, high))

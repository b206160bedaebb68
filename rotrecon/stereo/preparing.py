"""What several views tell before any pixel is matched: which pairs are worth it, and where to look."""

from dataclasses import dataclass

import numpy as np

from rotrecon.frame import FrameUnavailable, View
from rotrecon.stereo.canvas import whole
from rotrecon.stereo.features import Features, Matches, features_of, in_common_planes, matched
from rotrecon.stereo.limits import depth_limits, inverse_depths_of_features, inverse_depths_of_limits
from rotrecon.stereo.rectification import Rectification, rectify
from rotrecon.workspace import Workspace

ROW_TOLERANCE_PX = 3.0


@dataclass(frozen=True, eq=False)
class Pair:
    """The reference and one other view, ready to be matched."""

    number: int
    """Of the other view."""
    rectification: Rectification
    inverse_depths: tuple[float, float]
    """Smallest and largest that are looked for, 1/m, in the common planes."""
    matches: Matches
    """Features that agree with the poses."""
    epipolar_error_px: float


@dataclass(frozen=True, eq=False)
class Prepared:
    """Views with the pairs that are worth matching, the best first."""

    views: tuple[View, ...]
    workspace: Workspace
    pairs: tuple[Pair, ...]


def prepare(views: tuple[View, ...], workspace: Workspace) -> Prepared | FrameUnavailable:
    """Choose the pairs of the first view with the others that are worth matching; or say why there are none."""
    features = [features_of(view) for view in views]
    pairs: list[Pair] = []
    for number in range(1, len(views)):
        pair = _pair(number, views, features, workspace)
        pairs.append(pair)
    return Prepared(views, workspace, tuple(pairs))


def _pair(number: int, views: tuple[View, ...], features: list[Features], workspace: Workspace) -> Pair:
    rectification = rectify(views[0], views[number])
    matches = in_common_planes(rectification, *matched(features[0], features[number]))
    good = np.abs(matches.row_error_px) < ROW_TOLERANCE_PX
    matches = Matches(*(field[good] for field in vars(matches).values()))
    low, high = inverse_depths_of_limits(
        depth_limits(workspace, views[0].T_base_camera), rectification, whole(views[0].camera)
    )
    seen_low, seen_high = inverse_depths_of_features(matches, rectification)
    found = (seen_low if low is None else low, seen_high if high is None else high)
    return Pair(number, rectification, found, matches, float(np.median(np.abs(matches.row_error_px))))

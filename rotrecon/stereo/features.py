"""Points that are seen in two pictures, found without any knowledge of the poses: they check what the poses say."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bools, Bytes, Floats, freeze
from rotrecon.frame import View
from rotrecon.stereo.canvas import through
from rotrecon.stereo.rectification import Rectification

MOST_FEATURES = 2000
"""A picture: enough to see every object that has texture; matching takes time with the square of it."""
DISTINCT = 0.75
"""Distance of the best match over that of the second best, above which it may be either (Lowe 2004 has 0.8)."""


@dataclass(frozen=True, eq=False)
class Features:
    """ORB features of one picture (Rublee et al. 2011)."""

    pixels: Floats
    """(N, 2)"""
    descriptors: Bytes
    """(N, 32)"""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class Matches:
    """The same points seen by a pair of views."""

    reference_px: Floats
    """(N, 2) pixels of the reference; `other_px` those of the other view."""
    other_px: Floats
    disparity_px: Floats
    """(N,) in the common planes, at the reference's focal length."""
    row_error_px: Floats
    """(N,) rows between the two there, with its sign: 0 if poses, cameras and matches are right."""

    def __post_init__(self) -> None:
        freeze(self)

    def chosen(self, index: Bools | NDArray[np.intp]) -> "Matches":
        """Some of them."""
        return Matches(
            self.reference_px[index], self.other_px[index], self.disparity_px[index], self.row_error_px[index]
        )

    def inverse_depths(self, pair: Rectification) -> Floats:
        """(N,) along the reference's z, 1/m."""
        ratios = pair.depth_ratios(self.reference_px)
        return self.disparity_px * ratios / (pair.reference.camera.focal_px * pair.baseline_m)


def features_of(view: View) -> Features:
    """Features of a picture; N may be 0."""
    grey = cv2.cvtColor(view.image, cv2.COLOR_RGB2GRAY)
    points, descriptors = cv2.ORB.create(MOST_FEATURES).detectAndCompute(grey, None)
    if not points:
        return Features(np.empty((0, 2)), np.empty((0, 32), dtype=np.uint8))
    return Features(np.array([point.pt for point in points], dtype=np.float64), np.asarray(descriptors, np.uint8))


def matched(reference: Features, other: Features) -> tuple[Floats, Floats]:
    """Pixels (N, 2) of the reference and of the other picture that show the same, both agreeing on it."""
    if len(reference.pixels) < 2 or len(other.pixels) < 2:
        return np.empty((0, 2)), np.empty((0, 2))
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING)
    forth = matcher.knnMatch(reference.descriptors, other.descriptors, k=2)
    back = {one.queryIdx: one.trainIdx for one in matcher.match(other.descriptors, reference.descriptors)}
    distinct = [best for best, second in forth if best.distance < DISTINCT * second.distance]
    both = [(one.queryIdx, one.trainIdx) for one in distinct if back[one.trainIdx] == one.queryIdx]
    pairs = np.array(both, dtype=np.intp).reshape(-1, 2)
    return reference.pixels[pairs[:, 0]], other.pixels[pairs[:, 1]]


def in_common_planes(pair: Rectification, reference_px: Floats, other_px: Floats) -> Matches:
    """Matched pixels (N, 2) of a pair seen in its common planes."""
    K = np.diag([pair.reference.camera.focal_px] * 2 + [1.0])
    first = through(K @ pair.R_reference @ np.linalg.inv(pair.reference.camera.K), reference_px)
    second = through(K @ pair.R_other @ np.linalg.inv(pair.other.camera.K), other_px)
    return Matches(reference_px, other_px, first[:, 0] - second[:, 0], second[:, 1] - first[:, 1])

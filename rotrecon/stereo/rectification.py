"""Two views of any relative pose brought to one pair of planes: a point is seen in the same row of both."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.camera import inverse
from rotrecon.frame import View

QUARTER_TURN = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Turns down to right in the picture's plane."""


@dataclass(frozen=True, eq=False)
class Rectification:
    """How the cameras of a pair are turned so that the second one stands to the right of the first, side by side."""

    reference: View
    other: View
    R_reference: Floats
    """(3, 3) turns directions of the reference camera into the common planes."""
    R_other: Floats
    """(3, 3) the same of the other camera."""
    baseline_m: float

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def along_sight(self) -> float:
        """Share of the way from camera to camera that goes along the reference's line of sight, 0 to 1."""
        return abs(float(self.R_reference[0, 2]))

    def depth_ratios(self, pixels: Floats) -> Floats:
        """Depth in the common planes over depth along the reference's z, (n,), at its pixels (n, 2)."""
        row = self.R_reference[2] @ np.linalg.inv(self.reference.camera.K)
        return pixels @ row[:2] + row[2]


def rectify(reference: View, other: View) -> Rectification:
    """The rotations that rectify a pair, for any pose but equal ones (Bouguet's, as `cv2.stereoRectify` has it).

    OpenCV leaves the second camera at any of four sides; a turn by quarters brings it to the right, so that
    disparities are positive along rows whatever the pose. Raises ValueError for cameras in one place.
    """
    T_other_reference = inverse(other.T_base_camera) @ reference.T_base_camera
    place = inverse(T_other_reference)[:3, 3]
    baseline_m = float(np.linalg.norm(place))
    if baseline_m == 0.0:
        raise ValueError("views from one place cannot be rectified; test their distance first")
    size = (reference.camera.width, reference.camera.height)
    R_reference, R_other, *_ = cv2.stereoRectify(
        reference.camera.K,
        np.zeros(5),
        other.camera.K,
        np.zeros(5),
        size,
        T_other_reference[:3, :3],
        T_other_reference[:3, 3:],
    )
    side = R_reference @ place
    quarters = int(np.rint(np.arctan2(side[1], side[0]) / (np.pi / 2))) % 4
    turn = np.linalg.matrix_power(QUARTER_TURN, quarters)
    turned = [np.asarray(turn @ R, np.float64) for R in (R_reference, R_other)]
    return Rectification(reference, other, turned[0], turned[1], baseline_m)

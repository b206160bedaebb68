"""Where a pair is matched: the common planes cut out round some pixels of the reference."""

from dataclasses import dataclass
from math import ceil, floor

import cv2
import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bytes, Floats, Scalar, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.frame import View
from rotrecon.stereo.rectification import Rectification

DISPARITY_STEP = 16
"""The matcher looks for a multiple of so many disparities."""
UNSEEN_PX = 1e-6
"""Interpolation over less changes no grey value."""
BORDER_OPENING = np.ones((5, 5), dtype=np.uint8)
"""Black pixels in no such square are of a dark scene, and not beyond a border."""

Box = tuple[int, int, int, int]
"""Left, top, right, bottom of some pixels, the last two not included."""


@dataclass(frozen=True, eq=False)
class Canvas:
    """The part of the common planes that shows some pixels of the reference, and the disparities looked for there."""

    pair: Rectification
    focal_px: float
    principal_px: Floats
    """(2,) of the reference's plane, on the canvas."""
    size_px: tuple[int, int]
    """Width and height; the first `disparities` columns are only there for the matcher, which cannot use them."""
    first_disparity: int
    """Whole pixels by which the other picture is shifted beforehand, so that disparities begin at 0 on the canvas."""
    disparities: int

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def disparity_of_inverse_depth(self) -> float:
        """f b, px m: disparity over inverse depth in the common planes."""
        return self.focal_px * self.pair.baseline_m

    def reference_picture(self) -> Bytes:
        """(height, width) grey picture of the reference in the common plane; black beyond what was recorded."""
        return self._picture(self.pair.reference, self.pair.R_reference, 0)

    def other_picture(self) -> Bytes:
        """(height, width) grey picture of the other view, shifted by `first_disparity`."""
        return self._picture(self.pair.other, self.pair.R_other, self.first_disparity)

    def homography(self) -> Floats:
        """(3, 3) from pixels (u, v, 1) of the reference to the canvas; the third row gives depth over depth there."""
        K = self._K(0)
        return K @ self.pair.R_reference @ np.linalg.inv(self.pair.reference.camera.K)

    def _picture(self, view: View, R: Floats, shift_px: int) -> Bytes:
        grey = cv2.cvtColor(view.image, cv2.COLOR_RGB2GRAY)
        to_view = view.camera.K @ R.T @ np.linalg.inv(self._K(shift_px))
        if (corner := shift_of(to_view)) is not None:
            return cut(np.asarray(grey, dtype=np.uint8), corner, self.size_px, np.uint8(0))
        how = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
        picture = cv2.warpPerspective(grey, to_view, self.size_px, flags=how, borderMode=cv2.BORDER_CONSTANT)
        return np.asarray(picture, dtype=np.uint8)

    def _K(self, shift_px: int) -> Floats:
        u, v = self.principal_px
        return np.array([[self.focal_px, 0.0, u + shift_px], [0.0, self.focal_px, v], [0.0, 0.0, 1.0]])


def shift_of(H: Floats) -> tuple[int, int] | None:
    """The whole pixels by which a homography (3, 3) does nothing but shift; None for any other."""
    shift = H / H[2, 2]
    corner = np.rint(shift[:2, 2])
    only = np.eye(3)
    only[:2, 2] = corner
    return (int(corner[0]), int(corner[1])) if np.abs(shift - only).max() < UNSEEN_PX else None


def cut(
    picture: NDArray[Scalar], corner: tuple[int, int], size_px: tuple[int, int], missing: Scalar
) -> NDArray[Scalar]:
    """A part (height, width) of a picture from a corner on, `missing` beyond the picture."""
    (left, top), (width, height) = corner, size_px
    part = np.full((height, width), missing, dtype=picture.dtype)
    low_v, high_v = max(top, 0), min(top + height, picture.shape[0])
    low_u, high_u = max(left, 0), min(left + width, picture.shape[1])
    if low_v < high_v and low_u < high_u:
        part[low_v - top : high_v - top, low_u - left : high_u - left] = picture[low_v:high_v, low_u:high_u]
    return part


def beyond(picture: Bytes) -> Bytes:
    """(h, w) above 0 where nothing was recorded: rectified and undistorted pictures are black beyond their borders."""
    black = cv2.inRange(picture, np.zeros(1), np.zeros(1))
    return np.asarray(cv2.morphologyEx(black, cv2.MORPH_OPEN, BORDER_OPENING), dtype=np.uint8)


def canvas_over(pair: Rectification, box: Box, scale: float, inverse_depths: tuple[float, float]) -> Canvas:
    """The canvas on which the reference's pixels in a box are matched.

    `scale` shrinks the picture, 1 keeps the reference's focal length; `inverse_depths` (1/m, along the reference's z)
    are the smallest and the largest looked for. A pixel in the middle of the box falls on a pixel, so that a pair that
    is rectified already is not interpolated.
    """
    focal_px = scale * pair.reference.camera.focal_px
    K = np.diag([focal_px, focal_px, 1.0])
    H = K @ pair.R_reference @ np.linalg.inv(pair.reference.camera.K)
    border = through(H, corners(box))
    anchor = through(H, np.array([[(box[0] + box[2]) // 2, (box[1] + box[3]) // 2]], dtype=np.float64))[0]
    ratios = pair.depth_ratios(corners(box))
    low = focal_px * pair.baseline_m * inverse_depths[0] / float(ratios.max())
    high = focal_px * pair.baseline_m * inverse_depths[1] / float(ratios.min())
    first = floor(low)
    disparities = DISPARITY_STEP * max(ceil((ceil(high) + 1 - first) / DISPARITY_STEP), 1)
    seen = through(K @ pair.R_other @ np.linalg.inv(pair.other.camera.K), corners(whole(pair.other.camera)))
    # beyond these nothing of the reference can be in the other picture, at any of the disparities
    first_px = np.maximum(border.min(axis=0), seen.min(axis=0) + np.array([low, 0.0]))
    last_px = np.maximum(np.minimum(border.max(axis=0), seen.max(axis=0) + np.array([high, 0.0])), first_px)
    corner = np.floor(first_px - anchor) - 2
    corner[0] -= disparities
    extent = np.ceil(last_px - anchor) + 3 - corner
    return Canvas(pair, focal_px, -anchor - corner, (int(extent[0]), int(extent[1])), first, disparities)


def whole(camera: PinholeCamera) -> Box:
    """Every pixel of a camera."""
    return (0, 0, camera.width, camera.height)


def corners(box: Box) -> Floats:
    """The four corner pixels (4, 2) of a box: under a homography its extremes are there."""
    left, top, right, bottom = box
    return np.array([[left, top], [right - 1, top], [right - 1, bottom - 1], [left, bottom - 1]], dtype=np.float64)


def through(H: Floats, pixels: Floats) -> Floats:
    """Pixels (n, 2) through a homography (3, 3)."""
    seen = np.concatenate([pixels, np.ones((len(pixels), 1))], axis=1) @ H.T
    return seen[:, :2] / seen[:, 2:]

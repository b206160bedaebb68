"""The matcher: OpenCV's semi-global block matching, and nothing of it rewritten."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Cloud, freeze
from rotrecon.stereo.canvas import Canvas
from rotrecon.stereo.disparity_noise import check_against_pictures

SUBPIXEL_STEPS = 16
"""OpenCV's disparities are whole numbers of sixteenths."""
SMALL_STEP = 2
"""P1 over the block's pixels, the cost of a disparity that changes by one: with OpenCV's 8 slanted limbs are flattened,
and balls, legs and wires come out too thick."""
LARGE_STEP = 16
"""P2 over the block's pixels, the cost of a jump."""
LEFT_RIGHT_PX = 1
"""How far disparities found from either picture may differ."""
UNIQUE_PERCENT = 10
"""By how much the best match must be better than any other."""
GRADIENT_CAP = 31
"""Of the filtered pictures: larger edges say nothing more."""
SPECKLE_PX, SPECKLE_STEP = 100, 2
"""Pixels of the smallest patch that is kept, and disparities between neighbours of one patch."""


def matcher_of(canvas: Canvas, window_px: int, speckle_px: int = SPECKLE_PX) -> cv2.StereoSGBM:
    """The matcher for a canvas (Hirschmueller 2008), five directions in one pass.

    `window_px` is the side of the blocks whose pictures are compared; patches of fewer than `speckle_px` are dropped.
    """
    pixels = window_px**2
    return cv2.StereoSGBM.create(
        minDisparity=0,
        numDisparities=canvas.disparities,
        blockSize=window_px,
        P1=SMALL_STEP * pixels,
        P2=LARGE_STEP * pixels,
        disp12MaxDiff=LEFT_RIGHT_PX,
        preFilterCap=GRADIENT_CAP,
        uniquenessRatio=UNIQUE_PERCENT,
        speckleWindowSize=speckle_px,
        speckleRange=SPECKLE_STEP,
        mode=cv2.StereoSGBM_MODE_SGBM,
    )


@dataclass(frozen=True, eq=False)
class Matched:
    """What the matcher found on a canvas."""

    disparity_px: Cloud
    """(height, width) of the canvas; negative where there is none."""
    sigma_px: float | None
    """Standard deviation of these; None for too few."""

    def __post_init__(self) -> None:
        freeze(self)


def match(canvas: Canvas, window_px: int, speckle_px: int = SPECKLE_PX) -> Matched:
    """Match a canvas's two pictures; see `matcher_of`."""
    reference, other = canvas.reference_picture(), canvas.other_picture()
    disparity = matcher_of(canvas, window_px, speckle_px).compute(reference, other).astype(np.float32)
    disparity /= np.float32(SUBPIXEL_STEPS)
    return Matched(disparity, check_against_pictures(reference, other, disparity))

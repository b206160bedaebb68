"""The matcher: OpenCV's semi-global block matching, and nothing of it rewritten."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Cloud, freeze
from rotrecon.stereo.canvas import Canvas
from rotrecon.stereo.disparity_noise import check_against_pictures

SUBPIXEL_STEPS = 16
"""OpenCV's disparities are whole numbers of sixteenths."""


@dataclass(frozen=True)
class MatcherSettings:
    """Parameters of `cv2.StereoSGBM` (Hirschmueller 2008), those of its documentation where nothing else is said."""

    window_px: int = 5
    """Side of the block whose pictures are compared."""
    small_step: int = 2
    """P1 over the block's pixels, the cost of a disparity that changes by one: with OpenCV's 8 slanted limbs are
    flattened, and balls, legs and wires come out too thick."""
    large_step: int = 16
    """P2 over the block's pixels, the cost of a jump."""
    left_right_px: int = 1
    """How far disparities found from either picture may differ."""
    unique_percent: int = 10
    """By how much the best match must be better than any other."""
    gradient_cap: int = 31
    """Of the filtered pictures: larger edges say nothing more."""
    speckle_px: int = 100
    """Pixels of the smallest patch that is kept."""
    speckle_step: int = 2
    """Disparities between neighbours of one patch."""
    mode: int = cv2.StereoSGBM_MODE_SGBM
    """Five directions in one pass."""


def matcher_of(canvas: Canvas, settings: MatcherSettings) -> cv2.StereoSGBM:
    """The matcher for a canvas."""
    pixels = settings.window_px**2
    return cv2.StereoSGBM.create(
        minDisparity=0,
        numDisparities=canvas.disparities,
        blockSize=settings.window_px,
        P1=settings.small_step * pixels,
        P2=settings.large_step * pixels,
        disp12MaxDiff=settings.left_right_px,
        preFilterCap=settings.gradient_cap,
        uniquenessRatio=settings.unique_percent,
        speckleWindowSize=settings.speckle_px,
        speckleRange=settings.speckle_step,
        mode=settings.mode,
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


def match(canvas: Canvas, settings: MatcherSettings) -> Matched:
    """Match a canvas's two pictures."""
    reference, other = canvas.reference_picture(), canvas.other_picture()
    disparity = matcher_of(canvas, settings).compute(reference, other).astype(np.float32)
    disparity /= np.float32(SUBPIXEL_STEPS)
    return Matched(disparity, check_against_pictures(reference, other, disparity))

"""Depth, segmentation and the re-projected solid, drawn on the camera frame (paper figures 1, 3 and 4)."""

from typing import Literal, cast

import cv2
import numpy as np

from rotrecon.arrays import Bools, Bytes, Cloud, Floats
from rotrecon.curves import Outline, curves_of
from rotrecon.outcome import Fit
from rotrecon.reconstruction import Reconstruction
from rotrecon.segmentation import PixelHistory, Segmentation

Stage = Literal["close", "accepted", "object"]
"""Figure 3 a: distant and close pixels; b: what passed the three-sigma tests; c: the object."""

NAVY, LIGHT_BLUE, YELLOW, RED = (16, 28, 110), (120, 196, 240), (250, 214, 40), (220, 40, 40)
LATER_RUN = (96, 84, 168)
"""Of pixels that the second or a later run called distant."""
OUTLINE_COLOR = (255, 60, 200)
DASH_PX, GAP_PX = 7.0, 5.0


def depth_range_m(depth_m: Cloud) -> tuple[float, float]:
    """Nearest and farthest depth worth a colour: the 2nd and 98th percentile of a depth map (H, W)."""
    sample = depth_m[::2, ::2]
    sample = sample[np.isfinite(sample)]
    if len(sample) == 0:
        return (0.0, 1.0)
    low, high = cast(list[float], np.percentile(sample, [2, 98]).tolist())
    return (low, max(high, low + 1e-3))


def depth_colors(depth_m: Cloud, range_m: tuple[float, float]) -> Bytes:
    """Colours (H, W, 3) RGB of a depth map (H, W), near is bright; black where there is no depth."""
    low, high = range_m
    share = np.nan_to_num((high - depth_m) / (high - low), nan=0.0)
    level = (np.clip(share, 0, 1) * 255).astype(np.uint8)
    colors = cast(Bytes, cv2.applyColorMap(level, cv2.COLORMAP_VIRIDIS))[..., ::-1].copy()
    colors[~np.isfinite(depth_m)] = 0
    return colors


def blend(image: Bytes, layer: Bytes, mask: Bools, opacity: float) -> Bytes:
    """A layer (H, W, 3) over an image (H, W, 3) where the mask (H, W) says so; opacity 0 to 1."""
    mixed = cast(Bytes, cv2.addWeighted(image, 1 - opacity, layer, opacity, 0))
    cv2.copyTo(image, (~mask).view(np.uint8), mixed)
    return mixed


def with_segmentation(image: Bytes, result: Reconstruction, stage: Stage = "object", opacity: float = 0.6) -> Bytes:
    """The image (H, W, 3) with one stage of the segmentation in the colours of figure 3."""
    segments = result.segments
    palette = np.array([(0, 0, 0), NAVY, LIGHT_BLUE, YELLOW, RED, LATER_RUN], dtype=np.uint8)
    to_grid = np.stack([segments.across, segments.along])
    shift = -to_grid @ segments.origin_px - [segments.first_offset_px, 0]
    height, width = image.shape[:2]
    category = cast(
        Bytes,
        cv2.warpAffine(
            _categories(result.segmentation, stage),
            np.column_stack([to_grid, shift]),
            (width, height),
            flags=cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP,
        ),
    )
    left, top, width, height = cv2.boundingRect(category)  # most of the frame stays as it is
    cut, colored = np.s_[top : top + height, left : left + width], image.copy()
    if width and height:
        colored[cut] = blend(image[cut], palette[category[cut]], category[cut] > 0, opacity)
    return colored


def _categories(segmentation: Segmentation, stage: Stage) -> Bytes:
    """Colour number (S, W) of each cell: 0 none, 1 distant, 2 close, 3 accepted, 4 object, 5 distant in a later run."""
    history = segmentation.history
    category = (history & PixelHistory.DEPTH > 0).astype(np.uint8)
    category[(category > 0) & (segmentation.removed_in_run == 0)] = 2
    category[segmentation.removed_in_run > 1] = 5
    if stage == "close":
        return category
    grown = history & (PixelHistory.GROWN_FORWARD | PixelHistory.GROWN_BACKWARD) > 0
    category[((category == 2) & (history & PixelHistory.OUTLIER == 0)) | grown] = 3
    if stage == "object":
        category[segmentation.kept] = 4
    return category


def outlines(result: Reconstruction) -> tuple[Outline, ...]:
    """The solid's curves on the frame, all of them in sight where it is seen from inside."""
    if not isinstance(result.fit, Fit):
        return ()
    curves = curves_of(result.fit.solid, result.frame.camera)
    if result.fit.concave:
        return tuple(Outline(curve.points_px, np.ones(len(curve.visible), dtype=np.bool_)) for curve in curves)
    return curves


def with_outlines(image: Bytes, curves: tuple[Outline, ...]) -> Bytes:
    """The image (H, W, 3) with curves drawn on it, hidden parts dashed."""
    drawn = image.copy()
    thickness = max(1, round(image.shape[1] / 500))
    for curve in curves:
        for start, end, visible in _pieces(curve):
            if visible:
                cv2.line(drawn, start, end, OUTLINE_COLOR, thickness, cv2.LINE_AA, shift=4)
    return drawn


def section_pixels(result: Reconstruction, section: int) -> Floats:
    """Pixels (n, 2) of one section of the second cut."""
    if result.sections is None:
        return np.zeros((0, 2))
    v, u = np.divmod(result.sections.pixels_in(section), result.frame.camera.width)
    return np.stack([u, v], axis=1).astype(np.float64)


def first_cut_line(result: Reconstruction, section: int) -> int | None:
    """The line of pixels of the first cut that holds most of one section of the second cut; None for no pixels."""
    if result.sections is None:
        return None
    in_section = np.isin(result.segments.pixel, result.sections.pixels_in(section))
    rows, _ = np.nonzero(in_section & result.segmentation.kept)
    return int(np.bincount(rows).argmax()) if len(rows) else None


def _pieces(curve: Outline) -> list[tuple[tuple[int, int], tuple[int, int], bool]]:
    """Straight pieces of a curve in sixteenths of a pixel, and whether each is inked: hidden ones only in dashes."""
    start, end = curve.points_px[:-1], curve.points_px[1:]
    travelled = np.concatenate([[0.0], np.nancumsum(np.linalg.norm(end - start, axis=1))])
    inked = (curve.visible[:-1] & curve.visible[1:]) | (travelled[:-1] % (DASH_PX + GAP_PX) < DASH_PX)
    ends = np.concatenate([start, end], axis=1) * 16
    drawable = np.isfinite(ends).all(axis=1) & (np.abs(ends) < 1e6).all(axis=1)
    whole = np.rint(ends[drawable]).astype(np.int32).tolist()
    return [((a, b), (c, d), bool(ink)) for (a, b, c, d), ink in zip(whole, inked[drawable], strict=True)]

"""Depth, segmentation and the re-projected solid, drawn on the camera frame (paper figures 1, 3 and 4)."""

from dataclasses import dataclass
from typing import Literal, cast

import cv2
import numpy as np

from rotrecon.arrays import Bools, Bytes, Cloud, Floats, freeze
from rotrecon.camera import PinholeCamera
from rotrecon.outcome import Fit
from rotrecon.primitives import Frustum, Sphere, basis_across
from rotrecon.reconstruction import Reconstruction
from rotrecon.segmentation import PixelHistory, Segmentation

Stage = Literal["close", "accepted", "object"]
"""Figure 3 a: distant and close pixels; b: what passed the three-sigma tests; c: the object."""

NAVY, LIGHT_BLUE, YELLOW, RED = (16, 28, 110), (120, 196, 240), (250, 214, 40), (220, 40, 40)
LATER_RUN = (96, 84, 168)
"""Of pixels that the second or a later run called distant."""
OUTLINE_COLOR = (255, 60, 200)
CURVE_POINTS = 97
"""Enough for a polygon to pass for a circle at any size a frame can show."""
DASH_PX, GAP_PX = 7.0, 5.0


@dataclass(frozen=True, eq=False)
class Outline:
    """A curve on the solid, re-projected on the frame."""

    points_px: Floats
    """(n, 2); NaN behind the camera."""
    visible: Bools
    """(n,) False where the solid itself hides the curve."""

    def __post_init__(self) -> None:
        freeze(self)


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
    return blend(image, palette[category], category > 0, opacity)


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
    """The solid's curves on the frame: bases and limbs of a cylinder or cone, diametric section and limb of a ball."""
    if not isinstance(result.fit, Fit):
        return ()
    solid, camera = result.fit.solid, result.frame.camera
    curves = _sphere_curves(solid, camera) if isinstance(solid, Sphere) else _frustum_curves(solid, camera)
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


def _ring(center_m: Floats, normal: Floats, radius_m: float) -> Floats:
    """Points (n, 3) of a circle round a normal."""
    x, y = basis_across(normal, -center_m)
    angle = np.linspace(0, 2 * np.pi, CURVE_POINTS)[:, None]
    return center_m + radius_m * (np.cos(angle) * x + np.sin(angle) * y)


def _sphere_curves(ball: Sphere, camera: PinholeCamera) -> tuple[Outline, ...]:
    """The diametric section across the drawn axis, and the limb where sight lines touch the ball."""
    section = _ring(ball.center_m, ball.direction, ball.radius_m)
    hidden = ((section - ball.center_m) * section).sum(axis=1) > 0
    curves = [Outline(camera.project(section), ~hidden)]
    away_m = float(np.linalg.norm(ball.center_m))
    shrink = 1 - (ball.radius_m / away_m) ** 2
    if shrink > 0:
        limb = _ring(ball.center_m * shrink, ball.center_m / away_m, ball.radius_m * np.sqrt(shrink))
        curves.append(Outline(camera.project(limb), np.ones(len(limb), dtype=np.bool_)))
    return tuple(curves)


def _frustum_curves(solid: Frustum, camera: PinholeCamera) -> tuple[Outline, ...]:
    """The two bases, and the two lines where sight lines touch the side.

    The tangent plane is the same along a whole generator, so a point of the rim is seen when the side there or the
    base itself faces the camera, which is the origin.
    """
    slope = float(np.tan(solid.half_angle_rad))
    curves: list[Outline] = []
    for end, outward in zip(solid.ends, (-solid.direction, solid.direction), strict=True):
        center = solid.center_m + end * solid.direction
        rim = _ring(center, solid.direction, float(solid.radius_at(end)))
        radial = (rim - center) / max(float(solid.radius_at(end)), 1e-12)
        side_faces = ((radial - slope * solid.direction) * rim).sum(axis=1) < 0
        curves.append(Outline(camera.project(rim), side_faces | bool(center @ outward < 0)))
    for radial in _limb_directions(solid, slope):
        line = [solid.center_m + end * solid.direction + solid.radius_at(end) * radial for end in solid.ends]
        curves.append(Outline(camera.project(np.array(line)), np.ones(2, dtype=np.bool_)))
    return tuple(curves)


def _limb_directions(solid: Frustum, slope: float) -> list[Floats]:
    """Unit vectors (3,) across the axis to the two generators that sight lines touch; none from inside the cone."""
    x, y = basis_across(solid.direction, -solid.center_m)
    toward = np.array([solid.center_m @ x, solid.center_m @ y])
    offset = solid.radius_m - slope * float(solid.center_m @ solid.direction)
    ratio = -offset / max(float(np.linalg.norm(toward)), 1e-12)
    if abs(ratio) >= 1:
        return []
    middle, half = np.arctan2(toward[1], toward[0]), np.arccos(ratio)
    return [np.cos(angle) * x + np.sin(angle) * y for angle in (middle - half, middle + half)]


def _pieces(curve: Outline) -> list[tuple[tuple[int, int], tuple[int, int], bool]]:
    """Straight pieces of a curve in sixteenths of a pixel, and whether each is inked: hidden ones only in dashes."""
    start, end = curve.points_px[:-1], curve.points_px[1:]
    travelled = np.concatenate([[0.0], np.nancumsum(np.linalg.norm(end - start, axis=1))])
    inked = (curve.visible[:-1] & curve.visible[1:]) | (travelled[:-1] % (DASH_PX + GAP_PX) < DASH_PX)
    ends = np.concatenate([start, end], axis=1) * 16
    drawable = np.isfinite(ends).all(axis=1) & (np.abs(ends) < 1e6).all(axis=1)
    whole = np.rint(ends[drawable]).astype(np.int32).tolist()
    return [((a, b), (c, d), bool(ink)) for (a, b, c, d), ink in zip(whole, inked[drawable], strict=True)]

"""The nearest thing that stands out in an area, told from the planes round it by depth alone."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Bools, Cloud, Floats, freeze
from rotrecon.drawing import AreaOfInterest, DrawingError, area_mask, check_area
from rotrecon.frame import Frame
from rotrecon.noise import noise_of
from rotrecon.outcome import FailureReason, FitFailure
from rotrecon.stroke.planes import off_plane, planes_through
from rotrecon.workspace import available

MARGIN = 0.25
"""How far the surroundings of an area reach, in sides of a square of its size: enough to see what it stands on."""
MOST_PIXELS = 60_000
"""Of a patch; of larger ones every n-th row and column is taken, so that the time stays that of a medium one."""
MEDIAN_PX = 5
"""Side of the median that takes noise and specks away, and leaves edges where they are."""
ON_PLANE_SIGMA = 4.0
"""Standard deviations within which a pixel lies on a plane: one in 16,000 of a table's does not."""
ON_PLANE_SHARE = 0.004
"""Share of the depth within which a pixel lies on a plane, though noise be less: depth cameras bend a table by that."""
PLANE_SHARE, PLANE_COVER = 0.25, 0.1
"""Share of what is known round the area, and of all that is round it, that lies on a plane that is one: the side of an
object that reaches out of the area has less."""
MOST_PLANES = 3
"""A table, a wall and another wall."""
OFF_PLANE = 2.0
"""Times the tolerance a pixel is off a plane to be of an object: between them, ripples of the plane."""
STEEPEST = 8.0
"""Tangent of the incidence (83 degrees) above which two neighbours are not of one surface."""
BRIDGED_PX, BRIDGED_SHARE = 11, 0.2
"""Side of the window whose pixels bridge a hole in depth, and the share of it that they must fill: blobs where nothing
was matched are as large, and must not cut a thin thing in two."""
FEWEST_PIXELS = 30
"""Fewer are specks, and do not show which way an object lies."""
CORE_SHARE = 0.3
"""Share of the largest distance from the outline; what hangs on by a narrower neck, as a handle, is another thing."""
THING_SHARE = 0.3
"""Share of the largest thing's weight, pixels counting by their distance from the area's border, of one to choose."""


OUT_OF_REACH = "everything in the area is outside the arm's limits; move the arm or the limits"


@dataclass(frozen=True, eq=False)
class Patch:
    """The frame round an area, (h, w): every `step_px`-th pixel of it."""

    corner_px: Floats
    """(2,) u, v of the first pixel."""
    step_px: int
    inverse_depth: Floats
    """(h, w) median, 1/m; 0 where it is not known."""
    tolerance: Floats
    """(h, w) of inverse depth, within which a pixel lies on a plane, 1/m."""
    known: Bools
    """(h, w) where depth is known and the arm can use it."""
    inside: Bools
    """(h, w) the area."""

    def __post_init__(self) -> None:
        freeze(self)

    def frame_px(self, places: Floats) -> Floats:
        """Places (..., 2) u, v in the patch as places in the frame."""
        return self.corner_px + self.step_px * places

    def patch_px(self, pixels: Floats) -> Floats:
        """The other way round."""
        return (pixels - self.corner_px) / self.step_px


@dataclass(frozen=True, eq=False)
class Foreground:
    """The object in a patch, and the planes it stands before."""

    patch: Patch
    mask: Bools
    """(h, w) the nearest thing in the area; empty where nothing stands out."""
    planes: tuple[Floats, ...]
    """(3,) each, of pixels of the frame (see `planes_through`); the one that most of the surroundings lies on first."""

    def __post_init__(self) -> None:
        freeze(self)


def find_foreground(frame: Frame, area: AreaOfInterest) -> Foreground | FitFailure:
    """The nearest thing in an area of a frame, and the planes it stands before.

    Raises DrawingError for an area that cannot be used on this frame or holds no depth; refused when all of it is out
    of the arm's reach.
    """
    patch = _patch(frame, area)
    if not (patch.known & patch.inside).any():
        return FitFailure(FailureReason.OUT_OF_REACH, OUT_OF_REACH)
    pixels = patch.frame_px(places_of(patch.known))
    inverse_depth, tolerance = patch.inverse_depth[patch.known], patch.tolerance[patch.known]
    outside = ~patch.inside[patch.known]
    least = int(max(PLANE_SHARE * outside.sum(), PLANE_COVER * (~patch.inside).sum()))
    planes = planes_through(pixels[outside], inverse_depth[outside], tolerance[outside], least, MOST_PLANES)
    mask, steepest = patch.known & patch.inside, STEEPEST * patch.step_px / frame.camera.focal_px
    stands_out = mask.copy()
    for number, plane in enumerate(planes):
        stands_out[patch.known] &= np.abs(off_plane(plane, pixels, inverse_depth)) > OFF_PLANE * tolerance
        if number > 0 and stands_out.sum() < FEWEST_PIXELS:
            planes = planes[:number]  # it was the object's own side, seen round a narrow area
            break
        mask = stands_out.copy()
    return Foreground(patch, _nearest_thing(mask, patch, steepest), tuple(planes))


def places_of(mask: Bools) -> Floats:
    """Places (n, 2) u, v of the pixels of a mask (h, w), in the order in which it selects them."""
    v, u = np.nonzero(mask)
    return np.column_stack([u, v]).astype(np.float64)


def _patch(frame: Frame, area: AreaOfInterest) -> Patch:
    """What is needed of the frame round an area."""
    size_px = (frame.camera.width, frame.camera.height)
    check_area(area, size_px)
    vertices = np.array(area.vertices_px)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    margin = MARGIN * float(np.sqrt((high - low).prod()))
    first = np.maximum(np.floor(low - margin), 0).astype(int)
    last = np.minimum(np.ceil(high + margin) + 1, size_px).astype(int)
    step = max(1, int(np.ceil(np.sqrt((last - first).prod() / MOST_PIXELS))))
    cut = (slice(first[1], last[1], step), slice(first[0], last[0], step))
    inside, points_m = area_mask(area, size_px)[cut] > 0, frame.points_m[cut]
    if not np.isfinite(points_m[inside, 2]).any():
        raise DrawingError("the area holds no depth; draw it where the depth map has values")
    usable = available(points_m, frame.T_base_camera, frame.workspace)
    depth_m = np.where(usable, points_m[..., 2], np.float32(np.nan))
    smooth = np.asarray(cv2.medianBlur(np.where(usable, 1 / depth_m, np.float32(0)), MEDIAN_PX), dtype=np.float64)
    known = usable & (smooth > 0)
    smooth[~known] = 0.0
    return Patch(first.astype(np.float64), step, smooth, _tolerance(frame, depth_m, smooth, known), known, inside)


def _tolerance(frame: Frame, depth_m: Cloud, inverse_depth: Floats, known: Bools) -> Floats:
    """How far (h, w) a pixel may be off a plane, 1/m: by noise or by the bend of a depth camera's planes."""
    noise = noise_of(frame.noise, depth_m, frame.camera.focal_px)
    depth = np.divide(1.0, inverse_depth, out=np.ones_like(inverse_depth), where=known)
    return np.maximum(ON_PLANE_SIGMA * noise.sigma_m(depth) * inverse_depth**2, ON_PLANE_SHARE * inverse_depth)


def _nearest_thing(stands_out: Bools, patch: Patch, steepest: float) -> Bools:
    """The thing (h, w) among the pixels that stand out: of one surface, and of one piece without narrow necks."""
    bridged, inverse_depth = _bridged(stands_out, patch)
    whole = _chosen(bridged & ~_behind_a_jump(bridged, inverse_depth, steepest), patch)
    if not whole.any():
        return whole
    reach = cv2.distanceTransform(np.pad(whole, 1).astype(np.uint8), cv2.DIST_L2, 3)[1:-1, 1:-1]
    neck = CORE_SHARE * float(reach.max())
    core = _chosen(reach > neck, patch)
    from_core = cv2.distanceTransform((~core).astype(np.uint8), cv2.DIST_L2, 3)
    return whole & stands_out & (from_core <= neck)


def _bridged(pixels: Bools, patch: Patch) -> tuple[Bools, Floats]:
    """Pixels (h, w) with the holes in depth that they surround, and inverse depth with their mean in these."""
    window = (BRIDGED_PX, BRIDGED_PX)
    around = cv2.blur(pixels.astype(np.float64), window)
    mean = cv2.blur(np.where(pixels, patch.inverse_depth, 0.0), window) / np.maximum(around, np.finfo(float).tiny)
    bridge = ~patch.known & patch.inside & (around > BRIDGED_SHARE)
    return pixels | bridge, np.where(bridge, mean, patch.inverse_depth)


def _behind_a_jump(pixels: Bools, inverse_depth: Floats, steepest: float) -> Bools:
    """Which pixels (h, w) have a neighbour among them that is nearer by more than a share `steepest` of the depth."""
    behind = np.zeros_like(pixels)
    for one, other in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
        both = pixels[one] & pixels[other]
        nearer = inverse_depth[other] - inverse_depth[one]
        limit = steepest * np.maximum(inverse_depth[one], inverse_depth[other])
        behind[one] |= both & (nearer > limit)
        behind[other] |= both & (-nearer > limit)
    return behind


def _chosen(pixels: Bools, patch: Patch) -> Bools:
    """The nearest of the large connected things among pixels (h, w); empty when there is none."""
    count, label = cv2.connectedComponents(pixels.astype(np.uint8), connectivity=4)
    from_border = cv2.distanceTransform(np.pad(patch.inside, 1).astype(np.uint8), cv2.DIST_L2, 3)[1:-1, 1:-1]
    weight = np.bincount(label.ravel(), from_border.ravel(), count)
    weight[0] = 0.0
    large = np.flatnonzero((weight > 0) & (weight >= THING_SHARE * weight.max()))
    nearness = [float(np.median(patch.inverse_depth[label == thing])) for thing in large]
    return label == (large[int(np.argmax(nearness))] if nearness else -1)

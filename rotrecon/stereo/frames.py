"""Views matched into a frame: the whole of it coarsely, or one area of it finely."""

import cv2
import numpy as np

from rotrecon.arrays import Bools, Cloud
from rotrecon.camera import PinholeCamera, depth_before
from rotrecon.drawing import AreaOfInterest, area_mask, check_area
from rotrecon.frame import Frame, FrameUnavailable, StereoEvidence, StereoNoise
from rotrecon.stereo.canvas import Box, Canvas, canvas_over, whole
from rotrecon.stereo.carrying import inverse_depths
from rotrecon.stereo.exposure import ENOUGH, exposure_problem
from rotrecon.stereo.fusion import fuse, fused_sigma
from rotrecon.stereo.matching import match
from rotrecon.stereo.preparing import Pair, Prepared
from rotrecon.stereo.scouting import STEP_PX, span

COARSE = 0.5
"""Scale of the pictures when the whole of them is matched, for display: it takes an eighth of the time."""
MARGIN_PX = 24
"""Pixels about an area that are matched too: paths of the matcher come in from there."""
SMALL_WINDOW_PX, LARGE_WINDOW_PX = 3, 5
"""Sides of the blocks: small ones keep the limbs of thin objects, large ones err less where there is room."""
THIN_PX = 60.0
"""Width of an area round objects that are too thin for large blocks."""
SCOUTED_TAIL = 0.005
"""Share of an area's scouted pixels at either end that may be wrong."""
FEWEST_SCOUTED = 20
"""Scouted pixels in an area: fewer say nothing of it."""
SCOUTED_MARGIN_PX = 8.0
"""Disparities of the full picture beyond those scouted: two of the pixels in which that is done."""
USUAL_SIGMA_PX = 0.15
"""Of disparity, measured on rendered pairs with fine texture."""
LEAST_VALID = 0.15
"""Share of an area or a frame with depth, below which nothing in it is measured: a twelfth of mere noise has depth."""
MOVED = 5
"""Features in an area that have left their rows together: fewer may be chance."""
MOST_MOVED = 0.3
"""Share of an area's features that may have: more, and it is the object that moved."""


def whole_frame(prepared: Prepared) -> Frame | FrameUnavailable:
    """The whole frame matched at half resolution, for display."""
    frame = _frame(prepared, whole(prepared.views[0].camera), None, COARSE, LARGE_WINDOW_PX)
    return _too_empty(frame, "picture") or frame


def area_frame(prepared: Prepared, area: AreaOfInterest) -> Frame | FrameUnavailable:
    """The pixels of an area and a margin, matched at full resolution; the rest of the frame has no depth.

    Raises DrawingError for an area that cannot be used on the first view.
    """
    camera = prepared.views[0].camera
    check_area(area, (camera.width, camera.height))
    inside = area_mask(area, (camera.width, camera.height)) > 0
    if (problem := exposure_problem(prepared.views[0].image[sparse(inside)])) is not None:
        return FrameUnavailable(f"the area {problem}")
    if (problem := _moved(prepared.pairs[0], inside)) is not None:
        return FrameUnavailable(problem)
    box = _box_about(inside)
    del inside
    frame = _frame(prepared, box, area, 1.0, window_for(area))
    return _too_empty(frame, "area") or frame


def _box_about(inside: Bools) -> Box:
    """What is matched for the pixels of a mask (height, width)."""
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    height, width = inside.shape
    return (
        max(int(columns[0]) - MARGIN_PX, 0),
        max(int(rows[0]) - MARGIN_PX, 0),
        min(int(columns[-1]) + 1 + MARGIN_PX, width),
        min(int(rows[-1]) + 1 + MARGIN_PX, height),
    )


def _too_empty(frame: Frame, what: str) -> FrameUnavailable | None:
    assert frame.stereo is not None
    if frame.stereo.valid_share >= LEAST_VALID:
        return None
    return FrameUnavailable(
        f"{100 * frame.stereo.valid_share:.0f} % of the {what} have depth: there is no texture; take in more of the "
        "object's surroundings, light the object from the side, or project a pattern on it"
    )


def sparse(inside: Bools) -> Bools:
    """The same mask (height, width), thinned where it has many pixels: to look at all of them would take as long as to
    match some."""
    step = 1 + int(np.sqrt(np.count_nonzero(inside) / ENOUGH))
    thinned = np.zeros_like(inside)
    thinned[::step, ::step] = inside[::step, ::step]
    return thinned


def _moved(pair: Pair, inside: Bools) -> str | None:
    moved, still = (
        int(inside[np.rint(pixels[:, 1]).astype(int), np.rint(pixels[:, 0]).astype(int)].sum())
        for pixels in (pair.moved, pair.features)
    )
    if moved < MOVED or moved < MOST_MOVED * (moved + still):
        return None
    return (
        f"{moved} of {moved + still} features in the area lie off their rows together: what is there has moved between "
        "the exposures; take the pictures again when it is at rest"
    )


def _frame(prepared: Prepared, box: Box, area: AreaOfInterest | None, scale: float, window_px: int) -> Frame:
    """The frame with depth in a box; `area` is what its valid share is of, None for all of it.

    The cloud is by far the largest thing here: while it is made, nothing else of a picture's size is held.
    """
    reference = prepared.views[0]
    canvases = [canvas_over(pair.rectification, box, scale, range_in(pair, box)) for pair in prepared.pairs]
    found, sigmas = zip(*(_inverse_depths(canvas, box, window_px) for canvas in canvases), strict=True)
    points = _before_cloud(fuse(found, sigmas), box, reference.camera)
    del found
    valid = _share(depth_before(points), area)
    reference.camera.spread(points)
    return Frame(
        image=reference.image,
        points_m=points,
        camera=reference.camera,
        T_base_camera=reference.T_base_camera,
        noise=_noise(prepared, fused_sigma(sigmas, [pair.rectification.R_reference[0] for pair in prepared.pairs])),
        workspace=prepared.workspace,
        views=prepared.views,
        stereo=_evidence(prepared, canvases[0], window_px, scale, valid),
    )


def _inverse_depths(canvas: Canvas, box: Box, window_px: int) -> tuple[Cloud, float]:
    """Inverse depth (h, w), 1/m, in a box by one pair, and its standard deviation."""
    matched = match(canvas, window_px)
    sigma_px = USUAL_SIGMA_PX if matched.sigma_px is None else matched.sigma_px
    return inverse_depths(canvas, matched.disparity_px, box), sigma_px / canvas.disparity_of_inverse_depth


def _before_cloud(inverse: Cloud, box: Box, camera: PinholeCamera) -> Cloud:
    """Memory (height, width, 3) for a cloud, with the depth that it will be made of; NaN outside the box."""
    left, top, right, bottom = box
    points: Cloud = np.empty((camera.height, camera.width, 3), dtype=np.float32)
    depth = depth_before(points)
    depth[...] = np.nan
    np.divide(np.float32(1.0), inverse, out=depth[top:bottom, left:right])
    return points


def _noise(prepared: Prepared, sigma: float) -> StereoNoise:
    """That of inverse depth (1/m), said as disparity of the first pair."""
    baseline_m = prepared.pairs[0].rectification.baseline_m
    return StereoNoise(baseline_m, sigma * prepared.views[0].camera.focal_px * baseline_m)


def _evidence(prepared: Prepared, canvas: Canvas, window_px: int, scale: float, valid: float) -> StereoEvidence:
    errors = [pair.epipolar_error_px for pair in prepared.pairs if pair.epipolar_error_px is not None]
    return StereoEvidence(
        pairs=tuple(pair.number for pair in prepared.pairs),
        left_out=prepared.left_out,
        epipolar_error_px=max(errors, default=None),
        features=sum(len(pair.features) for pair in prepared.pairs),
        valid_share=valid,
        disparities_px=(canvas.first_disparity / scale, (canvas.first_disparity + canvas.disparities) / scale),
        window_px=window_px,
        scale=scale,
    )


def _share(depth: Cloud, area: AreaOfInterest | None) -> float:
    """Share of the pixels of an area, or of all, that a depth map (height, width) has depth for."""
    valid = np.isfinite(depth)
    if area is None:
        return float(np.count_nonzero(valid) / valid.size)
    height, width = depth.shape
    inside = area_mask(area, (width, height)) > 0
    return float(np.count_nonzero(valid & inside) / np.count_nonzero(inside))


def window_for(area: AreaOfInterest) -> int:
    """Side of the blocks for an area, by its narrower side: the object in it is no wider."""
    narrow_px = min(cv2.minAreaRect(np.array(area.vertices_px, dtype=np.float32))[1])
    return SMALL_WINDOW_PX if narrow_px < THIN_PX else LARGE_WINDOW_PX


def range_in(pair: Pair, box: Box) -> tuple[float, float]:
    """Smallest and largest inverse depth (1/m) looked for in a box: what was scouted there, or everywhere else."""
    left, top, right, bottom = (edge // STEP_PX for edge in box)
    seen = span(pair.scouted[top : bottom + 1, left : right + 1], SCOUTED_TAIL, FEWEST_SCOUTED)
    if seen is None:
        return pair.inverse_depths
    margin = SCOUTED_MARGIN_PX / (pair.rectification.reference.camera.focal_px * pair.rectification.baseline_m)
    low, high = pair.inverse_depths
    return max(seen[0] - margin, low), min(seen[1] + margin, high)

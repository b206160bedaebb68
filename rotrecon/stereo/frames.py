"""Views matched into a frame: the whole of it coarsely, or one area of it finely."""

import numpy as np

from rotrecon.arrays import Cloud
from rotrecon.drawing import AreaOfInterest, area_mask, check_area
from rotrecon.frame import Frame, FrameUnavailable, StereoEvidence, StereoNoise
from rotrecon.settings import Settings
from rotrecon.stereo.canvas import Box, canvas_over, whole
from rotrecon.stereo.carrying import inverse_depths
from rotrecon.stereo.matching import MatcherSettings, match
from rotrecon.stereo.preparing import Prepared

COARSE = 0.5
MARGIN_PX = 24


def whole_frame(prepared: Prepared) -> Frame | FrameUnavailable:
    """The whole frame matched at half resolution, for display."""
    camera = prepared.views[0].camera
    return _frame(prepared, whole(camera), None, COARSE)


def area_frame(prepared: Prepared, area: AreaOfInterest, settings: Settings) -> Frame | FrameUnavailable:
    """The pixels of an area and a margin, matched at full resolution; the rest of the frame has no depth."""
    camera = prepared.views[0].camera
    check_area(area, (camera.width, camera.height))
    inside = area_mask(area, (camera.width, camera.height))
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    box = (
        max(int(columns[0]) - MARGIN_PX, 0),
        max(int(rows[0]) - MARGIN_PX, 0),
        min(int(columns[-1]) + 1 + MARGIN_PX, camera.width),
        min(int(rows[-1]) + 1 + MARGIN_PX, camera.height),
    )
    return _frame(prepared, box, inside, 1.0)


def _frame(prepared: Prepared, box: Box, inside, scale: float) -> Frame | FrameUnavailable:
    pair = prepared.pairs[0]
    reference = prepared.views[0]
    settings = MatcherSettings()
    canvas = canvas_over(pair.rectification, box, scale, pair.inverse_depths)
    found = inverse_depths(canvas, match(canvas, settings), box)
    depth: Cloud = np.full((reference.camera.height, reference.camera.width), np.nan, dtype=np.float32)
    left, top, right, bottom = box
    depth[top:bottom, left:right] = 1 / found
    valid = np.isfinite(depth if inside is None else depth[inside > 0]).mean()
    evidence = StereoEvidence(
        pairs=(pair.number,),
        epipolar_error_px=pair.epipolar_error_px,
        features=len(pair.matches.disparity_px),
        valid_share=float(valid),
        disparities_px=(float(canvas.first_disparity), float(canvas.first_disparity + canvas.disparities)),
        window_px=settings.window_px,
        scale=scale,
    )
    return Frame(
        image=reference.image,
        points_m=reference.camera.cloud(depth),
        camera=reference.camera,
        T_base_camera=reference.T_base_camera,
        noise=StereoNoise(pair.rectification.baseline_m, 0.2),
        workspace=prepared.workspace,
        views=prepared.views,
        stereo=evidence,
    )

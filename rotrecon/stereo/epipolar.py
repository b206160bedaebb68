"""The check of poses and cameras on the pictures themselves: whether matched features lie on the rows they must."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.frame import View
from rotrecon.stereo.canvas import canvas_over, through, whole
from rotrecon.stereo.features import Features, Matches, in_common_planes, matched
from rotrecon.stereo.rectification import Rectification, rectify

WORST_PX = 1.0
"""Rows off by more are beyond what blocks of 5 px tolerate, and as much error along the rows goes unseen."""
ROW_TOLERANCE_PX = 3.0
"""Features are found to one or two pixels; what is farther off its row is matched wrongly, or has moved."""
FEWEST = 12
"""Fewer matched features say nothing."""
LEAST_AGREEING = 0.5
"""Share of the features that must agree on how far rows are off, for anything to be said."""
LEAST_STILL, ALL_AGREEING = 0.15, 0.8
"""Where so many features lie on their rows, and fewer than these agree on how far rows are off, the others have moved:
an error of pose or calibration moves all of them."""
WINDOW_PX = 15
"""Side of the window in which a feature is found again to a fraction of a pixel."""
MOST_REFINED = 400
"""Features that this is done for: the median of so many is sure to a tenth of their own error."""
SHORT_WAY_PX = 4.0
"""Farther than a window's own reach, a feature has been lost."""
NEIGHBOURS = 4
"""Features off their rows that move alike are something that moved; wrong matches do not."""
ALIKE_PX = 4.0
"""How alike their ways from picture to picture are then, a row or a column."""


@dataclass(frozen=True, eq=False)
class Checked:
    """Features of a pair, and what they say of its poses."""

    good: Matches
    """Those that lie on their rows."""
    moved: Floats
    """(M, 2) pixels of the reference where features have left their rows together."""
    error_px: float | None
    """Median distance from the row, at the reference's full resolution; None for too few features to say."""


def check_epipolar(pair: Rectification, reference: Features, other: Features) -> Checked | str:
    """What matched features say of a pair; or why it cannot be used, and what to do."""
    matches = in_common_planes(pair, *matched(reference, other))
    if len(matches.disparity_px) < FEWEST:
        return Checked(matches.chosen(on_row(matches)), np.empty((0, 2)), None)
    off_px = off_rows(matches)
    on_rows = on_row(matches)
    behind = on_rows & (matches.disparity_px < -ROW_TOLERANCE_PX)
    turned_round = behind.sum() > on_rows.sum() / 2
    good = matches.chosen(on_rows & ~behind)
    error_px = off_px if off_px > 0 or turned_round else refined_error_px(pair, good)
    if turned_round or (error_px is not None and error_px > WORST_PX):
        return _what_is_wrong(pair, reference, other, error_px)
    return Checked(good, _moved_together(matches, ~on_rows), error_px)


def on_row(matches: Matches) -> Bools:
    """(N,) which features lie on the rows that the poses put them in."""
    return np.abs(matches.row_error_px) < ROW_TOLERANCE_PX


def off_rows(matches: Matches) -> float:
    """How far rows are off, px, where most features agree on it; 0 where they do not, being matched wrongly.

    An error of pose or calibration moves rows by an amount that is linear in the picture, to first order.
    """
    terms = np.column_stack([np.ones(len(matches.row_error_px)), matches.reference_px / 1000])
    weight = np.ones(len(terms))
    solution = np.array([np.median(matches.row_error_px), 0.0, 0.0])
    for _ in range(10):
        weight = 1 / (1 + np.square((matches.row_error_px - terms @ solution) / ROW_TOLERANCE_PX))
        solution = np.linalg.lstsq(terms * weight[:, None], matches.row_error_px * weight, rcond=None)[0]
    agreeing = np.abs(matches.row_error_px - terms @ solution) < ROW_TOLERANCE_PX
    still = float(on_row(matches).mean())
    moved = still > LEAST_STILL and agreeing.mean() < ALL_AGREEING
    if agreeing.mean() < LEAST_AGREEING or still > LEAST_AGREEING or moved:
        return 0.0
    return float(np.median(np.abs(matches.row_error_px[agreeing])))


def refined_error_px(pair: Rectification, good: Matches) -> float | None:
    """Median distance from their rows of features found again to a fraction of a pixel (Lucas and Kanade 1981).

    It is done in the common planes, where the surroundings of a feature look alike in both pictures.
    """
    if len(good.disparity_px) < FEWEST:
        return None
    some = good.chosen(
        np.linspace(0, len(good.disparity_px) - 1, min(MOST_REFINED, len(good.disparity_px))).astype(int)
    )
    camera = pair.reference.camera
    inverse = some.inverse_depths(pair)
    canvas = canvas_over(pair, whole(camera), 1.0, (max(float(inverse.min()), 0.0), float(inverse.max())))
    start = through(canvas.homography(), some.reference_px).astype(np.float32)
    way = np.stack([some.disparity_px - canvas.first_disparity, -some.row_error_px], axis=-1).astype(np.float32)
    found, status, _ = cv2.calcOpticalFlowPyrLK(
        canvas.reference_picture(),
        canvas.other_picture(),
        start,
        start - way,
        winSize=(WINDOW_PX, WINDOW_PX),
        maxLevel=0,
        flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )
    found = np.asarray(found, dtype=np.float64)
    kept = (np.asarray(status).ravel() > 0) & (np.abs(found - (start - way)) < SHORT_WAY_PX).all(axis=1)
    return float(np.median(np.abs((found - start)[kept, 1]))) if kept.sum() >= FEWEST else None


def _explained_by_swapping(pair: Rectification, reference: Features, other: Features) -> bool:
    """Whether features lie on their rows, in front of the cameras, when each picture is given the other's pose."""
    first, second = pair.reference, pair.other
    if first.image.shape != second.image.shape:
        return False
    swapped = rectify(View(second.image, first.camera, first.T_base_camera), replace(second, image=first.image))
    matches = in_common_planes(swapped, *matched(other, reference))
    good = on_row(matches) & (matches.disparity_px > ROW_TOLERANCE_PX)
    return len(good) >= FEWEST and good.mean() > LEAST_AGREEING and off_rows(matches) < WORST_PX


def _moved_together(matches: Matches, off: Bools) -> Floats:
    """Pixels (M, 2) of features off their rows that have neighbours which moved alike."""
    place = matches.reference_px[off]
    if len(place) < NEIGHBOURS:
        return np.empty((0, 2))
    way = matches.other_px[off] - place
    alike = (np.abs(way[:, None] - way[None]) < ALIKE_PX).all(axis=2)
    return place[alike.sum(axis=1) > NEIGHBOURS]


def _what_is_wrong(pair: Rectification, reference: Features, other: Features, error_px: float | None) -> str:
    if _explained_by_swapping(pair, reference, other):
        return "its picture and that of view 1 are swapped; exchange the two files in scene.toml"
    if error_px is None or error_px <= WORST_PX:
        return "what it shows would lie behind the cameras; correct T_base_camera of both views"
    return (
        f"features lie {error_px:.1f} px off the rows where its pose and camera put them, more than {WORST_PX:g} px; "
        "calibrate the cameras and the arm again, or take the pictures with the arm and the objects at rest"
    )

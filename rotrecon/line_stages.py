"""What each step of paper 3.2 left of one line of pixels, step by step, to be shown."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Bools, Floats, freeze
from rotrecon.rays.patch import without_speckle
from rotrecon.reconstruction import Reconstruction
from rotrecon.segmentation import PixelHistory


@dataclass(frozen=True, eq=False)
class LineStage:
    """One line of W pixels after one step."""

    name: str
    members: Bools
    """(W,) what is taken for the object after it."""
    removed: Bools
    """(W,) what this step took away."""
    added: Bools
    """(W,) what this step brought back."""
    mean_m: float | None
    """Of the depths that the step looked at, equation (1); None for a step that has no use for it."""
    reach_m: float | None
    """How far a depth may lie from the mean or from its neighbour, by (3) to (5); None alike."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class Line:
    """One line of W pixels across the drawn axis."""

    place_px: Floats
    """(W,) along the line, 0 on the axis."""
    depth_m: Floats
    """(W,) as it was segmented; NaN where it is not usable."""
    stages: tuple[LineStage, ...]

    def __post_init__(self) -> None:
        freeze(self)


def line_of(result: Reconstruction, row: int) -> Line:
    """The stages of one line of pixels of the first cut; raises IndexError for a line that there is not."""
    segmentation, segments, settings = result.segmentation, result.segments, result.settings
    history, run_of = segmentation.history[row], segmentation.removed_in_run[row]
    depth_m = result.frame.depth_m
    if settings.method == "robust":
        depth_m = without_speckle(depth_m)
    depth = depth_m.ravel()[segments.pixel[row]].astype(np.float64)
    members = history & PixelHistory.DEPTH > 0
    nothing = np.zeros_like(members)
    stages = [LineStage("all depths the arm can use", members, nothing, nothing, None, None)]
    for run in range(1, settings.layers):
        removed = run_of == run
        mean = float(depth[members].mean()) if members.any() else None
        members = members & ~removed
        stages.append(LineStage(f"run {run}: farther than the mean goes", members, removed, nothing, mean, None))
    mean_m, sigma_m = float(segmentation.mean_m[-1, row]), float(segmentation.sigma_m[-1, row])
    reach_m = max(settings.sigma_factor * sigma_m, settings.distance_floor_m)
    mean, reach = (mean_m, reach_m) if np.isfinite(mean_m) else (None, None)
    removed = history & PixelHistory.OUTLIER > 0
    members = members & ~removed
    stages.append(
        LineStage(f"within {settings.sigma_factor:g} sigma of the mean", members, removed, nothing, mean, reach)
    )
    for flag, name in (
        (PixelHistory.GROWN_FORWARD, "scan along the line brings back"),
        (PixelHistory.GROWN_BACKWARD, "scan back brings back"),
    ):
        added = history & flag > 0
        members = members | added
        stages.append(LineStage(name, members, nothing, added, None, reach))
    removed = history & PixelHistory.SPARSE_LINE > 0
    stages.append(LineStage("lines with too few pixels go", members & ~removed, removed, nothing, None, None))
    usable = history & PixelHistory.DEPTH > 0
    place = segments.first_offset_px + np.arange(len(history), dtype=np.float64)
    return Line(place, np.where(usable, depth, np.nan), tuple(stages))

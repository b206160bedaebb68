"""The four numbers of a pinhole camera, given or recovered from an organised cloud."""

from dataclasses import dataclass

import numpy as np

from rotrecon.arrays import Cloud, Floats

FEWEST_POINTS = 100
"""Valid points below which the intrinsics of a cloud are not to be recovered."""
_OUTLIER_SIGMAS = 3.0
_SIGMA_OF_MEDIAN = 1.4826
"""Standard deviation over median absolute deviation, for normal errors."""
_ROUNDS = 3


@dataclass(frozen=True)
class Intrinsics:
    """Focal lengths and principal point, px."""

    fx: float
    fy: float
    cx: float
    cy: float

    @property
    def K(self) -> Floats:
        """(3, 3) camera matrix, px."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def __str__(self) -> str:
        return f"fx {self.fx:.2f}, fy {self.fy:.2f}, cx {self.cx:.2f}, cy {self.cy:.2f} px"


def recover_intrinsics(points_m: Cloud) -> Intrinsics | None:
    """The intrinsics that put the points of an organised cloud (height, width, 3) on their own pixels.

    Solves u = fx x/z + cx and v = fy y/z + cy by least squares over the points that agree. None when there are
    too few points, or when no camera with x right, y down and z forward sees them so.
    """
    v, u = np.nonzero(np.isfinite(points_m[..., 2]))
    if len(u) < FEWEST_POINTS:
        return None
    points = points_m[v, u].astype(np.float64)
    horizontal = _robust_line(points[:, 0] / points[:, 2], u.astype(np.float64))
    vertical = _robust_line(points[:, 1] / points[:, 2], v.astype(np.float64))
    if horizontal is None or vertical is None:
        return None
    return Intrinsics(horizontal[0], vertical[0], horizontal[1], vertical[1])


def _robust_line(slope: Floats, pixel: Floats) -> tuple[float, float] | None:
    """The (focal, principal) of pixel = focal slope + principal; None unless the focal length is positive.

    Starts from the median slope between points half the picture apart, which bad points do not move (Theil and
    Sen), then fits what lies near that line.
    """
    order = np.argsort(pixel, kind="stable")
    half = len(order) // 2
    low, high = order[:half], order[-half:]
    run = slope[high] - slope[low]
    usable = run != 0
    if not usable.any():
        return None
    focal = float(np.median((pixel[high] - pixel[low])[usable] / run[usable]))
    principal = float(np.median(pixel - focal * slope))
    for _ in range(_ROUNDS):
        if not focal > 0:
            return None
        off = np.abs(pixel - focal * slope - principal)
        near = off <= _OUTLIER_SIGMAS * _SIGMA_OF_MEDIAN * np.median(off)
        mean_slope, mean_pixel = slope[near].mean(), pixel[near].mean()
        centred = slope[near] - mean_slope
        spread = float(centred @ centred)
        if spread == 0:
            return None
        focal = float(centred @ (pixel[near] - mean_pixel)) / spread
        principal = float(mean_pixel - focal * mean_slope)
    return (focal, principal) if focal > 0 else None

"""What an error of poses and cameras, as far as matched pictures show it, does to a size: it widens its interval."""

from dataclasses import replace

from rotrecon.outcome import Fit, Intervals, Range
from rotrecon.reconstruction import Reconstruction

SIGMA_OVER_MEDIAN = 1.4826
"""Standard deviation of a normal distribution over the median of its magnitude."""
HALF_95 = 1.96
"""Half of a 95 % interval in standard deviations."""


def with_calibration_error(result: Reconstruction) -> Reconstruction:
    """A result whose intervals hold what the epipolar check leaves open; others are given back as they are.

    Features that lie e px off their rows say that disparities d may be off by as much: rows show errors across the
    baseline, and those along it are of the same size and not seen. Depth, and with it every size, is then off by e / d.
    No number of pixels averages that out.
    """
    scale = scale_sigma(result)
    if scale == 0.0 or not isinstance(result.fit, Fit) or result.fit.intervals is None:
        return result
    intervals, distance_m = result.fit.intervals, float(result.fit.solid.center_m[2])
    widened = Intervals(
        diameter_m=_widened(intervals.diameter_m, scale),
        center_m=(intervals.center_m**2 + (HALF_95 * scale * distance_m) ** 2) ** 0.5,
        direction_rad=intervals.direction_rad,
        half_angle_rad=intervals.half_angle_rad,
        length_m=None if intervals.length_m is None else _widened(intervals.length_m, scale),
    )
    candidates = tuple(
        replace(one, diameter_m=None if one.diameter_m is None else _widened(one.diameter_m, scale))
        for one in result.candidates
    )
    return replace(result, fit=replace(result.fit, intervals=widened), candidates=candidates)


def scale_sigma(result: Reconstruction) -> float:
    """Relative standard deviation of depth at the object that the epipolar check leaves open; 0 where none is known."""
    stereo, baseline_m = result.frame.stereo, getattr(result.frame.noise, "baseline_m", None)
    if stereo is None or stereo.epipolar_error_px is None or baseline_m is None or not isinstance(result.fit, Fit):
        return 0.0
    disparity_px = result.frame.camera.focal_px * baseline_m / float(result.fit.solid.center_m[2])
    return SIGMA_OVER_MEDIAN * stereo.epipolar_error_px / disparity_px


def _widened(interval: Range, scale: float) -> Range:
    low, high = interval
    middle = (low + high) / 2
    half = (((high - low) / 2) ** 2 + (HALF_95 * scale * middle) ** 2) ** 0.5
    return (max(middle - half, 0.0), middle + half)

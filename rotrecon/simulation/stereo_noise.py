"""How a stereo camera's depth differs from the truth: outlines, correlated noise, shadows and holes."""

from dataclasses import dataclass

import cv2
import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.simulation.rendering import RenderedView


@dataclass(frozen=True)
class StereoErrors:
    """What goes wrong in matching; `disparity_sigma_px` 0, `window_px` 1 and so on switch a part off."""

    baseline_m: float = 0.1
    """Second camera at +x of the reference camera: the width of common stereo heads."""
    disparity_sigma_px: float = 0.15
    """Common for semi-global matching on good texture."""
    correlation_px: float = 4.0
    """Distance at which the noise's autocorrelation is down to 1/e: neighbours share their windows."""
    window_px: int = 7
    """Odd side of the matching window: disparity is a mean over one surface within it."""
    layer_gap_px: float = 3.0
    """Gap between the disparities in a window that makes them two surfaces."""
    foreground_share: float = 0.35
    """Share of a window at which the nearer surface takes it; below a half it grows over the outline."""
    half_occlusion: bool = True
    """Whether pixels that the second camera does not see have no depth."""
    hole_share: float = 0.01
    """Share of the picture lost in blobs, as glare and lack of texture do."""
    hole_size_px: float = 6.0
    """Scale of these blobs."""


def stereo_depth(view: RenderedView, errors: StereoErrors, rng: np.random.Generator) -> Floats:
    """Depth (height, width) along z that a stereo camera would give for a view; NaN where it gives none.

    The errors are made in disparity, d = f b / z.
    """
    focal_baseline = view.camera.focal_px * errors.baseline_m
    exact = focal_baseline / view.depth_m
    matched, foreground = _matched(exact, errors)
    noisy = matched + errors.disparity_sigma_px * correlated_noise(exact.shape, errors.correlation_px, rng)
    lost = (exact <= 0) | (noisy <= 0)
    if errors.half_occlusion:
        lost |= hidden_from_second(exact) & ~foreground
    blobs = correlated_noise(exact.shape, errors.hole_size_px, rng)
    lost |= blobs > np.quantile(blobs, 1 - errors.hole_share)
    noisy[lost] = np.nan
    return focal_baseline / noisy


def correlated_noise(size: tuple[int, ...], correlation_px: float, rng: np.random.Generator) -> Floats:
    """Gaussian noise (height, width) of standard deviation 1, autocorrelation exp(-(lag / correlation_px)^2).

    White noise through a Gaussian of sigma correlation_px / 2; with 0 it stays white.
    """
    if correlation_px == 0:
        return rng.standard_normal(size)
    border = int(np.ceil(2 * correlation_px))
    white = rng.standard_normal((size[0] + 2 * border, size[1] + 2 * border))
    kernel = cv2.getGaussianKernel(2 * border + 1, correlation_px / 2)
    smooth = np.asarray(cv2.sepFilter2D(white, -1, kernel, kernel), dtype=np.float64)
    return smooth[border:-border, border:-border] / float((kernel**2).sum())


def hidden_from_second(disparity_px: Floats) -> Bools:
    """Which pixels (height, width) a second camera at +x misses: outside its picture, or behind something.

    Every pixel is carried to its place u - d in the second picture, where the largest disparity is in front;
    one more than a pixel behind that is hidden.
    """
    height, width = disparity_px.shape
    place = np.subtract(np.arange(width, dtype=np.float64), disparity_px)
    left = np.floor(place).astype(np.int64)
    front = np.zeros((height, width + 2))
    rows, _ = np.indices(disparity_px.shape)
    for column in (left, left + 1):
        # a column to each side takes what falls out of the picture
        np.maximum.at(front, (rows, column.clip(-1, width) + 1), disparity_px)
    nearest = np.rint(place).astype(np.int64)
    return (nearest < 0) | (front[rows, nearest.clip(-1, width) + 1] > disparity_px + 1)


def _matched(exact: Floats, errors: StereoErrors) -> tuple[Floats, Bools]:
    """Disparity (height, width) as a window sees it, and the outline pixels that the nearer surface took."""
    window = np.ones((errors.window_px, errors.window_px), dtype=np.uint8)
    spread = np.asarray(cv2.dilate(exact, window)) - np.asarray(cv2.erode(exact, window))
    rows, columns = np.nonzero(spread > errors.layer_gap_px)
    matched = np.array(cv2.blur(exact, window.shape), dtype=np.float64)
    foreground = np.zeros(exact.shape, dtype=bool)
    if errors.window_px == 1 or len(rows) == 0:
        return matched, foreground
    half = errors.window_px // 2
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(exact, half, mode="edge"), window.shape)
    disparity, taken = _one_surface(windows[rows, columns].reshape(len(rows), -1), errors)
    matched[rows, columns] = disparity
    foreground[rows, columns] = taken
    return matched, foreground


def _one_surface(windows: Floats, errors: StereoErrors) -> tuple[Floats, Bools]:
    """Mean disparity (N,) of the surface that wins each window (N, M), and whether it is the nearer one."""
    ordered = np.sort(windows, axis=1)
    gaps = np.diff(ordered, axis=1)
    two = gaps.max(axis=1) > errors.layer_gap_px
    front = np.indices(ordered.shape)[1] > gaps.argmax(axis=1)[:, None]
    nearer = two & (front.mean(axis=1) > errors.foreground_share)
    members = (front == nearer[:, None]) | ~two[:, None]
    return np.mean(ordered, axis=1, where=members), nearer

"""How far away something is that is seen in the reference picture as it is: the depth at which the views agree best."""

from dataclasses import replace

import cv2
import numpy as np

from rotrecon.arrays import Bools, Bytes, Cloud, Floats
from rotrecon.compiled import MATRIX, compiled
from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.matches import FEWEST_PIXELS, Other
from rotrecon.photometry.splines import smoothed, smoothing_reach
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import spread
from rotrecon.rays.surfaces import Surface, turn_of
from rotrecon.rays.traces import Rays

SMOOTHING_PX = 1.5
"""Standard deviation of the low pass: the deeper, the farther apart depths may be tried."""
STEP_PX, SHIFTS = 1.0, (0.4, 3.0)
"""Of the shift in the other picture, and how small and large it may be over that at the depth where the scan begins."""
INFINITE = 1e6
"""Times as far away as anything."""
SCANNED_PIXELS = 400
"""Enough for a correlation that is right to a twentieth."""
TILTS_RAD: Floats = np.deg2rad(np.arange(-40.0, 41.0, 10.0))
"""By which an axis may run into the picture that is known only as it is drawn; beyond, one looks from elsewhere."""


def scanned(surface: Surface, patch: Patch, pixels: Bools, other: Other, tilts_rad: Floats) -> tuple[Surface, float]:
    """The surface, tilted and as far away as two pictures agree best, and their correlation over it.

    Its outline in the reference picture is the same at every distance. `pixels` (N,) of the patch show it.
    """
    index = spread(np.flatnonzero(pixels).astype(np.int32), SCANNED_PIXELS)
    rays, grey = patch.rays[:, index], smoothed(patch.picture(), SMOOTHING_PX).ravel()[index]
    scales = _scales(surface, rays, other.carrier)
    tried = [_tilted(surface, float(tilt)) for tilt in tilts_rad]
    met = [one.meet(rays) for one in tried]
    near = [hit & (depth_m > 0) for depth_m, hit in met]
    places_px = [
        _places(rays[:, some], depth_m[some], scales, other.carrier)
        for some, (depth_m, _) in zip(near, met, strict=True)
    ]
    corner, picture = _picture_about(other.view.image, places_px)
    best, found = -np.inf, surface
    for tilted, some, place_px in zip(tried, near, places_px, strict=True):
        alike = _correlations(grey[some], _sampled(picture, place_px.astype(np.float32) - corner[:, None, None]))
        if len(alike) and alike.max() > best:
            best, found = float(alike.max()), _scaled(tilted, float(scales[alike.argmax()]))
    return found, best


def _scales(surface: Surface, rays: Rays, carrier: Carrier) -> Floats:
    """Times as far away as to shift the surface in the other picture in even steps."""
    depth_m = surface.meet(rays)[0]
    apart = carrier.carried(rays, depth_m)[0] - carrier.carried(rays, INFINITE * depth_m)[0]
    shift_px = float(np.nanmedian(np.linalg.norm(apart, axis=0)))
    return shift_px / np.arange(SHIFTS[0] * shift_px, SHIFTS[1] * shift_px + STEP_PX, STEP_PX)


def _places(rays: Rays, depth_m: Floats, scales: Floats, carrier: Carrier) -> Floats:
    """Where (2, S, n) points of rays are seen that lie so many times as deep."""
    deeper_m = np.outer(scales, depth_m)
    carried, _ = carrier.carried(np.tile(rays, len(scales)), deeper_m.ravel())
    return carried.reshape(2, *deeper_m.shape)


def _picture_about(image: Bytes, places_px: list[Floats]) -> tuple[Cloud, Cloud]:
    """First pixel (2,) and smoothed grey values (h, w) of the part of a picture that places (2, ...) lie in."""
    last = np.array(image.shape[1::-1]) - 1
    ends = np.array([_extent(np.ascontiguousarray(place.reshape(2, -1))) for place in places_px])
    reach = smoothing_reach(SMOOTHING_PX) + 1
    low = np.clip(np.floor(ends[:, 0].min(axis=0)) - reach, 0, last).astype(np.int64)
    high = np.clip(np.ceil(ends[:, 1].max(axis=0)) + reach, low, last).astype(np.int64) + 1
    grey = smoothed(image[low[1] : high[1], low[0] : high[0]], SMOOTHING_PX)
    return low.astype(np.float32), grey.astype(np.float32)


@compiled(MATRIX)
def _extent(place_px: Floats) -> tuple[tuple[float, float], tuple[float, float]]:
    """Smallest and largest coordinates of those of some places (2, N) that are known; infinite where there are none."""
    low_u, low_v, high_u, high_v = np.inf, np.inf, -np.inf, -np.inf
    for i in range(place_px.shape[1]):
        u, v = place_px[0, i], place_px[1, i]
        if not (np.isnan(u) or np.isnan(v)):
            low_u, low_v, high_u, high_v = min(low_u, u), min(low_v, v), max(high_u, u), max(high_v, v)
    return (low_u, low_v), (high_u, high_v)


def _sampled(picture: Cloud, place_px: Cloud) -> Floats:
    """Grey values (S, n) at places, NaN outside the picture; to 1/32 px, which is finer than any step."""
    u, v = place_px
    outside = float("nan")
    return np.asarray(
        cv2.remap(picture, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=outside), np.float64
    )


def _tilted(surface: Surface, tilt_rad: float) -> Surface:
    """A lateral surface whose axis runs into the picture by so much more."""
    if not isinstance(surface, Lateral) or tilt_rad == 0.0:
        return surface
    across = np.cross(surface.center_m, surface.direction)
    across /= np.linalg.norm(across)
    deeper = np.cross(surface.direction, across)
    direction = np.cos(tilt_rad) * surface.direction + np.sin(tilt_rad) * deeper
    return replace(surface, turn=turn_of(direction, -surface.center_m))


def _scaled(surface: Surface, scale: float) -> Surface:
    return replace(surface, center_m=scale * surface.center_m, radius_m=scale * surface.radius_m)


def _correlations(first: Floats, seconds: Floats) -> Floats:
    """Of grey values (n,) with each of (S, n), whatever gain and offset are between them.

    0 for values that are even; those that are NaN do not count, and -1 is said where hardly any is known.
    """
    known = np.isfinite(seconds)
    count = known.sum(axis=1)
    divisor = np.maximum(count, 1)[:, None]
    second = np.where(known, seconds, 0.0)
    first = np.where(known, first, 0.0)
    first, second = (known * (one - one.sum(axis=1, keepdims=True) / divisor) for one in (first, second))
    size = np.sqrt((first**2).sum(axis=1) * (second**2).sum(axis=1))
    alike = (first * second).sum(axis=1) / np.where(size > 0, size, np.inf)
    return np.where(count < FEWEST_PIXELS, -1.0, alike)

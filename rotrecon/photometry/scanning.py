"""How far away something is that is seen in the reference picture as it is: the depth at which the views agree best."""

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bools, Floats
from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.matches import FEWEST_PIXELS, Other
from rotrecon.photometry.splines import smoothed
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
    picture = smoothed(other.view.image, SMOOTHING_PX).astype(np.float32)
    best, found = -np.inf, surface
    for tilt in tilts_rad:
        tilted = _tilted(surface, float(tilt))
        depth_m, hit = tilted.meet(rays)
        near = hit & (depth_m > 0)
        place_px = _places(rays[:, near], depth_m[near], scales, other.carrier)
        alike = _correlations(grey[near], _sampled(picture, place_px))
        if len(alike) and alike.max() > best:
            best, found = float(alike.max()), _scaled(tilted, float(scales[alike.argmax()]))
    return found, best


def _scales(surface: Surface, rays: Rays, carrier: Carrier) -> Floats:
    """Times as far away as to shift the surface in the other picture in even steps."""
    depth_m = surface.trace(rays).depth_m
    apart = carrier.carried(rays, depth_m)[0] - carrier.carried(rays, INFINITE * depth_m)[0]
    shift_px = float(np.nanmedian(np.linalg.norm(apart, axis=0)))
    return shift_px / np.arange(SHIFTS[0] * shift_px, SHIFTS[1] * shift_px + STEP_PX, STEP_PX)


def _places(rays: Rays, depth_m: Floats, scales: Floats, carrier: Carrier) -> Floats:
    """Where (2, S, n) points of rays are seen that lie so many times as deep."""
    deeper_m = np.outer(scales, depth_m)
    carried, _ = carrier.carried(np.tile(rays, len(scales)), deeper_m.ravel())
    return carried.reshape(2, *deeper_m.shape)


def _sampled(picture: NDArray[np.float32], place_px: Floats) -> Floats:
    """Grey values (S, n) at places, NaN outside the picture; to 1/32 px, which is finer than any step."""
    u, v = place_px.astype(np.float32)
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

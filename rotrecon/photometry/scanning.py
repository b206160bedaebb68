"""How far away something is that is seen in the reference picture as it is: the depth at which the views agree best."""

from dataclasses import replace

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.photometry.carrying import Carrier
from rotrecon.photometry.matches import FEWEST_PIXELS, Other
from rotrecon.photometry.splines import Spline, smoothed, spline_of
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import spread
from rotrecon.rays.surfaces import Lateral, Rays, Surface, turn_of

SMOOTHING_PX = 1.5
"""Standard deviation of the low pass: the deeper, the farther apart depths may be tried."""
STEP_PX, SHIFTS = 1.0, (0.4, 3.0)
"""Of the shift in the other picture, and how small and large it may be over that at the depth where the scan begins."""
INFINITE = 1e6
"""Times as far away as anything."""
BORDER_PX = 24.0
"""Of the pictures' part that is looked at, for surfaces that are tilted."""
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
    spline = _spline(surface, rays, other, scales)
    best, found = -np.inf, surface
    for tilt in tilts_rad:
        tilted = _tilted(surface, float(tilt))
        trace = tilted.trace(rays)
        near = trace.hit & (trace.depth_m > 0)
        for scale in scales:
            place_px, _ = other.carrier.carried(rays[:, near], scale * trace.depth_m[near])
            within = spline.within(place_px)
            if within.sum() < FEWEST_PIXELS:
                continue
            alike = _correlation(grey[near][within], spline.at(place_px[:, within]).grey)
            if alike > best:
                best, found = alike, _scaled(tilted, scale)
    return found, best


def _scales(surface: Surface, rays: Rays, carrier: Carrier) -> Floats:
    """Times as far away as to shift the surface in the other picture in even steps."""
    depth_m = surface.trace(rays).depth_m
    apart = carrier.carried(rays, depth_m)[0] - carrier.carried(rays, INFINITE * depth_m)[0]
    shift_px = float(np.nanmedian(np.linalg.norm(apart, axis=0)))
    return shift_px / np.arange(SHIFTS[0] * shift_px, SHIFTS[1] * shift_px + STEP_PX, STEP_PX)


def _spline(surface: Surface, rays: Rays, other: Other, scales: Floats) -> Spline:
    """Of all that the surface may be seen at."""
    depth_m = surface.trace(rays).depth_m
    place_px = np.concatenate([other.carrier.carried(rays, scale * depth_m)[0] for scale in scales[[0, -1]]], axis=1)
    low, high = np.nanmin(place_px, axis=1), np.nanmax(place_px, axis=1)
    return spline_of(other.view.image, low - BORDER_PX, high + BORDER_PX, SMOOTHING_PX)


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


def _correlation(first: Floats, second: Floats) -> float:
    """Of grey values (n,), whatever gain and offset are between them; 0 for one that is even."""
    first, second = first - first.mean(), second - second.mean()
    size = float(np.sqrt((first @ first) * (second @ second)))
    return float(first @ second) / size if size > 0 else 0.0

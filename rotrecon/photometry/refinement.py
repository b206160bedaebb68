"""A fitted surface refined until the pictures of several cameras agree over it, outlines in all of them included."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Bytes, Floats, Indices, freeze
from rotrecon.drawing import CrossSegments
from rotrecon.frame import View
from rotrecon.photometry.agreement import LEAST_SIGMA, Agreement
from rotrecon.photometry.carrying import Carrier, carrier_of
from rotrecon.photometry.outlines import CarriedOutline, outline_in
from rotrecon.photometry.splines import LUMA, SCIPY, spline_of
from rotrecon.photometry.visible import seen_too, shown
from rotrecon.rays.correlation import Likeness, likeness_of
from rotrecon.rays.fitting import TUKEY, Measurement, Outline, cauchy, refine, robust_scale, tukey
from rotrecon.rays.limbs import seen_outline
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import RayFit, predicted, spread
from rotrecon.rays.surfaces import Ball, Lateral, Surface

SMOOTHING_PX = 0.7
MOST_PIXELS = 16000
FEWEST_PIXELS = 200
ROUNDS, ITERATIONS = 3, 8
USE = {"photo": True, "outline": True}


@dataclass(frozen=True, eq=False)
class Seen:
    pixels: Indices
    agreement: Agreement


def agreements(surface, patch, fit, views, carriers, smoothing=SMOOTHING_PX):
    mask = shown(surface, patch, fit.sigma)
    grey = SCIPY.gaussian_filter(patch.picture().astype(np.float64) @ LUMA, smoothing).ravel() if smoothing else (patch.picture().astype(np.float64) @ LUMA).ravel()
    found = []
    for view, carrier in zip(views, carriers):
        pixels = np.flatnonzero(mask).astype(np.int32)
        rays = patch.rays[:, pixels]
        pixels = pixels[seen_too(surface, rays, carrier)]
        rays = patch.rays[:, pixels]
        place, _ = carrier.carried(rays, surface.trace(rays).depth_m)
        if len(pixels) < FEWEST_PIXELS:
            continue
        spline = spline_of(view.image, np.nanmin(place, axis=1), np.nanmax(place, axis=1), smoothing)
        pixels = pixels[spline.within(place)]
        pixels = spread(pixels, MOST_PIXELS)
        found.append(Seen(pixels, Agreement(patch.rays[:, pixels], grey[pixels], spline, carrier)))
    return found


def refined(fit: RayFit, patch: Patch, views, T_base_camera, segments, length_m):
    surface = fit.surface
    carriers = [carrier_of(view, T_base_camera) for view in views]
    units = surface.units(length_m)
    for round_ in range(ROUNDS):
        seen = agreements(surface, patch, fit, views, carriers) if USE["photo"] else []
        outlines = []
        if USE["outline"] and not isinstance(surface, Ball):
            own = seen_outline(surface, patch, segments, length_m)
            if own.edges is not None:
                outlines.append(own.edges)
            points = (patch.rays * surface.trace(patch.rays).depth_m)[:, patch.kept]
            h = np.percentile(surface.heights(points.T), [1, 99])
            for view, carrier in zip(views, carriers):
                o = outline_in(view, carrier, surface, patch, h)
                if o.edges is not None:
                    outlines.append(CarriedOutline(o.edges, carrier))
        weighting = []
        for s in seen:
            r = s.agreement.predict(surface).residual
            sigma = max(robust_scale(r), LEAST_SIGMA)
            image = np.full(patch.shape, np.nan)
            image.ravel()[s.pixels] = np.where(np.abs(r) < 3 * sigma, r, np.nan)
            like = likeness_of(image)
            weighting.append((sigma, like.independent_share))
        measurements = [*(s.agreement for s in seen), *outlines]
        weighting += [(1.0, 1.0)] * len(outlines)
        if not measurements:
            return None
        res = refine(surface, measurements, weighting, cauchy if round_ == 0 else tukey, fit.free, units, ITERATIONS)
        surface = res.surface
    cov = np.zeros_like(res.information); k = np.ix_(fit.free, fit.free)
    cov[k] = np.linalg.pinv(res.information[k], hermitian=True)
    return surface, cov, seen, outlines, weighting

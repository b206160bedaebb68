"""The robust method: a solid fitted along the rays, its sections, its intervals, and how sure its kind is."""

from dataclasses import replace

import numpy as np

from rotrecon.arrays import Bools, Cloud
from rotrecon.axis import Axis
from rotrecon.by_pictures import Seen, by_pictures
from rotrecon.extent import extent_of
from rotrecon.found import Found, reconstruction_of
from rotrecon.frame import Frame
from rotrecon.judgement import failure_of, too_little
from rotrecon.outcome import FailureReason, FitFailure
from rotrecon.rays.hypotheses import Held, Scene, scene_of
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.losses import robust_scale
from rotrecon.rays.patch import Patch, patch_of
from rotrecon.rays.ray_fit import RayFit, Sight, predicted
from rotrecon.rays.robust import Ranked, rank
from rotrecon.rays.starts import robust_line
from rotrecon.recognition import chosen_of, intervals_of
from rotrecon.reconstruction import Cut, Reconstruction
from rotrecon.section_radii import SectionRadii, section_radii
from rotrecon.settings import Settings
from rotrecon.soundness import soundness_of
from rotrecon.stroke.axis_direction import held_direction
from rotrecon.turned.turned_fit import fit_turned


def by_rays(segmented: Reconstruction, depth_m: Cloud) -> Reconstruction:
    """The reconstruction of a segmented object, with its solid or the reason why there is none.

    `depth_m` (S, W) is the depth of the cells that was segmented.
    """
    frame, drawing, settings = segmented.frame, segmented.drawing, segmented.settings
    kept = segmented.segmentation.kept & np.isfinite(depth_m)
    patch = patch_of(frame, drawing.area, segmented.segments, kept)
    reachable = bool(np.isfinite(patch.depth_m[patch.area]).any())
    scene = scene_of(frame.camera, patch, segmented.segments, kept, depth_m.astype(np.float64))
    direction = held_direction(frame, drawing)
    failure = too_little(scene, reachable, settings)
    if failure is None and isinstance(direction, FitFailure):
        failure = direction
    if failure is not None or isinstance(direction, FitFailure):
        return replace(segmented, fit=failure)
    held = Held(direction, drawing.constraints.radius_m)
    found = _find(scene, held, segmented)
    if isinstance(found, FitFailure):
        return replace(segmented, fit=found)
    radii = _sections(found, segmented)
    excluded = [number for number in drawing.excluded_sections if 0 <= number < len(radii.circles.state)]
    if excluded:
        many = f"{len(excluded)} of {len(radii.heights_m)} sections are excluded by hand; put some of them back"
        without, radii = replace(scene, patch=_without(patch, radii, excluded)), radii.excluding(excluded)
        found = (
            _find(without, held, segmented)
            if radii.circles.used.any()
            else FitFailure(FailureReason.TOO_FEW_SECTIONS, many)
        )
        if isinstance(found, FitFailure):
            failure, left = FitFailure(found.reason, many), Cut(radii.circles, None)
            return replace(segmented, fit=failure, sections=radii.sections, second_cut=left)
    return reconstruction_of(segmented, found, radii)


def _find(scene: Scene, held: Held, segmented: Reconstruction) -> Found | FitFailure:
    """The most credible shape, or the reason why there is none."""
    kind, settings = segmented.drawing.kind, segmented.settings
    ranked = rank(scene, held)
    if not ranked:
        return too_little(scene, True, settings) or FitFailure(
            FailureReason.NOT_ROUND, "nothing round could be fitted; draw the area close round one object"
        )
    chosen = chosen_of(ranked, kind, settings)
    if chosen is None:
        advice = (
            f"the depths speak for a {ranked[0].shape} rather than a {kind}; choose that, or let the program decide"
        )
        return FitFailure(FailureReason.NOT_THIS_KIND, advice)
    seen = by_pictures(Seen(ranked, chosen, scene), held, segmented.frame, kind, settings)
    ranked, chosen, scene = seen.ranked, seen.chosen, seen.scene
    found = _followed_along(ranked, chosen, scene, settings)
    if not seen.held or (not seen.textured and isinstance(found, FitFailure)):
        advice = "too little texture is seen on the object to match it; light it better, or bring the camera nearer"
        return FitFailure(FailureReason.UNTEXTURED, advice)
    if seen.doubts and isinstance(found, Found):
        return replace(found, doubts=seen.doubts)
    if kind is not None or not isinstance(chosen.surface, Lateral) or not _is_part_only(found, chosen, scene, settings):
        return found
    turned = fit_turned(scene.patch, scene.ridge, chosen.fit)
    if turned is None or not _roughness_over(turned, chosen, scene.patch) < settings.turned_sigma:
        return found
    whole = Ranked("revolution", turned.surface, turned, 0.0)
    better = _followed_along((whole, *(replace(one, cost=one.cost + 1.0) for one in ranked)), whole, scene, settings)
    if isinstance(better, FitFailure) or better.soundness.inlier_share < settings.turned_inlier_share:
        return found
    return found if _interval_over_size(whole) > settings.widest_interval else better


def _is_part_only(found: Found | FitFailure, chosen: Ranked, scene: Scene, settings: Settings) -> bool:
    """Whether a cylinder or a cone explains a part of the object along its axis, or all of it badly."""
    if isinstance(found, FitFailure):
        return found.reason == FailureReason.NOT_ROUND
    if _interval_over_size(chosen) > settings.certain_interval:
        return True
    assert isinstance(chosen.surface, Lateral)
    low, high = np.percentile(chosen.surface.heights(scene.ridge.points_m), [5, 95])
    covered = min(high, found.ends_m[1]) - max(low, found.ends_m[0])
    return bool(covered < settings.covered_length * (high - low))


def _roughness_over(turned: RayFit, chosen: Ranked, patch: Patch) -> float:
    """Residuals of a turned surface over those of a simpler one of the same pixels, as if both were as simple."""
    simple = robust_scale(predicted(patch, turned.pixels, chosen.surface, Sight()).residual)
    freedoms = max(turned.independent - float(turned.free.sum()), 1.0)
    return robust_scale(turned.residual) / simple * float(np.sqrt(turned.independent / freedoms))


def _interval_over_size(ranked: Ranked) -> float:
    """Width of the interval of a shape's diameter over the diameter."""
    return intervals_of(ranked, 0.0, None).relative_width


def _followed_along(ranked: tuple[Ranked, ...], chosen: Ranked, scene: Scene, settings: Settings) -> Found | FitFailure:
    """How far along its axis the chosen shape is there, and how sound it is; or why it is no result."""
    assert chosen.fit is not None
    surface = chosen.surface
    if isinstance(surface, Lateral):
        extent = extent_of(surface, scene.patch, chosen.fit.sigma, chosen.fit.likeness.length_px)
        height = surface.heights(scene.ridge.points_m)
        ends_m = (extent.low_m, extent.high_m) if extent else (float(height.min()), float(height.max()))
        axis = Axis(surface.center_m, surface.direction)
    else:
        extent, ends_m = None, (-surface.radius_m, surface.radius_m)
        axis = Axis(surface.center_m, robust_line(scene.ridge.points_m)[1])
    soundness = soundness_of(chosen.fit, scene.patch, ends_m)
    failure = failure_of(chosen, soundness, scene, settings)
    return failure or Found(scene, ranked, chosen, axis, ends_m, extent, soundness)


def _sections(found: Found, segmented: Reconstruction) -> SectionRadii:
    """As many sections as the drawing has, across the axis, through the depths that agree."""
    assert found.chosen.fit is not None
    count, patch, agreeing = len(segmented.segments.pixel), found.scene.patch, found.soundness.agreeing
    cloud_m = _cloud(segmented.frame, patch, agreeing)
    return section_radii(found.chosen.fit, found.axis, patch, agreeing, cloud_m, count, segmented.settings)


def _cloud(frame: Frame, patch: Patch, agreeing: Bools) -> Cloud:
    """The frame's cloud, with the depths of a patch's agreeing pixels (N,) where views have sharpened them."""
    if not frame.views:
        return frame.points_m
    pixels = np.flatnonzero(agreeing).astype(np.int32)
    points_m = frame.points_m.copy()
    points_m.reshape(-1, 3)[patch.frame_pixels(pixels)] = (patch.rays[:, pixels] * patch.depth_m[pixels]).T
    return points_m


def _without(patch: Patch, radii: SectionRadii, excluded: list[int]) -> Patch:
    """A patch less the pixels of sections that the operator took out."""
    drawn = patch.drawn.copy()
    width = patch.camera.width
    for number in excluded:
        place = np.stack(np.divmod(radii.sections.pixels_in(number), width)[::-1], axis=-1)
        drawn[patch.pixel_of(place.astype(np.float64))] = False
    return replace(patch, drawn=drawn)

"""The robust method: a solid fitted along the rays, its sections, its intervals, and how sure its kind is."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Cloud, Floats, freeze
from rotrecon.axis import Axis, FittedAxis
from rotrecon.by_pictures import Seen, by_pictures
from rotrecon.extent import Extent, extent_of
from rotrecon.frame import Frame, StereoNoise
from rotrecon.intervals import radius_sigma
from rotrecon.judgement import doubts_of, failure_of, too_little
from rotrecon.outcome import Evidence, FailureReason, Fit, FitFailure, PartOf, Range
from rotrecon.primitives import Primitive
from rotrecon.rays.hypotheses import Held, Scene, scene_of
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.patch import Patch, patch_of
from rotrecon.rays.ray_fit import RayFit
from rotrecon.rays.robust import Ranked, rank
from rotrecon.rays.starts import robust_line
from rotrecon.recognition import candidates_of, chosen_of, intervals_of, is_possible, solid_of
from rotrecon.reconstruction import Cut, Reconstruction
from rotrecon.section_radii import SectionRadii, section_radii
from rotrecon.settings import Settings
from rotrecon.soundness import Soundness, soundness_of
from rotrecon.stroke.axis_direction import held_direction
from rotrecon.tools import NoTool, Reading, propose_tool
from rotrecon.turned.parts import Part
from rotrecon.turned.turned_fit import fit_turned


@dataclass(frozen=True, eq=False)
class _Found:
    """The chosen shape and what is known of it."""

    scene: Scene
    """With the depths that it was compared with."""
    ranked: tuple[Ranked, ...]
    chosen: Ranked
    axis: Axis
    ends_m: Range
    """Heights of the ends along the axis, from its point."""
    extent: Extent | None
    soundness: Soundness
    doubts: tuple[str, ...] = ()
    """What the pictures leave open."""

    def __post_init__(self) -> None:
        freeze(self)


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
    return _reconstruction(segmented, found, radii)


def _find(scene: Scene, held: Held, segmented: Reconstruction) -> _Found | FitFailure:
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
    if seen.doubts and isinstance(found, _Found):
        return replace(found, doubts=seen.doubts)
    if kind is not None or not isinstance(chosen.surface, Lateral) or not _is_part_only(found, chosen, scene, settings):
        return found
    turned = fit_turned(scene.patch, scene.ridge, chosen.fit)
    assert chosen.fit is not None
    if turned is None or not turned.sigma < settings.turned_sigma * chosen.fit.sigma:
        return found
    whole = Ranked("revolution", turned.surface, turned, 0.0)
    better = _followed_along((whole, *(replace(one, cost=one.cost + 1.0) for one in ranked)), whole, scene, settings)
    if isinstance(better, FitFailure) or better.soundness.inlier_share < settings.turned_inlier_share:
        return found
    return better


def _is_part_only(found: _Found | FitFailure, chosen: Ranked, scene: Scene, settings: Settings) -> bool:
    """Whether a cylinder or a cone explains a part of the object along its axis, or all of it badly."""
    if isinstance(found, FitFailure):
        return found.reason == FailureReason.NOT_ROUND
    low_m, high_m = intervals_of(chosen, 0.0, None).diameter_m
    if high_m - low_m > settings.certain_interval * (high_m + low_m) / 2:
        return True
    assert isinstance(chosen.surface, Lateral)
    low, high = np.percentile(chosen.surface.heights(scene.ridge.points_m), [5, 95])
    covered = min(high, found.ends_m[1]) - max(low, found.ends_m[0])
    return bool(covered < settings.covered_length * (high - low))


def _followed_along(
    ranked: tuple[Ranked, ...], chosen: Ranked, scene: Scene, settings: Settings
) -> _Found | FitFailure:
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
    return failure or _Found(scene, ranked, chosen, axis, ends_m, extent, soundness)


def _sections(found: _Found, segmented: Reconstruction) -> SectionRadii:
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


def _reconstruction(segmented: Reconstruction, found: _Found, radii: SectionRadii) -> Reconstruction:
    settings, chosen, scene = segmented.settings, found.chosen, found.scene
    assert chosen.fit is not None
    kind = segmented.drawing.kind
    solid = solid_of(chosen, kind, found.ends_m, found.axis.direction, settings)
    middle_m = float(found.axis.along(solid.center_m))
    length_m = None if found.extent is None else found.extent.length_interval_m
    intervals = intervals_of(chosen, middle_m, length_m)
    candidates = candidates_of(found.ranked, chosen, middle_m, settings)
    margin = candidates[0].score - max((other.score for other in candidates[1:]), default=0.0)
    doubts = found.doubts + doubts_of(chosen, found.soundness, intervals, radii.circles.state, scene, settings)
    rivals = [one for one in found.ranked if one is not chosen and is_possible(one, chosen, settings)]
    low_m, high_m = intervals.diameter_m
    narrow = high_m - low_m <= settings.certain_interval * (high_m + low_m) / 2
    certain = narrow and not doubts and not rivals and chosen.shape != "revolution"
    T_base_camera = segmented.frame.T_base_camera
    fit = Fit(
        solid=solid,
        section_state=radii.circles.state,
        along_m=radii.heights_m - middle_m,
        rms_m=_rms(solid.distance(radii.sections.points_of(radii.circles.used))),
        arc_rad=found.soundness.arc_rad,
        concave=chosen.surface.side > 0,
        doubts=doubts,
        intervals=intervals,
        evidence=_evidence(segmented, found, scene, (radii, middle_m), certain, margin),
    )
    cut = Cut(radii.circles, FittedAxis(found.axis.point_m, found.axis.direction, radii.circles.used))
    result = replace(segmented, fit=fit, sections=radii.sections, second_cut=cut, candidates=candidates)
    in_base = solid.moved(T_base_camera)
    readings = [_reading(found, chosen, in_base, middle_m)]
    for one in rivals:
        other = solid_of(one, None, found.ends_m, found.axis.direction, settings)
        readings.append(_reading(found, one, other.moved(T_base_camera), middle_m))
    result = replace(result, solid=in_base, readings=tuple(readings))
    if doubts:
        return replace(result, tool=NoTool(doubts))
    place, camera_m = segmented.drawing.contact, T_base_camera[:3, 3]
    tool = propose_tool(result.readings, camera_m, fit.concave, settings.tools, place, settings.dangerous)
    return replace(result, tool=tool)


def _reading(found: _Found, one: Ranked, solid: Primitive, middle_m: float) -> Reading:
    """What the object may be, for the choice of a tool; an open end may lie anywhere beyond."""
    intervals = intervals_of(one, middle_m, None if found.extent is None else found.extent.length_interval_m)
    length_m = intervals.length_m
    if length_m is None and found.extent is not None:
        length_m = (found.extent.length_m, np.inf)
    return Reading(solid, intervals.diameter_m, length_m, intervals.half_angle_rad)


def _evidence(
    segmented: Reconstruction,
    found: _Found,
    scene: Scene,
    sections: tuple[SectionRadii, float],
    certain: bool,
    margin: float,
) -> Evidence:
    """`sections` come with the height of the solid's middle."""
    radii, middle_m = sections
    fit, surface, noise = found.chosen.fit, found.chosen.surface, scene.patch.noise
    assert fit is not None
    depth_m = float(surface.center_m[2]) - surface.side * surface.size_m
    stated = segmented.frame.noise
    baseline_m = stated.baseline_m if isinstance(stated, StereoNoise) else None
    noise_m = float(noise.sigma_m(depth_m))
    return Evidence(
        certain=certain,
        margin=margin,
        inlier_share=found.soundness.inlier_share,
        sigma_over_radius=radius_sigma(fit) / surface.size_m,
        noise_m=noise_m,
        noise_px=None if baseline_m is None else noise_m * scene.patch.focal_px * baseline_m / depth_m**2,
        correlation_px=max(noise.correlation_px, fit.likeness.length_px if fit.likeness.alike > 0 else 0.0),
        noise_stated=noise.stated,
        depth_weight=fit.likeness.independent_share / fit.sigma**2,
        outline_weight=sum(share * float((1.0 / outline.sigma_px**2).sum()) for outline, share in fit.outlines),
        doubt_share=_doubt_share(fit),
        open_ends=None if found.extent is None else (found.extent.low_open, found.extent.high_open),
        parts=tuple(_told(part, middle_m) for part in radii.parts),
        radius_low_m=radii.low_m,
        radius_high_m=radii.high_m,
    )


def _doubt_share(fit: RayFit) -> float:
    """Of the variance of the radius at the surface's centre, from 0 to 1."""
    place = fit.surface.size_place
    doubt = np.broadcast_to(fit.doubt, fit.covariance.shape)[place, place]
    return float(np.clip(doubt / max(fit.covariance[place, place], np.finfo(float).tiny), 0.0, 1.0))


def _told(part: Part, middle_m: float) -> PartOf:
    """A part as it is told, from the solid's middle."""
    low, high = part.radius_interval_m
    half_angle_rad = float(np.arctan(part.slope)) if part.kind == "cone" else 0.0
    ends_m = (part.low_m - middle_m, part.high_m - middle_m)
    return PartOf(part.kind, ends_m, 2 * part.radius_m, (2 * low, 2 * high), half_angle_rad)


def _rms(distance_m: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(distance_m)))) if len(distance_m) else 0.0

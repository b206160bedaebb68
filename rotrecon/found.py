"""What was found along the rays, and how it is told: intervals, evidence, candidates and the tool."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.axis import Axis, FittedAxis
from rotrecon.extent import Extent
from rotrecon.frame import StereoNoise
from rotrecon.intervals import radius_sigma
from rotrecon.judgement import doubts_of
from rotrecon.outcome import Evidence, Fit, PartOf, Range
from rotrecon.primitives import Primitive
from rotrecon.rays.hypotheses import Scene
from rotrecon.rays.ray_fit import RayFit
from rotrecon.rays.robust import Ranked
from rotrecon.reading import Reading
from rotrecon.recognition import candidates_of, intervals_of, is_possible, solid_of
from rotrecon.reconstruction import Cut, Reconstruction
from rotrecon.section_radii import SectionRadii
from rotrecon.soundness import Soundness
from rotrecon.tools import NoTool, propose_tool
from rotrecon.turned.parts import Part


@dataclass(frozen=True, eq=False)
class Found:
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


def reconstruction_of(segmented: Reconstruction, found: Found, radii: SectionRadii) -> Reconstruction:
    """The reconstruction with what was found: solid, intervals, evidence, sections and tool."""
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
    certain = (
        intervals.relative_width <= settings.certain_interval
        and not doubts
        and not rivals
        and chosen.shape != "revolution"
    )
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


def _reading(found: Found, one: Ranked, solid: Primitive, middle_m: float) -> Reading:
    """What the object may be, for the choice of a tool; an open end may lie anywhere beyond."""
    intervals = intervals_of(one, middle_m, None if found.extent is None else found.extent.length_interval_m)
    length_m = intervals.length_m
    if length_m is None and found.extent is not None:
        length_m = (found.extent.length_m, np.inf)
    return Reading(solid, intervals.diameter_m, length_m, intervals.half_angle_rad)


def _evidence(
    segmented: Reconstruction,
    found: Found,
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

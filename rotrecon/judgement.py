"""When a measured solid is no answer, and when it is one that nobody should rely on; with what to do about it."""

import numpy as np

from rotrecon.arrays import Bytes
from rotrecon.circles import SectionState
from rotrecon.intervals import radius_sigma
from rotrecon.outcome import DRAW_CLOSE, FailureReason, FitFailure, Intervals
from rotrecon.primitives import in_words
from rotrecon.rays.hypotheses import Scene
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.robust import Ranked
from rotrecon.rays.starts import robust_line
from rotrecon.settings import Settings
from rotrecon.soundness import Soundness
from rotrecon.two_objects import shows_two


def too_little(scene: Scene, reachable: bool, settings: Settings) -> FitFailure | None:
    """Why nothing can be fitted to a scene, before anything is."""
    sections, width_px = len(scene.ridge.points_m), 0.0
    if sections:
        width_px = float(np.median(scene.ridge.width_m / scene.ridge.points_m[:, 2])) * scene.patch.focal_px
    if not reachable:
        advice = "everything in the area is outside the arm's limits; move the arm or the limits"
        return FitFailure(FailureReason.OUT_OF_REACH, advice)
    if len(scene.segments.pixel) < settings.minimum_axis_px:
        advice = f"the axis is only {len(scene.segments.pixel)} px long; draw it along the whole object"
        return FitFailure(FailureReason.TOO_FEW_SECTIONS, advice)
    if sections < settings.minimum_axis_px or len(scene.pixels) < settings.minimum_pixels:
        advice = f"only {sections} sections and {len(scene.pixels)} pixels show an object; {DRAW_CLOSE}"
        return FitFailure(FailureReason.TOO_FEW_SECTIONS, advice)
    if width_px < settings.thinnest_px:
        advice = f"the object is only {width_px:.0f} px wide; bring the camera nearer"
        return FitFailure(FailureReason.TOO_THIN, advice)
    return None


def failure_of(chosen: Ranked, soundness: Soundness, scene: Scene, settings: Settings) -> FitFailure | None:
    """Why a fit is no result: flat, too short an arc, not along the stroke, not round, two things at once."""
    failure = _failure_of(chosen, soundness, scene, settings)
    if failure is None and soundness.pattern <= settings.doubtful_pattern:
        return None
    if failure is not None and failure.reason == FailureReason.CONSTRAINED:
        return failure
    known_m = scene.depth_m[np.isfinite(scene.depth_m)]
    if len(known_m) and shows_two(scene.depth_m, float(np.median(known_m)) / scene.patch.focal_px):
        advice = "two things stand side by side in what is drawn; draw the area round one of them"
        return FitFailure(FailureReason.TWO_OBJECTS, advice)
    return failure


def _failure_of(chosen: Ranked, soundness: Soundness, scene: Scene, settings: Settings) -> FitFailure | None:
    assert chosen.fit is not None
    surface = chosen.surface
    arc_deg = np.degrees(soundness.arc_rad)
    limits = surface.limits_m
    if limits is not None and limits[0] < limits[1] and surface.radius_m in limits:
        beyond = "smaller" if surface.radius_m == limits[0] else "larger"
        advice = f"the object is {beyond} than the diameters that were given; widen them"
        return FitFailure(FailureReason.CONSTRAINED, advice)
    unsure = radius_sigma(chosen.fit) / surface.size_m
    if unsure > settings.flat_sigma_over_radius and soundness.arc_rad >= settings.shortest_arc_rad:
        advice = f"{arc_deg:.0f} degrees of something are seen, but no one radius explains them; {DRAW_CLOSE}"
        return FitFailure(FailureReason.NOT_ROUND, advice)
    if unsure > settings.flat_sigma_over_radius or soundness.arc_rad < settings.flat_arc_rad:
        advice = f"what is drawn is flat: no radius can be told from it, {arc_deg:.0f} degrees are seen; {DRAW_CLOSE}"
        return FitFailure(FailureReason.FLAT, advice)
    if soundness.arc_rad < settings.shortest_arc_rad:
        advice = (
            f"only {arc_deg:.0f} degrees of something round are seen, too few to measure it; "
            "draw the area over its whole width, or look at it from elsewhere"
        )
        return FitFailure(FailureReason.SHORT_ARC, advice)
    if isinstance(surface, Lateral) and _off_stroke(surface, scene) > settings.most_off_stroke_rad:
        advice = "the object does not lie along the stroke; draw the axis along it, or leave it to the program"
        return FitFailure(FailureReason.OFF_AXIS, advice)
    if soundness.inlier_share < settings.least_inlier_share or soundness.roughness > settings.rms_over_radius:
        share = f"with the best {in_words(chosen.shape)} {100 * soundness.inlier_share:.0f} % of the depths agree"
        advice = f"no body of revolution explains what is drawn: {share}; {DRAW_CLOSE}"
        return FitFailure(FailureReason.NOT_ROUND, advice)
    return None


def _off_stroke(surface: Lateral, scene: Scene) -> float:
    """Angle in space between the ridge of the object along the stroke and the generator nearest to it."""
    along = robust_line(scene.ridge.points_m)[1]
    turned = float(np.arccos(np.clip(abs(along @ surface.direction), 0, 1)))
    return abs(turned - abs(float(np.arctan(surface.slope))))


def doubts_of(
    chosen: Ranked, soundness: Soundness, intervals: Intervals, state: Bytes, scene: Scene, settings: Settings
) -> tuple[str, ...]:
    """Why no tool should rely on a size."""
    doubts: list[str] = []
    low, high = intervals.diameter_m
    if high - low > settings.widest_interval * chosen.surface.size_m * 2:
        doubts.append(
            f"the diameter is known only to lie between {1000 * low:.0f} and {1000 * high:.0f} mm; "
            "bring the camera nearer, or draw more of the object"
        )
    if soundness.inlier_share < settings.doubtful_inlier_share:
        doubts.append(
            f"only {100 * soundness.inlier_share:.0f} % of the depths agree with the {in_words(chosen.shape)}; "
            "draw the area closer round one object"
        )
    if soundness.pattern > settings.doubtful_pattern:
        doubts.append(
            f"what is seen is not as round as a {in_words(chosen.shape)}, flats or edges remain; "
            "draw round one round part"
        )
    one_side, both_sides = max(soundness.goes_on), min(soundness.goes_on)
    if one_side > settings.doubtful_goes_on or both_sides > settings.doubtful_goes_on / 2:
        doubts.append("the surface goes on beside the object; draw the axis along one object that stands alone")
    if soundness.arc_rad < settings.doubtful_arc_rad:
        doubts.append(
            f"only {np.degrees(soundness.arc_rad):.0f} degrees of the surface are seen; "
            "draw the area over its whole width, or look at it from elsewhere"
        )
    if (state == SectionState.USED).mean() < settings.doubtful_circles:
        doubts.append("few sections agree; draw the axis along the object, inside the area")
    return tuple(doubts)

"""A solid of revolution from its section circles, or the reason there is none (paper 3.4, 3.5)."""

from typing import Literal

import numpy as np

from rotrecon.arrays import Cloud, Floats, blocks
from rotrecon.axis import Axis, FittedAxis, SpaceSections
from rotrecon.circles import SectionCircles, SectionState
from rotrecon.outcome import DRAW_CLOSE, Candidate, FailureReason, Fit, FitFailure
from rotrecon.primitives import Frustum, Kind, Primitive, Sphere
from rotrecon.sections.radii import RadiusFit, RankedCurve, axis_length_radius
from rotrecon.settings import Settings


def why_no_axis(circles: SectionCircles, reachable: bool, settings: Settings) -> FitFailure:
    """Why circles hold no axis; `reachable` says whether any pixel is within the arm's limits."""
    count = np.bincount(circles.state, minlength=len(SectionState))
    found, total = int(count[SectionState.USED]), len(circles.state)
    excluded, flat = int(count[SectionState.EXCLUDED]), int(count[SectionState.COLLINEAR])
    reason = FailureReason.TOO_FEW_SECTIONS
    if not reachable:
        reason = FailureReason.OUT_OF_REACH
        advice = "everything in the area is outside the arm's limits; move the arm or the limits"
    elif total < settings.minimum_axis_px:
        advice = f"the axis is only {total} px long; draw it along the whole object"
    elif excluded and found < settings.minimum_sections:
        advice = f"{excluded} of {total} sections are excluded by hand; put some of them back"
    elif found >= settings.minimum_sections:
        reason = FailureReason.NO_AXIS
        advice = f"the centres of the sections do not line up; {DRAW_CLOSE}"
    elif found + flat >= settings.minimum_sections:
        reason = FailureReason.FLAT
        advice = f"the sections are flat, nothing round stands out from its background; {DRAW_CLOSE}"
    else:
        advice = f"{found} of {total} sections have a circle, too few; {DRAW_CLOSE}"
    return FitFailure(reason, advice)


def as_candidates(ranked: tuple[RankedCurve, ...]) -> tuple[Candidate, ...]:
    """The curves as the kinds they stand for, in their order."""
    return tuple(
        Candidate(curve.radii.shape, curve.radius_m, curve.score, float(np.arctan(curve.radii.slope)))
        for curve in ranked
    )


def fit_solid(
    radii: RadiusFit,
    kind: Kind | None,
    axis: FittedAxis,
    circles: SectionCircles,
    sections: SpaceSections,
    settings: Settings,
) -> Fit | FitFailure:
    """The solid that a curve through the section radii describes, placed on the axis; refused when its pixels do not
    lie on it.

    `kind` None lets a thin cylinder be called a rod. The solid's length is that of the sections it rests on.
    """
    state = circles.state.copy()
    state[circles.used & ~radii.kept] = SectionState.ODD_RADIUS
    along = axis.along(circles.center_m)
    used = state == SectionState.USED
    solid = _solid(radii, kind, axis, along[used], sections.pitch_m, settings)
    rms_m = _rms(solid, sections.points_of(used))
    if rms_m > settings.rms_over_radius * float(solid.radius_at(0.0)):
        advice = f"the pixels lie {1000 * rms_m:.1f} mm off the best {solid.kind}; {DRAW_CLOSE}"
        return FitFailure(FailureReason.NOT_ROUND, advice)
    arc_rad = float(np.median(circles.arc_rad[used]))
    return Fit(
        solid=solid,
        section_state=state,
        along_m=along - float(axis.along(solid.center_m)),
        rms_m=rms_m,
        arc_rad=arc_rad,
        concave=bool(np.median(circles.concave[used]) > 0.5),
        doubts=_doubts(solid, rms_m, arc_rad, int(circles.used.sum()), len(state), settings),
        axis_length_radius_m=axis_length_radius(circles.center_m[axis.on_axis]) if radii.shape == "sphere" else None,
    )


def _doubts(
    solid: Primitive, rms_m: float, arc_rad: float, found: int, total: int, settings: Settings
) -> tuple[str, ...]:
    """Why a size is not to be relied on: pixels far off the solid, a short arc, or few sections with a circle."""
    doubts: list[str] = []
    radius_m = float(solid.radius_at(0.0))
    if rms_m > settings.doubtful_rms_over_radius * radius_m:
        doubts.append(
            f"doubtful: the pixels lie {1000 * rms_m:.1f} mm off a radius of {1000 * radius_m:.0f} mm; "
            "draw the area closer round the object, or bring the camera nearer"
        )
    if arc_rad < settings.doubtful_arc_rad:
        doubts.append(
            f"doubtful: only {np.degrees(arc_rad):.0f} degrees of the surface are seen; "
            "draw the area over its whole width, or look at it from elsewhere"
        )
    if found < settings.doubtful_circles * total:
        doubts.append(
            f"doubtful: only {found} of {total} sections have a circle; draw the axis along the object, inside the area"
        )
    return tuple(doubts)


def _solid(
    radii: RadiusFit, kind: Kind | None, axis: Axis, along: Floats, pitch_m: float, settings: Settings
) -> Primitive:
    """Geometry of a curve through radii at positions (n,) along the axis, of sections `pitch_m` apart."""
    if radii.shape == "sphere":
        return Sphere(axis.point_m + radii.center_m * axis.direction, axis.direction, radii.radius_m)
    low, high = float(along.min()), float(along.max())
    middle, length = (low + high) / 2, high - low + pitch_m
    radius = radii.radius_m + radii.slope * middle
    return Frustum(
        kind=_frustum_kind(radii, kind, length, 2 * radius, settings),
        center_m=axis.point_m + middle * axis.direction,
        direction=axis.direction,
        length_m=length,
        radius_m=radius,
        half_angle_rad=float(np.arctan(radii.slope)),
    )


def _frustum_kind(
    radii: RadiusFit, kind: Kind | None, length_m: float, diameter_m: float, settings: Settings
) -> Literal["cylinder", "rod", "cone"]:
    """What a straight curve is called: as asked for, else a rod when it is thin and long."""
    if radii.shape == "cone":
        return "cone"
    long = length_m >= settings.rod_length_over_diameter * diameter_m
    thin = diameter_m <= settings.rod_diameter_m
    return "rod" if kind == "rod" or (kind is None and thin and long) else "cylinder"


def _rms(solid: Primitive, points_m: Cloud) -> float:
    """Root mean square of the orthogonal distances of points (M, 3)."""
    squared = sum(float((solid.distance(block) ** 2).sum()) for block in blocks(points_m))
    return float(np.sqrt(squared / len(points_m)))

"""What a measurement ends with: a solid with its uncertainty, or a named reason why there is none."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from rotrecon.arrays import Bytes, Floats, freeze
from rotrecon.primitives import Kind, Primitive

DRAW_CLOSE = "draw the area as a polygon close round the object, and the axis along its middle"


class FailureReason(StrEnum):
    """Why nothing could be fitted."""

    OUT_OF_REACH = "out_of_reach"
    FLAT = "flat"
    TOO_FEW_SECTIONS = "too_few_sections"
    NO_AXIS = "no_axis"
    NOT_THIS_KIND = "not_this_kind"
    NOT_ROUND = "not_round"
    SHORT_ARC = "short_arc"
    TOO_THIN = "too_thin"
    TWO_OBJECTS = "two_objects"
    OFF_AXIS = "off_axis"
    CONSTRAINED = "constrained"
    UNTEXTURED = "untextured"


@dataclass(frozen=True)
class FitFailure:
    """Nothing could be fitted: why, and what the operator can do."""

    reason: FailureReason
    advice: str


Range = tuple[float, float]
"""A 95 % interval, lowest and highest."""


@dataclass(frozen=True)
class Intervals:
    """95 % intervals of a solid's numbers, in the units of the numbers themselves."""

    diameter_m: Range
    center_m: float
    """Radius of the ball round the solid's middle that holds the true one, position along an open axis left out."""
    direction_rad: float | None = None
    """Half angle of the cone round the axis that holds the true one; None for a sphere."""
    half_angle_rad: Range | None = None
    """Of a cone."""
    length_m: Range | None = None
    """None for a sphere, or where an end is open."""

    @property
    def relative_width(self) -> float:
        """Width of the diameter's interval over its middle."""
        low_m, high_m = self.diameter_m
        return 2 * (high_m - low_m) / (high_m + low_m)


@dataclass(frozen=True)
class Candidate:
    """A kind that was considered."""

    kind: Kind
    radius_m: float
    """At the middle of its length."""
    score: float
    """Share of belief from 0 to 1; those of all candidates add up to 1."""
    half_angle_rad: float = 0.0
    """Of a cone."""
    diameter_m: Range | None = None
    possible: bool | None = None
    """Whether the object may be of this kind; None by the paper's method, which cannot tell."""


@dataclass(frozen=True)
class PartOf:
    """One of the consecutive pieces that an object falls into along its axis."""

    kind: Literal["cylinder", "cone", "sphere"]
    ends_m: Range
    """Positions along the axis, from the solid's middle."""
    diameter_m: float
    """Of a sphere its own, of others that at the middle of their length."""
    diameter_interval_m: Range
    half_angle_rad: float = 0.0


@dataclass(frozen=True, eq=False)
class Evidence:
    """What a fit by the robust method rests on."""

    certain: bool
    """No other kind is possible, and nothing speaks against the solid."""
    margin: float
    """By how much the kind's score is above that of the next."""
    inlier_share: float
    """Of the known depths inside its outline, those that agree with the solid."""
    sigma_over_radius: float
    """Standard error of the radius over the radius."""
    noise_m: float
    """Standard deviation of depth at the object."""
    noise_px: float | None
    """The same in disparity; None where the baseline is not known."""
    correlation_px: float
    """How far its errors are alike."""
    noise_stated: bool
    """By the scene; else estimated."""
    depth_weight: float
    """Information of one pixel's depth, for errors that are alike less than one, over that of the stated noise."""
    outline_weight: float
    """Information, 1 / px^2, of all that is seen of the outline; 0 where it has no say."""
    doubt_share: float
    """Of the variance of the radius: what other ways to it differ by, rather than noise."""
    open_ends: tuple[bool, bool] | None
    """Whether it goes on beyond the area at its start and its end along the stroke; None for a sphere."""
    parts: tuple[PartOf, ...]
    """More than one where the radius along the axis is not that of one solid; none of a sphere."""
    radius_low_m: Floats
    """(S,) lower limits of the radii of the sections, NaN where there is none."""
    radius_high_m: Floats

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class Fit:
    """A solid in camera coordinates, and how well the sections it rests on agree with it."""

    solid: Primitive
    section_state: Bytes
    """(S,) SectionState of every section of the second cut."""
    along_m: Floats
    """(S,) positions of the section centres along the solid's direction, from its middle."""
    rms_m: float
    """Orthogonal, over the pixels of the used sections."""
    arc_rad: float
    """Median visible arc of the used sections."""
    concave: bool
    """The surface is seen from inside."""
    doubts: tuple[str, ...] = ()
    """Why no tool should rely on this size, and what to draw instead."""
    axis_length_radius_m: float | None = None
    """Of a sphere: the radius by equation (16), the paper's second variant."""
    intervals: Intervals | None = None
    """None by the paper's method, which has no measure of them."""
    evidence: Evidence | None = None
    """The same."""

    def __post_init__(self) -> None:
        freeze(self)

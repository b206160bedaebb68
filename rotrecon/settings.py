"""Every threshold of the program, with its unit and the reason for its value."""

from dataclasses import dataclass, field
from typing import Literal

from rotrecon.primitives import Kind
from rotrecon.tool_table import ToolTable, default_tools

Method = Literal["robust", "paper"]


@dataclass(frozen=True)
class Settings:
    """What a result depends on besides the frame and the drawing."""

    method: Method = "robust"
    layers: int = 2
    """Objects that overlap in depth inside the area: steps 1 to 3 of paper 3.2 run one time fewer."""
    sigma_factor: float = 3.0
    """Standard deviations a pixel may lie from its section's mean, or from its neighbour: paper (3), (4), (5)."""
    line_density: float = 0.3
    """T_d of paper (6): smallest share of segmented pixels among a longitudinal line's pixels with depth."""
    line_coverage: float = 1.01
    """T_de of paper (6): above 1, the share of pixels with depth never saves a line (see ERRATA of the paper)."""
    minimum_section_pixels: int = 5
    """Fewer pixels do not make an arc whose middle and ends are different things."""
    minimum_bulge: float = 0.02
    """Height of a section's arc over its chord below which three points are called collinear; a 9 degree arc."""
    minimum_sections: int = 4
    """A line, a cone or a sphere through fewer circles would be held by nothing."""
    distance_floor_m: float = 5e-6
    """Deviations below this are rounding, not error: without it exact data would lose every centre."""
    cuts_in_space: int = 4
    """At most so many cuts across the axis in space; all but axes that run into the picture settle in one or two."""
    axis_settled_rad: float = 0.02
    """A turn of the axis below this changes the radius by less than 0.02 %."""
    minimum_axis_px: int = 10
    """A shorter stroke is a slip of the hand, or too short to hold a direction."""
    doubtful_rms_over_radius: float = 0.12
    """Above this the size was seen to be off by a third and more on simulated stereo: no tool is named."""
    doubtful_circles: float = 0.5
    """Below this share of sections with a circle, most of what was drawn is not the object: no tool is named."""
    doubtful_arc_rad: float = 0.7
    """Below this (40 degrees) a tenth of noise on the arc's height is a tenth of the radius: no tool is named."""
    rms_over_radius: float = 0.3
    """Pixels that lie farther off a solid than this share of its radius do not lie on it."""
    rod_length_over_diameter: float = 8.0
    """A cylinder at least this long for its diameter, and thin, is a rod (paper table 1: extended, thin)."""
    rod_diameter_m: float = 0.030
    """Thickest rod: between the paper's wire (25 mm) and its chair leg (36 mm)."""
    cone_half_angle_rad: float = 0.05
    """Less taper (3 degrees) is called a cylinder."""
    sphere_span: float = 0.5
    """Share of the diameter that the sections of a sphere must cover: less is a cylinder that bulges."""
    kind_deviation: float = 2.0
    """A kind that is asked for may deviate so many times more from the sections than the most credible one."""
    correlated_sections: float = 8.0
    """Neighbouring sections that err together: errors of matched depth are correlated over 5 to 12 px."""
    minimum_pixels: int = 60
    """Fewer segmented pixels do not hold a surface."""
    thinnest_px: float = 5.0
    """Narrower objects have no pixel whose depth is that of their surface alone."""
    flat_sigma_over_radius: float = 0.35
    """Standard error of the radius over the radius above which nothing says that the surface is round at all."""
    flat_arc_rad: float = 0.35
    """Arcs of less than 20 degrees look flat."""
    shortest_arc_rad: float = 0.6
    """Arcs of less than 35 degrees hold no radius that could be relied on."""
    most_off_stroke_rad: float = 0.35
    """A surface whose generator is that far (20 degrees) off the object's ridge is not that of the object meant."""
    least_inlier_share: float = 0.5
    """Of the depths inside the outline: fewer that agree make no object."""
    doubtful_inlier_share: float = 0.75
    doubtful_goes_on: float = 0.8
    """Share of one side's outline beyond which the surface goes on, or half of it on both: a handle is less."""
    doubtful_pattern: float = 0.045
    """Residual that follows the angle, over the radius: real round things have 0.02, six-sided bars 0.053 and more."""
    widest_interval: float = 0.35
    """Width of the interval of the diameter over the diameter: more is no size."""
    certain_interval: float = 0.25
    """The same for a kind that is certain: what is known so badly may be something else."""
    covered_length: float = 0.7
    """Share of the object's length that a cylinder or a cone must explain not to be a part of something longer."""
    turned_sigma: float = 0.6
    """Residuals of a general surface of revolution over those of a cylinder or cone that it takes the place of: 0.2 for
    a vase, 0.7 for a bowl whose wall bends a little."""
    turned_inlier_share: float = 0.85
    """Of the depths inside the outline, those that must agree with a general surface of revolution."""
    excluded_cost: float = 4.6
    """Half the information criterion by which a kind must be worse to be excluded: a hundred times less credible."""
    tapers_cost: float = 15.0
    """The same for a cylinder beside a cone that hardly tapers, before it is called a cone."""
    asked_cost: float = 25.0
    """The same for a kind that was asked for: worse than this, the depths speak against it."""
    tools: ToolTable = field(default_factory=default_tools)
    dangerous: frozenset[Kind] = frozenset()
    """Classes marked dangerous: to them may be put only what the tool table says may be."""

"""Everything that one reconstruction found on its way."""

from dataclasses import dataclass

from rotrecon.axis import FittedAxis, SpaceSections
from rotrecon.circles import SectionCircles
from rotrecon.drawing import CrossSegments, Drawing
from rotrecon.frame import Frame
from rotrecon.outcome import Candidate, Fit, FitFailure
from rotrecon.primitives import Primitive
from rotrecon.reading import Reading
from rotrecon.segmentation import Segmentation
from rotrecon.settings import Settings
from rotrecon.tools import NoTool, ToolProposal


@dataclass(frozen=True, eq=False)
class Cut:
    """The circles of one cut through the object, and the axis through their centres."""

    circles: SectionCircles
    axis: FittedAxis | None


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """Every intermediate of one reconstruction, so that whatever is shown computes nothing again.

    Camera coordinates, but for `solid` and `tool`. A stage that was not reached is None.
    """

    frame: Frame
    drawing: Drawing
    settings: Settings
    segments: CrossSegments
    segmentation: Segmentation
    first_cut: Cut
    """Through lines of pixels, as drawn (paper 3.1)."""
    fit: Fit | FitFailure
    sections: SpaceSections | None = None
    """The same pixels, sorted into sections perpendicular to the first axis in space."""
    second_cut: Cut | None = None
    candidates: tuple[Candidate, ...] = ()
    first_cut_radius_m: float | None = None
    """The radius that the first cut alone gives for the same kind of solid."""
    solid: Primitive | None = None
    """The fitted solid in base coordinates."""
    tool: ToolProposal | NoTool = NoTool(())
    readings: tuple[Reading, ...] = ()
    """What the object may be, in base coordinates, the chosen reading first: what the tool was chosen for."""

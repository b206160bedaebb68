"""What the robot's controller is told: the decision as it stands, bound to its evidence."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Literal, Protocol

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.outcome import Fit, Range
from rotrecon.primitives import Kind, Primitive, Sphere, basis_across
from rotrecon.reconstruction import Reconstruction
from rotrecon.tools import NoTool

DecisionState = Literal["idle", "proposed", "armed", "confirmed", "rejected", "overridden"]
"""Only `confirmed` and `overridden` may be acted on, and only until `valid_until`."""
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Decision:
    """What was decided of one object, in base coordinates; what is not known is None."""

    state: DecisionState = "idle"
    digest: str | None = None
    """Of frame, calibration, drawing, settings, tool table and result: any change of them is another decision."""
    tool: str | None = None
    kind: Kind | None = None
    """The object's class."""
    diameter_m: float | None = None
    """At the middle of its length."""
    diameter_interval_m: Range | None = None
    """95 %, (lowest, highest)."""
    T_base_contact: Floats | None = None
    """(4, 4) rigid, see `contact_pose`."""
    axis_point_m: Floats | None = None
    """(3,) the middle of the object's axis, or of the ball."""
    axis_direction: Floats | None = None
    """(3,) unit; None for a ball."""
    reasons: tuple[str, ...] = ()
    """Why there is no tool, or why one before it in the table is not sure."""
    valid_until: datetime | None = None
    """When a decision that may be acted on ends; of a time zone."""
    who: str | None = None
    """The authenticated name of the operator who decided."""

    def __post_init__(self) -> None:
        freeze(self)


class DecisionSource(Protocol):
    """Who knows the decision; called from any thread."""

    def decision(self) -> Decision:
        """The decision as it is now."""
        ...

    def subscribe(self, changed: Callable[[], object]) -> Callable[[], object]:
        """Call `changed`, quickly done, whenever the decision may be another one; returns what ends that."""
        ...


def proposal(result: Reconstruction | None, digest: str | None) -> Decision:
    """The decision when nobody has decided yet: proposed where the result names a tool, else idle."""
    if result is None or result.solid is None or not isinstance(result.fit, Fit):
        return Decision()
    solid, intervals = result.solid, result.fit.intervals
    measured = Decision(
        digest=digest,
        kind=solid.kind,
        diameter_m=2 * float(solid.radius_at(0.0)),
        diameter_interval_m=None if intervals is None else intervals.diameter_m,
        axis_point_m=solid.center_m,
        axis_direction=None if isinstance(solid, Sphere) else solid.direction,
        reasons=result.tool.reasons if isinstance(result.tool, NoTool) else result.tool.unsure,
    )
    if isinstance(result.tool, NoTool):
        return measured
    pose = contact_pose(solid, result.tool.contact_point_m, result.tool.approach)
    return replace(measured, state="proposed", tool=result.tool.tool.name, T_base_contact=pose)


def contact_pose(solid: Primitive, contact_m: Floats, approach: Floats) -> Floats:
    """Pose (4, 4) of the tool when it touches, in base coordinates.

    Origin at the contact point (3,), z the unit approach (3,), y along the object's axis (up for a ball) as far as it
    is square to z, x across the object: the way jaws close.
    """
    pose = np.eye(4)
    x, y = basis_across(approach, UP if isinstance(solid, Sphere) else solid.direction)
    pose[:3, :3] = np.stack([x, y, approach], axis=1)
    pose[:3, 3] = contact_m
    return pose

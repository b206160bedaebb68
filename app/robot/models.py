"""What goes over the wire, and what the OpenAPI description says of it."""

from datetime import datetime
from math import isfinite
from typing import Literal

from pydantic import BaseModel, ConfigDict

from app.decision import Decision, DecisionState
from rotrecon.arrays import Floats
from rotrecon.primitives import Kind

Vector = tuple[float, float, float]
Row = tuple[float, float, float, float]
Pose = tuple[Row, Row, Row, Row]


class Model(BaseModel):
    """Frozen, and described by the docstrings of its members."""

    model_config = ConfigDict(use_attribute_docstrings=True, frozen=True)


class Axis(Model):
    """The object's axis."""

    point_m: Vector
    """The middle of the object, m."""
    direction: Vector | None
    """Unit vector; null for a ball, which has none."""


class DecisionModel(Model):
    """The decision as it stands. Act on it only while `state` is `confirmed` or `overridden` and before
    `valid_until`, by a clock that agrees with the server's; ask again right before the contact."""

    state: DecisionState
    """`proposed` and `armed` are not decided yet; `idle`: nothing is proposed."""
    digest: str | None
    """Of all that the decision rests on: another digest is another decision."""
    tool: str | None
    """Name of the tool of the tool table."""
    kind: Kind | None
    """Class of the object."""
    diameter_m: float | None
    """At the middle of its length, m."""
    diameter_interval_m: tuple[float, float] | None
    """95 %: lowest and highest, m."""
    contact_pose: Pose | None
    """T_base_contact, 4x4, rows first, m: maps coordinates of the tool at contact to those of the base. Its origin is
    the contact point, z the approach, y along the object's axis, x across the object, the way jaws close."""
    approach: Vector | None
    """Unit vector in which the tool moves to the contact point."""
    axis: Axis | None
    frame: Literal["base"]
    """Coordinates that all of this is in: the robot's base."""
    reasons: tuple[str, ...]
    """Why there is no tool, or why one before it in the table is not sure."""
    valid_until: datetime | None
    """When this ends to be valid; null while nothing is decided."""
    who: str | None
    """The operator who decided."""


class FrameHealth(Model):
    """A frame, and how old it is."""

    name: str
    captured_at: datetime | None
    """Null where the recording does not say."""
    age_s: float | None


class OfferHealth(Model):
    """The newest capture that was pushed in."""

    name: str
    who: str
    arrived_at: datetime


class Health(Model):
    """Whether the console works, and what it has refused."""

    status: Literal["ok"]
    version: str
    state: DecisionState
    pages: int
    """Open pages."""
    refused: dict[str, int]
    """Messages and connections that the door has refused since the start, by reason."""
    frame: FrameHealth
    offered: OfferHealth | None


class Taken(Model):
    """What was pushed in has arrived whole and can be read."""

    name: str
    views: int
    """0 for a frame with depth."""
    notes: tuple[str, ...]
    arrived_at: datetime


class Problem(Model):
    """What is wrong, and what to do."""

    detail: str


def decision_model(decision: Decision) -> DecisionModel:
    """A decision as it goes over the wire."""
    pose, point, interval = decision.T_base_contact, decision.axis_point_m, decision.diameter_interval_m
    return DecisionModel(
        state=decision.state,
        digest=decision.digest,
        tool=decision.tool,
        kind=decision.kind,
        diameter_m=decision.diameter_m,
        diameter_interval_m=interval if interval is not None and all(map(isfinite, interval)) else None,
        contact_pose=None if pose is None else _pose(pose),
        approach=None if pose is None else _vector(pose[:3, 2]),
        axis=None if point is None else Axis(point_m=_vector(point), direction=_direction(decision)),
        frame="base",
        reasons=decision.reasons,
        valid_until=decision.valid_until,
        who=decision.who,
    )


def _direction(decision: Decision) -> Vector | None:
    return None if decision.axis_direction is None else _vector(decision.axis_direction)


def _pose(pose: Floats) -> Pose:
    first, second, third, last = ((a, b, c, d) for a, b, c, d in pose.tolist())
    return (first, second, third, last)


def _vector(values: Floats) -> Vector:
    x, y, z = values.tolist()
    return (x, y, z)

"""One tool at one place of a measured object, checked: room, reach, and what of the cloud it would hit."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Bools, Floats, Indices, freeze
from rotrecon.camera import inverse, rotate, transform
from rotrecon.clearance import Clearance, clearances
from rotrecon.contact import Contact, Place, contact_on, within
from rotrecon.envelope import STANDOFF_M, Box, Envelope, envelope_of
from rotrecon.frame import Frame
from rotrecon.outcome import Fit
from rotrecon.reading import diameter_mm
from rotrecon.reconstruction import Reconstruction
from rotrecon.tool_table import Tool
from rotrecon.tools import ToolProposal
from rotrecon.workspace import out_of_reach

OWN_SHARE = 0.08
"""Of its radius, within which a point of the cloud is the object's own: real objects are not that round."""
OWN_SIGMA = 4.0
"""Standard deviations of its depth, alike."""
ROUNDING_M = 1e-3
"""More than float32 rounds the place of anything that an arm could reach."""
SMEAR_PX = 4
"""Pixels beyond those of its sections that matching smears with the object: half a window."""


@dataclass(frozen=True, eq=False)
class Hits:
    """Points of the frame's cloud in a part of the envelope that are not the object's."""

    pixel: Indices
    """(n,) index into the flattened frame."""
    nearest_m: float | None
    """From the object's surface, its ends not bounded; None without points."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class Grasp:
    """A tool at a place, and what was found there; base coordinates."""

    tool: Tool
    place: Place
    contact: Contact
    envelope: Envelope
    clearance: Clearance
    at_contact: Hits
    """In the jaws, the mouth and the body."""
    on_way: Hits
    """In what they sweep before they are there, and not above."""
    unreachable: tuple[str, ...]
    """What of contact and approach the arm does not reach: a sentence each."""


def grasp_of(result: Reconstruction, tool: Tool, place: Place | None = None) -> Grasp | None:
    """A tool of the table at a place of the measured solid, by default that of the drawing.

    None where nothing was measured that has a reading.
    """
    fit, solid = result.fit, result.solid
    if not isinstance(fit, Fit) or solid is None or not result.readings:
        return None
    place = within(result.drawing.contact if place is None else place, solid)
    contact, envelope = envelope_at(result, tool, place)
    (clearance,) = clearances(result.readings, contact.point_m, fit.concave, (tool,), result.settings.dangerous)
    at_contact, on_way = _hits(result, fit, envelope)
    return Grasp(tool, place, contact, envelope, clearance, at_contact, on_way, unreachable(result, contact, envelope))


def envelope_at(result: Reconstruction, tool: Tool, place: Place) -> tuple[Contact, Envelope]:
    """The contact at a place of the measured solid, and the space that a tool takes there.

    Raises ValueError where nothing was measured that has a reading.
    """
    solid = result.solid
    if solid is None or not result.readings:
        raise ValueError("there is no solid to put a tool to")
    contact = contact_on(solid, result.frame.T_base_camera[:3, 3], place)
    # as much thicker as the middle may be, it may be here
    more_m = diameter_mm(result.readings[0])[1] / 1000 - 2 * float(solid.radius_at(0.0))
    diameter_m = 2 * float(solid.radius_at(place.along_m)) + max(more_m, 0.0)
    return contact, envelope_of(tool, solid, contact, diameter_m)


def shown_tool(result: Reconstruction) -> Tool | None:
    """The tool that is proposed, else the first that is not ruled out, else none."""
    if isinstance(result.tool, ToolProposal):
        return result.tool.tool
    may = [one.tool for one in clearances_of(result) if one.verdict != "ruled out"]
    return may[0] if may else None


def clearances_of(result: Reconstruction) -> tuple[Clearance, ...]:
    """Every tool of the table at the drawing's contact; none where nothing was measured."""
    fit, solid = result.fit, result.solid
    if not isinstance(fit, Fit) or solid is None or not result.readings:
        return ()
    contact = contact_on(solid, result.frame.T_base_camera[:3, 3], result.drawing.contact)
    return clearances(result.readings, contact.point_m, fit.concave, result.settings.tools, result.settings.dangerous)


def strange(result: Reconstruction, fit: Fit, among: Bools | None = None) -> Bools:
    """Which points (H W,) of the frame's cloud are not the object's: nor on its surface, nor beside its pixels.

    The pixels of its sections, that is: what was merely segmented with it may be the table it stands on. Of all points
    with depth, or of those `among` them only.
    """
    frame = result.frame
    points_m = frame.points_m.reshape(-1, 3)
    known = np.isfinite(points_m[:, 2]) if among is None else among.copy()
    own = np.zeros(frame.depth_m.shape, dtype=np.uint8)
    if result.sections is not None:
        own.ravel()[result.sections.pixel] = 1
    side = 2 * SMEAR_PX + 1
    own = np.asarray(cv2.dilate(own, np.ones((side, side), dtype=np.uint8))) > 0
    known &= ~own.ravel()
    pixel = np.flatnonzero(known)
    noise_m = 0.0 if fit.evidence is None else fit.evidence.noise_m
    margin_m = max(OWN_SHARE * float(fit.solid.radius_at(0.0)), OWN_SIGMA * noise_m)
    offset_m = points_m[pixel].astype(np.float64)
    along = (offset_m - fit.solid.center_m) @ fit.solid.direction
    low, high = _own_ends(fit, margin_m)
    beside = (along > low) & (along < high)
    known[pixel] = ~(beside & (fit.solid.distance(offset_m) <= margin_m))
    return known


def _own_ends(fit: Fit, margin_m: float) -> tuple[float, float]:
    """Between which distances along the axis a point may be the object's: an open end goes on, a closed one is off."""
    low, high = fit.solid.ends
    length_m = None if fit.intervals is None else fit.intervals.length_m
    off_m = margin_m if length_m is None else max(margin_m, (length_m[1] - length_m[0]) / 2)
    open_ends = (fit.evidence and fit.evidence.open_ends) or (False, False)
    return -np.inf if open_ends[0] else low - off_m, np.inf if open_ends[1] else high + off_m


def _hits(result: Reconstruction, fit: Fit, envelope: Envelope) -> tuple[Hits, Hits]:
    """What is in the tool at its place, and only in what it sweeps before."""
    frame = result.frame
    pixel, in_base = points_in(envelope.way, frame)
    among = np.zeros(frame.depth_m.size, dtype=np.bool_)
    among[pixel] = True
    foreign = strange(result, fit, among)[pixel]
    pixel, in_base = pixel[foreign], in_base[foreign]
    there = _in_any((envelope.mouth, *envelope.solid), in_base)
    solid = fit.solid.moved(frame.T_base_camera)

    def hits(which: Bools) -> Hits:
        nearest_m = max(float(solid.distance(in_base[which]).min()), 0.0) if which.any() else None
        return Hits(pixel[which].astype(np.int32), nearest_m)

    return hits(there), hits(~there)


def points_in(box: Box, frame: Frame) -> tuple[NDArray[np.intp], Floats]:
    """Index (n,) into the flattened frame, and place (n, 3) in base coordinates, of the points in a box.

    Between its two sides that are nearest to each other there are few: only those are looked at closely.
    """
    T, thin = inverse(frame.T_base_camera), int(np.argmin(box.half_m))
    across, points_m = rotate(T, box.turn[thin]), frame.points_m.reshape(-1, 3)
    middle_m = float(transform(T, box.center_m) @ across)
    off_m = np.abs(points_m @ across.astype(np.float32) - np.float32(middle_m))
    pixel = np.flatnonzero(off_m <= box.half_m[thin] + ROUNDING_M)
    in_base = transform(frame.T_base_camera, points_m[pixel])
    held = box.holds(in_base)
    return pixel[held], in_base[held]


def _in_any(boxes: tuple[Box, ...], points_m: Floats) -> Bools:
    return np.any([box.holds(points_m) for box in boxes], axis=0)


def unreachable(result: Reconstruction, contact: Contact, envelope: Envelope) -> tuple[str, ...]:
    """The arm's limits for the contact and for where the last part of the way begins."""
    places = {
        "the contact is": contact.point_m,
        f"the approach, {1000 * STANDOFF_M:.0f} mm before it, begins": envelope.start_m,
    }
    found = {name: out_of_reach(point_m, result.frame.workspace) for name, point_m in places.items()}
    return tuple(f"{name} {why}" for name, why in found.items() if why is not None)

"""Where along the axis a tool is free, when it is not where it would touch."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.contact import Place, limits_of
from rotrecon.envelope import Box, Envelope
from rotrecon.grasp import envelope_at, grasp_of, points_in, strange, unreachable
from rotrecon.outcome import Fit
from rotrecon.reconstruction import Reconstruction
from rotrecon.tool_table import Tool
from rotrecon.tools import judge

STEP_M = 0.005
"""Between the places that are looked at: a sixth of the breadth of a blade."""


def nearest_free(result: Reconstruction, tool: Tool) -> Place | None:
    """The place nearest to the drawing's contact, along the axis and from the same side, where a tool fits and is free.

    Free is what `grasp_of` finds nothing against: no point of the cloud that is not the object's in the envelope, there
    or on the last part of the way, and both within the arm's reach. None where no place is, or nothing was measured.
    """
    now, fit = grasp_of(result, tool), result.fit
    if now is None or not isinstance(fit, Fit) or result.solid is None:
        return None
    most_m = limits_of(result.solid).along_m
    steps = STEP_M * np.arange(1, int(2 * most_m / STEP_M) + 1)
    along_m = now.place.along_m + np.stack([steps, -steps], axis=1).ravel()
    places = [Place(now.place.angle_rad, float(along)) for along in along_m if abs(along) <= most_m]
    at = [(place, *envelope_at(result, tool, place)) for place in places]
    in_the_way = _strange_in(result, fit, [envelope for _, _, envelope in at])
    for place, contact, envelope in at:
        if (
            not envelope.way.holds(in_the_way).any()
            and not unreachable(result, contact, envelope)
            and judge(tool, result.readings, contact.point_m, result.settings.dangerous).fits
        ):
            return place
    return None


def _strange_in(result: Reconstruction, fit: Fit, envelopes: list[Envelope]) -> Floats:
    """The points (n, 3), base coordinates, that are not the object's, of a box round all ways."""
    if not envelopes:
        return np.zeros((0, 3))
    turn = envelopes[0].way.turn  # which all share but that of a ball met along the line of sight
    corners = np.concatenate([envelope.way.corners_m for envelope in envelopes]) @ turn.T
    low, high = corners.min(axis=0), corners.max(axis=0)
    pixel, in_base = points_in(Box(turn, (low + high) / 2 @ turn, (high - low) / 2), result.frame)
    among = np.zeros(result.frame.depth_m.size, dtype=np.bool_)
    among[pixel] = True
    return in_base[strange(result, fit, among)[pixel]]

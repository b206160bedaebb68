"""Whether texture speaks against where outlines hold a surface: the edge of something near may have drawn it there."""

from collections.abc import Sequence

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.photometry.matches import Match
from rotrecon.rays.losses import tukey
from rotrecon.rays.surfaces import Surface

CONTESTED = 10.0
"""Half a likelihood's logarithm. Twice it is over chi-square's 99.7 % for the six parameters of a cone; of surfaces on
their own edges the most that was seen is 3.7, and 35 of one that another edge holds."""
TOLD = 1e-8
"""Share of the largest eigenvalue below which texture tells nothing of a direction."""


def contest(surface: Surface, matches: Sequence[Match], free: Bools, units: Floats) -> float:
    """By how much texture alone would rather have a surface elsewhere, in half a likelihood's logarithm.

    Half the squared Newton decrement of the brightness of all matches (Boyd and Vandenberghe 2004, 9.5.1) over the
    `free` (k,) parameters, in `units` (k,).
    """
    count = len(free)
    gradient, information = np.zeros(count), np.zeros((count, count))
    for match in matches:
        prediction, (sigma, share) = match.agreement.predict(surface), match.weighting
        residual, columns = prediction.residual / sigma, prediction.columns * units[:, None] / sigma
        weighted = share * columns * tukey(residual)[1]
        gradient += weighted @ residual
        information += weighted @ columns.T
    inverse = np.linalg.pinv(information[np.ix_(free, free)], rcond=TOLD, hermitian=True)
    return float(gradient[free] @ inverse @ gradient[free]) / 2

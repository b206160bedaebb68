"""What residuals cost, how much they weigh, and how large most of them are."""

from collections.abc import Callable

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.compiled import VECTOR, compiled

TUKEY = 4.685
"""Residuals beyond so many sigma count for nothing; at this value 95 % of the efficiency of least squares is kept
(Beaton and Tukey 1974)."""
CAUCHY = 2.385
"""The same for the heavy-tailed loss that comes first, whose pull never ends (Holland and Welsch 1977)."""
TO_SIGMA = 1.4826
"""Standard deviation over median magnitude, for normal errors."""
MEDIAN_LOSS = 1.2533
"""Standard deviation of a median over that of a mean."""

Loss = Callable[[Floats], tuple[Floats, Floats]]
"""Cost (N,) and weight (N,) of residuals (N,) in sigmas."""


@compiled(VECTOR)
def cauchy(residual: Floats) -> tuple[Floats, Floats]:
    """Heavy-tailed: no start is too far."""
    cost, weight = np.empty(len(residual)), np.empty(len(residual))
    for i in range(len(residual)):
        squared = (residual[i] / CAUCHY) ** 2
        cost[i], weight[i] = CAUCHY**2 / 2 * np.log1p(squared), 1.0 / (1.0 + squared)
    return cost, weight


@compiled(VECTOR)
def tukey(residual: Floats) -> tuple[Floats, Floats]:
    """Redescending: what is far off has no say."""
    cost, weight = np.empty(len(residual)), np.empty(len(residual))
    for i in range(len(residual)):
        inside = max(1.0 - (residual[i] / TUKEY) ** 2, 0.0)
        cost[i], weight[i] = TUKEY**2 / 6 * (1.0 - inside**3), inside**2
    return cost, weight


@compiled(VECTOR)
def robust_scale(residual: Floats) -> float:
    """Sigma of residuals (N,), most of which are noise: the median magnitude, then the spread of what it keeps.

    Of the residuals within 3 sigma a normal distribution keeps 98.7 % of its standard deviation.
    """
    sigma = TO_SIGMA * np.median(np.abs(residual))
    for _ in range(3):
        total, count = 0.0, 0
        for value in residual:
            if abs(value) < 3 * sigma:
                total += value * value
                count += 1
        if count == 0:
            break
        sigma = np.sqrt(total / count) / 0.9866
    return sigma

"""What every run of heights costs as one part, and which runs together cost least: loops over pairs of heights."""

import numpy as np
from numpy.typing import NDArray

from rotrecon.arrays import Floats
from rotrecon.compiled import COUNT, FLAG, FLOAT, MATRIX, VECTOR, compiled


@compiled(VECTOR)
def _totals(values: Floats) -> Floats:
    """(n + 1,) sums of the values (n,) before each."""
    return np.concatenate((np.zeros(1), np.cumsum(values)))


@compiled(VECTOR, VECTOR, VECTOR, FLOAT, FLAG, COUNT)
def line_misfits(x: Floats, y: Floats, weight: Floats, lean: float, is_circle: bool, fewest: int) -> Floats:
    """(n + 1, n + 1) least weighted squares of y (n,) about lines over x (n,), from the first of a run to before its
    last; infinite for those of fewer than so many.

    A slope is free, or with a finite standard deviation `lean` as unlikely as that makes it. Of a circle y is the sum
    of the squares of x and its ordinate, which must be positive all along the run.
    """
    count = len(x)
    found = np.full((count + 1, count + 1), np.inf)
    s0, sx, sy = _totals(weight), _totals(weight * x), _totals(weight * y)
    sxx, sxy, syy = _totals(weight * (x * x)), _totals(weight * (x * y)), _totals(weight * (y * y))
    for first in range(count):
        for last in range(first + fewest, count + 1):
            of, along, across = s0[last] - s0[first], sx[last] - sx[first], sy[last] - sy[first]
            mixed = sxy[last] - sxy[first] - along * across / of
            spread = sxx[last] - sxx[first] - along**2 / of
            free = 1.0 / spread if np.isinf(lean) else lean**2 / (1.0 + lean**2 * spread)
            misfit = syy[last] - syy[first] - across**2 / of - free * mixed**2
            if is_circle:
                slope = mixed / spread
                level = (across - slope * along) / of
                low, high = x[first], x[last - 1]
                if not (slope * low + level - low**2 > 0 and slope * high + level - high**2 > 0):
                    continue
            found[first, last] = max(misfit, 0.0)
    return found


@compiled(MATRIX, FLOAT, FLOAT, COUNT)
def cheapest_runs(
    cost: Floats, price: float, skip: float, most: int
) -> tuple[Floats, NDArray[np.int64], NDArray[np.int64]]:
    """Costs (n + 1,) of the cheapest runs up to every height; where the last of these begins, and is told to begin.

    A run, first and one past the last, costs what `cost` (n + 1, n + 1) says, each but the first has a price besides.
    At most so many heights before a run may be left out for `skip` each.
    """
    count = len(cost)
    best = np.full(count, np.inf)
    before, first = np.zeros(count, np.int64), np.zeros(count, np.int64)
    best[0] = 0.0
    for last in range(1, count):
        for left in range(last):
            for skipped in range(min(most, count - 1 - left) + 1):
                total = best[left] + (cost[left + skipped, last] + skipped * skip) + (price if left > 0 else 0.0)
                if total < best[last]:
                    best[last], before[last], first[last] = total, left, left + skipped
    return best, before, first

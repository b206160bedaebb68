"""What an object may be, and between which limits its sizes lie."""

from dataclasses import dataclass
from math import inf

from rotrecon.outcome import Range
from rotrecon.primitives import Primitive, Revolution


@dataclass(frozen=True, eq=False)
class Reading:
    """One thing that the object may be, and between which limits; base coordinates.

    An interval is (lowest, highest); where it is None, no interval is known and the solid's own number counts. A rod
    and a cylinder are one solid under two names: give it once, under the name it goes by.
    """

    solid: Primitive
    diameter_m: Range | None = None
    """At the middle of its length."""
    length_m: Range | None = None
    """Where an end is open, the highest is inf."""
    half_angle_rad: Range | None = None
    """Of a cone."""

    def __post_init__(self) -> None:
        for interval in (self.diameter_m, self.length_m, self.half_angle_rad):
            if interval is not None and not interval[0] <= interval[1]:
                raise ValueError(f"{interval} is not an interval: give (lowest, highest)")


def diameter_mm(reading: Reading) -> Range:
    """Lowest and highest diameter in the middle."""
    low, high = reading.diameter_m or (2 * float(reading.solid.radius_at(0.0)),) * 2
    return 1000 * low, 1000 * high


def widest_mm(reading: Reading) -> Range:
    """Of a general solid of revolution where it is widest, off by as much as in the middle; of others in the middle."""
    low, high = diameter_mm(reading)
    solid = reading.solid
    more = 2000 * (float(solid.radii_m.max()) - solid.radius_m) if isinstance(solid, Revolution) else 0.0
    return low + more, high + more


def length_over_diameter(reading: Reading) -> Range:
    """Between which limits it is, whatever diameter goes with which length; 1 for a sphere.

    The diameter is the widest: what is asked for is an object long enough to be held across its axis, and the part
    where that is least true decides.
    """
    low, high = reading.solid.ends
    if reading.solid.kind == "sphere":
        return 1.0, 1.0
    thin_mm, thick_mm = widest_mm(reading)
    short_m, long_m = reading.length_m or (high - low,) * 2
    return 1000 * short_m / thick_mm if thick_mm > 0 else inf, 1000 * long_m / thin_mm if thin_mm > 0 else inf

"""A surface fitted to the depths that can be believed and to its outline, and how much either doubts the other."""

import numpy as np

from rotrecon.arrays import Floats
from rotrecon.rays.doubting import doubting, doubting_outline
from rotrecon.rays.fitting import Outlines
from rotrecon.rays.guard import INNER_GUARD, WINDOW_OVER_CORRELATION, Task, settle
from rotrecon.rays.hypotheses import Held, Scene
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.ray_fit import RayFit, Sight, fine
from rotrecon.rays.surfaces import Surface

CONTRADICTED, CONTRADICTION_DOUBT = 3.0, 0.5
"""Standard deviations of the depths' own radius by which an outline may change it; and the share of a larger change
that is doubted, as what was followed may be no outline."""
THIN_WINDOWS = 2.5
"""Half the width of objects, in matching windows, whose limbs mislead the depths rather: these are left out then."""


def settled(scene: Scene, held: Held, surface: Surface, outlines: Outlines) -> RayFit | None:
    """The fit to the depths that can be believed, then to the outline with them; it doubts what the two differ by."""
    units, free = surface.units(scene.length_m), held.free(surface)
    depths = sound(settle(surface, Task(scene.patch, units, free, ())))
    if depths is None or not outlines:
        return depths
    both = sound(fine(surface, scene.patch, units, free, depths.sight, outlines))
    if both is not None and _contradict(depths, both, np.median(scene.ridge.points_m, axis=0)):
        if _windows(both, scene) >= THIN_WINDOWS:
            return doubting(both, depths, CONTRADICTION_DOUBT)
        inner = Sight(guard=INNER_GUARD)
        both = sound(fine(both.surface, scene.patch, units, free, inner, outlines))
        depths = both and sound(fine(both.surface, scene.patch, units, free, inner))
    return None if both is None or depths is None else doubted(scene, both, depths, units)


def doubted(scene: Scene, both: RayFit, depths: RayFit, units: Floats) -> RayFit:
    """A fit to depths and outline that doubts what the outline changes, and what the limbs as they are would change."""
    fit = doubting_outline(both, depths, _windows(both, scene))
    if depths.sight.whole:
        return fit
    whole = sound(fine(both.surface, scene.patch, units, both.free, Sight(), both.outlines))
    return fit if whole is None else doubting(fit, whole)


def _windows(fit: RayFit, scene: Scene) -> float:
    """How many matching windows half of an object is wide; infinite where errors are not alike."""
    half_width_px = float(np.median(scene.ridge.width_m / scene.ridge.points_m[:, 2])) * scene.patch.focal_px / 2
    window_px = WINDOW_OVER_CORRELATION * fit.likeness.length_px
    return half_width_px / window_px if window_px > 0 else np.inf


def _contradict(depths: RayFit, both: RayFit, place_m: Floats) -> bool:
    """Whether depths alone are so sure of another radius at a place (3,) than the outline has that one misleads.

    Depths whose limbs are left out already do not.
    """
    if not isinstance(depths.surface, Lateral) or not isinstance(both.surface, Lateral) or depths.sight.guard < 1:
        return False
    height_m = float(depths.surface.heights(place_m[None])[0])
    alone_m, with_outline_m = (
        one.radius_m + one.slope * float(one.heights(place_m[None])[0]) for one in (depths.surface, both.surface)
    )
    sizes = slice(depths.surface.size_place, None)
    lever = np.array([1.0, height_m])[: len(depths.free[sizes])]
    variance = float(lever @ depths.covariance[sizes, sizes] @ lever)
    return (alone_m - with_outline_m) ** 2 > CONTRADICTED**2 * variance


def sound(fit: RayFit | None) -> RayFit | None:
    """A fit whose numbers are numbers."""
    return fit if fit is not None and np.isfinite([fit.sigma, fit.surface.size_m]).all() else None

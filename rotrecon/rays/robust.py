"""The robust method: every kind of surface fitted along the rays to the same depths and outline, and ranked."""

from dataclasses import dataclass, replace
from operator import itemgetter
from typing import Literal

import numpy as np

from rotrecon.rays.coarse_fit import follow
from rotrecon.rays.fitting import Outline, Outlines
from rotrecon.rays.hypotheses import Held, Scene, coarse_cost, hypotheses
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.limbs import NOTHING_SEEN, SeenOutline, seen_outline
from rotrecon.rays.losses import TUKEY, tukey
from rotrecon.rays.outlined_fit import doubted, settled, sound
from rotrecon.rays.ray_fit import RayFit, fine, predicted
from rotrecon.rays.surfaces import Surface
from rotrecon.sections.radii import Shape

PARAMETERS: dict[Shape, int] = {"cylinder": 5, "cone": 6, "sphere": 4}
HOPELESS = 2.0
"""Shapes whose coarse cost is so many times that of the best, and a little more, are not looked into any further."""
LITTLE = 50.0
OTHER_TAPERS_RAD = tuple(np.deg2rad([-7.0, 7.0]))
"""By which a surface may taper more or less than its depths have it."""
OUTSMOOTHED = 0.5
"""Residuals of another shape over those of the lead at which that one leads instead."""
BEYOND_PX = 1.5
"""How far outside its outline a surface has nothing to do with a depth: nearer, its limb may be off by as much."""
OUT_OF_QUESTION = 20.0
"""Difference of costs at which a shape is not asked any further: its odds are one to half a billion."""


@dataclass(frozen=True, eq=False)
class Ranked:
    """One shape, and how much less credible than the best it is."""

    shape: Shape | Literal["revolution"]
    surface: Surface
    fit: RayFit | None
    """None for a shape that was hopeless from the start."""
    cost: float
    """Half the Bayesian information criterion, above that of the best: its belief falls with exp(-cost)."""


def rank(scene: Scene, held: Held) -> tuple[Ranked, ...]:
    """The shapes that could be fitted, the most credible first (Schwarz 1978).

    The best is fitted to as many depths as can be believed, the others to the same, so that their costs compare.
    """
    found = hypotheses(scene, held)
    limit = HOPELESS * min(cost for cost, _ in found.values()) + LITTLE
    promising: list[Shape] = [shape for shape in found if found[shape][0] <= limit]
    worth: dict[Shape, tuple[float, Surface]] = {shape: found[shape] for shape in promising}
    outlines, followed = _following(scene, held, worth)
    order = sorted(followed, key=lambda shape: followed[shape][0] + PARAMETERS[shape])
    lead = next((fit for shape in order if (fit := settled(scene, held, followed[shape][1], outlines))), None)
    if lead is None or not np.isfinite(lead.covariance).all():
        return ()
    ranked = _led(lead, scene, held, followed)
    smoothest = min((one.fit for one in ranked if one.fit), key=lambda fit: fit.sigma)
    if smoothest.sigma < OUTSMOOTHED * lead.sigma:
        # to a lead that explains nothing all shapes are alike
        other = settled(scene, held, smoothest.surface, outlines)
        ranked = ranked if other is None else _led(other, scene, held, followed) or ranked
    best, worst = ranked[0].cost, ranked[-1].cost
    out = [
        Ranked(shape, surface, None, worst - best + cost) for shape, (cost, surface) in found.items() if cost > limit
    ]
    return (*(replace(one, cost=one.cost - best) for one in ranked), *out)


def _led(lead: RayFit, scene: Scene, held: Held, followed: dict[Shape, tuple[float, Surface]]) -> list[Ranked]:
    """The shapes fitted to what the lead rests on, the most credible first."""
    ranked: list[Ranked] = []
    for shape, (_, surface) in followed.items():
        fit = _like(lead, scene, held, surface)
        if fit is not None and np.isfinite(fit.covariance).all():
            ranked.append(Ranked(shape, fit.surface, fit, _credit(scene, lead, fit)))
    return sorted(ranked, key=lambda one: one.cost)


def _following(
    scene: Scene, held: Held, found: dict[Shape, tuple[float, Surface]]
) -> tuple[Outlines, dict[Shape, tuple[float, Surface]]]:
    """The outline in the picture, and the surfaces with their costs once they have followed it.

    It is looked for again from the best surface then: what it looks like from there hangs less on the drawing.
    """
    order = [surface for _, surface in sorted(found.values(), key=itemgetter(0))]
    seen = NOTHING_SEEN
    for surface in (*order, *_tapered(order[0])):
        if len(seen.sides) >= 2:
            break
        seen = max(seen, _seen(scene, surface), key=lambda one: one.rank)
    if seen.edges is None:
        return (), found
    found = _followed(scene, held, found, seen.edges)
    best = min(found.values(), key=itemgetter(0))[1]
    again = _seen(scene, best, followed=True).doubting(seen, best)
    if again.edges is None or len(again.sides) < len(seen.sides):
        return ((seen.edges, 1.0),), found
    return ((again.edges, 1.0),), _followed(scene, held, found, again.edges)


def _seen(scene: Scene, surface: Surface, followed: bool = False) -> SeenOutline:
    return seen_outline(surface, scene.patch, scene.segments, scene.length_m, followed)


def _tapered(surface: Surface) -> list[Surface]:
    """The surface with half angles that depths flattened at the limbs may have missed."""
    if not isinstance(surface, Lateral):
        return []
    return [replace(surface, slope=surface.slope + float(np.tan(angle)), tapers=True) for angle in OTHER_TAPERS_RAD]


def _followed(
    scene: Scene, held: Held, found: dict[Shape, tuple[float, Surface]], edges: Outline
) -> dict[Shape, tuple[float, Surface]]:
    """The surfaces with their costs, once they have followed an outline."""
    followed: dict[Shape, tuple[float, Surface]] = {}
    for shape, (_, surface) in found.items():
        units, free = surface.units(scene.length_m), held.free(surface)
        surface = follow(surface, scene.patch, scene.pixels, units, free, (edges, scene.outline))
        followed[shape] = (coarse_cost(replace(scene, outline=edges), surface), surface)
    return followed


def _like(lead: RayFit, scene: Scene, held: Held, surface: Surface) -> RayFit | None:
    """A surface fitted to the depths and the outline that the lead rests on.

    What it doubts is of interest only if it may be the object's.
    """
    units, free = surface.units(scene.length_m), held.free(surface)
    if len(lead.free) == len(free):
        return lead
    if not lead.outlines:
        return sound(fine(surface, scene.patch, units, free, lead.sight))
    both = sound(fine(surface, scene.patch, units, free, lead.sight, lead.outlines))
    if both is None or _credit(scene, lead, both) > _credit(scene, lead, lead) + OUT_OF_QUESTION:
        return both
    depths = sound(fine(surface, scene.patch, units, free, lead.sight))
    return depths and doubted(scene, both, depths, units)


def _credit(scene: Scene, lead: RayFit, fit: RayFit) -> float:
    """Half the Bayesian information criterion, to be compared with that of others fitted like the lead."""
    return _cost(scene, lead, fit) + len(fit.free) / 2 * float(np.log(_independent(lead)))


def _independent(lead: RayFit) -> float:
    """How many of the measurements are independent, at least two."""
    return max(lead.independent + sum(share * len(outline) for outline, share in lead.outlines), 2.0)


def _cost(scene: Scene, lead: RayFit, fit: RayFit) -> float:
    """Misfit of a surface to the depths and the outline that the lead rests on.

    What lies well beyond its outline costs as much as any outlier.
    """
    rays = scene.patch.rays[:, lead.pixels]
    costs = tukey(predicted(scene.patch, lead.pixels, fit.surface, lead.sight).residual / lead.sigma)[0]
    if fit.surface.side < 0:
        gap_m, depth_m = fit.surface.gap(rays)
        gap_px = gap_m * scene.patch.focal_px / np.maximum(depth_m, 1e-9)
        costs = np.where(gap_px > (lead.sight.window_px - 1) / 2 + BEYOND_PX, TUKEY**2 / 6, costs)
    cost = lead.likeness.independent_share * float(costs.sum())
    for outline, share in lead.outlines:
        cost += share * float(tukey(outline.predict(fit.surface).residual)[0].sum())
    return cost

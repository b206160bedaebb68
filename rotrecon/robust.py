"""The robust method: every kind of surface fitted along the rays to the same depths and outline, and ranked."""

from dataclasses import dataclass

import numpy as np

from rotrecon.fitting import tukey
from rotrecon.guard import Task, settle
from rotrecon.hypotheses import Held, Scene, hypotheses
from rotrecon.limbs import outlines_of
from rotrecon.radii import Shape
from rotrecon.ray_fit import RayFit, fine, predicted
from rotrecon.surfaces import Surface

PARAMETERS: dict[Shape, int] = {"cylinder": 5, "cone": 6, "sphere": 4}
HOPELESS = 2.0
"""Shapes whose coarse cost is so many times that of the best, and a little more, are not looked into any further."""
LITTLE = 50.0


@dataclass(frozen=True, eq=False)
class Ranked:
    """One shape, and how much less credible than the best it is."""

    shape: Shape
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
    order = sorted(found, key=lambda shape: found[shape][0] + PARAMETERS[shape])
    lead = next((fit for shape in order if (fit := _settled(scene, held, found[shape][1])) is not None), None)
    if lead is None:
        return ()
    limit = HOPELESS * min(cost for cost, _ in found.values()) + LITTLE
    ranked: list[Ranked] = []
    for shape in order:
        cost, surface = found[shape]
        fit = _like(lead, scene, held, surface) if cost <= limit else None
        belief = cost if fit is None else _cost(scene, lead, fit) + PARAMETERS[shape] / 2 * np.log(_independent(lead))
        ranked.append(Ranked(shape, surface if fit is None else fit.surface, fit, belief))
    if all(one.fit is None for one in ranked):
        return ()
    best = min(one.cost for one in ranked if one.fit is not None)
    known = sorted((one for one in ranked if one.fit is not None), key=lambda one: one.cost)
    hopeless = [one for one in ranked if one.fit is None]
    return tuple(
        [Ranked(one.shape, one.surface, one.fit, one.cost - best) for one in known]
        + [Ranked(one.shape, one.surface, None, max(one.cost, known[-1].cost - best)) for one in hopeless]
    )


def _settled(scene: Scene, held: Held, surface: Surface) -> RayFit | None:
    outlines = outlines_of(surface, scene.patch, scene.length_m)
    fit = settle(surface, Task(scene.patch, surface.units(scene.length_m), held.free(surface), outlines))
    return fit if fit is not None and np.isfinite(fit.sigma) and np.isfinite(fit.covariance).all() else None


def _like(lead: RayFit, scene: Scene, held: Held, surface: Surface) -> RayFit | None:
    """A surface fitted to the depths and the outline that the lead rests on."""
    if len(lead.free) == len(held.free(surface)):
        return lead
    units, free = surface.units(scene.length_m), held.free(surface)
    fit = fine(surface, scene.patch, units, free, lead.sight, lead.outlines)
    return fit if fit is not None and np.isfinite(fit.sigma) and np.isfinite(fit.covariance).all() else None


def _independent(lead: RayFit) -> float:
    """How many of the measurements are independent, at least two."""
    return max(lead.independent + sum(share * len(outline) for outline, share in lead.outlines), 2.0)


def _cost(scene: Scene, lead: RayFit, fit: RayFit) -> float:
    """Misfit of a surface to the depths and the outline that the lead rests on."""
    residual = predicted(scene.patch, lead.pixels, fit.surface, lead.sight).residual / lead.sigma
    cost = lead.likeness.independent_share * float(tukey(residual)[0].sum())
    for outline, share in lead.outlines:
        cost += share * float(tukey(outline.predict(fit.surface).residual)[0].sum())
    return cost

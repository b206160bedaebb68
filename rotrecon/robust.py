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


@dataclass(frozen=True, eq=False)
class Ranked:
    """One shape, and how much less credible than the best it is."""

    shape: Shape
    fit: RayFit
    cost: float
    """Half the Bayesian information criterion, above that of the best: its belief falls with exp(-cost)."""


def rank(scene: Scene, held: Held) -> tuple[Ranked, ...]:
    """The shapes that could be fitted, the most credible first (Schwarz 1978).

    The best is fitted to as many depths as can be believed, the others to the same, so that their costs compare.
    """
    found = hypotheses(scene, held)
    order = sorted(found, key=lambda shape: found[shape][0] + PARAMETERS[shape])
    for lead in order:
        fit = settle(found[lead][1], _task(scene, held, found[lead][1]))
        if fit is not None:
            break
    else:
        return ()
    fits: dict[Shape, RayFit] = {lead: fit}
    for shape in order:
        surface = found[shape][1]
        other = (
            fit
            if shape == lead
            else fine(surface, scene.patch, surface.units(scene.length_m), held.free(surface), fit.sight, fit.outlines)
        )
        if other is not None and np.isfinite(other.sigma):
            fits[shape] = other
    return _compared(scene, fit, fits)


def _task(scene: Scene, held: Held, surface: Surface) -> Task:
    outlines = outlines_of(surface, scene.patch, scene.length_m)
    return Task(scene.patch, surface.units(scene.length_m), held.free(surface), outlines)


def _compared(scene: Scene, lead: RayFit, fits: dict[Shape, RayFit]) -> tuple[Ranked, ...]:
    """The shapes by their cost over the depths and the outline that the lead rests on."""
    independent = lead.independent + sum(share * len(outline) for outline, share in lead.outlines)
    cost = {
        shape: _misfit(scene, lead, fit) + PARAMETERS[shape] / 2 * np.log(max(independent, 2.0))
        for shape, fit in fits.items()
    }
    best = min(cost.values())
    ranked = [Ranked(shape, fit, cost[shape] - best) for shape, fit in fits.items()]
    return tuple(sorted(ranked, key=lambda one: one.cost))


def _misfit(scene: Scene, lead: RayFit, fit: RayFit) -> float:
    share = lead.likeness.independent_share
    residual = predicted(scene.patch, lead.pixels, fit.surface, lead.sight).residual / lead.sigma
    depth_cost = share * float(tukey(residual)[0].sum())
    return depth_cost + sum(
        share_of * float(tukey(outline.predict(fit.surface).residual)[0].sum()) for outline, share_of in lead.outlines
    )

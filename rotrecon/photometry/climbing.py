"""A surface moved from a start until the pictures of several cameras agree over it, outlines in them included."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rotrecon.arrays import Bools, Floats
from rotrecon.photometry.contest import CONTESTED, contest
from rotrecon.photometry.matches import Match, Other, matches_of
from rotrecon.photometry.outlines import CarriedOutline, Edge, outline_in
from rotrecon.photometry.sharpening import Sharpened, sharpened
from rotrecon.photometry.visible import clear_of, shown
from rotrecon.rays.ball import Ball
from rotrecon.rays.fitting import Measurement, Outline, refine
from rotrecon.rays.hypotheses import Scene
from rotrecon.rays.limbs import seen_outline
from rotrecon.rays.losses import TUKEY, Loss, cauchy, tukey
from rotrecon.rays.patch import Patch
from rotrecon.rays.ray_fit import spread
from rotrecon.rays.surfaces import Surface

ROUNDS: tuple[tuple[Loss, int], ...] = ((cauchy, 3000), (tukey, 12000))
"""Loss and most pixels, of all views together: some of them are enough to find the way. Each chooses them anew."""
ITERATIONS = 8
MOVED_PIXELS = 500
"""Enough to tell how far a surface moved."""
SOUGHT_AGAIN_PX = 1.0
"""A surface whose outline moved by more may have been given the wrong edges."""
DEPTH_SHARE = 0.5
"""Of a surface's pixels, how many matched depth must agree with it to have a say in which they are."""
PLAIN = 0.05
"""Share of a surface's pixels with texture below which its outline is believed, and brightness hardly."""
DISTRUST = 5.0
"""By how much larger the error of brightness is taken there: the light near limbs is not what pixels make of it."""
VAGUE_PX = 2.0
"""Standard deviation of an edge beyond which it is none of a ball's: those of balls before a wall have 0.3 to 1.4."""
NOTHING = TUKEY**2 / 6
"""Cost of a measurement that a surface does not explain."""


@dataclass(frozen=True, eq=False)
class Climbed:
    """Where a surface ended."""

    start: Surface
    surface: Surface
    free: Bools
    pixels: Bools
    """(N,) of the patch that show it."""
    by_depth: float
    """Share of them that matched depth agrees with."""
    matches: tuple[Match, ...]
    edges: tuple[Edge, ...]
    sharpened: Sharpened
    """Depth round the surface as the pictures have it."""
    contested: bool = False
    """Whether outlines and texture speak against each other wherever the outlines are sought."""

    def credit(self, surface: Surface, sigma: float, share: float, *, by_edges: bool) -> float:
        """How much of what was compared a surface explains, in half a likelihood's logarithm.

        The pixels have such a sigma, and such a share of them is independent; edges count on demand.
        """
        earned = 0.0
        for match in self.matches:
            earned += share * float((NOTHING - tukey(match.agreement.predict(surface).residual / sigma)[0]).sum())
        for edge in self.edges if by_edges else ():
            earned += float((NOTHING - tukey(edge.predict(surface).residual)[0]).sum())
        return earned

    @property
    def agreeing(self) -> float:
        """Share of the compared pixels that agree; 0 where there are none."""
        changes = zip(self.matches, self.sharpened.changes, strict=True)
        agree = [tukey(change.residual / match.sigma)[1] > 0 for match, change in changes]
        return float(np.concatenate(agree).mean()) if agree else 0.0


def climb(start: Surface, free: Bools, sigma: float, scene: Scene, others: tuple[Other, ...]) -> Climbed | None:
    """The surface that a start leads to, of which `free` (k,) parameters are to be found.

    `sigma` is that of matched depth. None where there is neither texture nor an outline.
    """
    patch, units = scene.patch, start.units(scene.length_m)
    surface = sought = start
    # the outline in the picture from farthest away is enough to find the way
    far = max(others, key=lambda other: float(np.linalg.norm(other.carrier.center_m)))
    edges = edges_of(surface, scene, (far,))
    pixels, by_depth, matches = np.zeros(0, dtype=np.bool_), 0.0, tuple[Match, ...]()
    for number, (loss, most) in enumerate(ROUNDS):
        if number and moved_px(sought, surface, patch, others) > SOUGHT_AGAIN_PX:
            sought, edges = surface, edges_of(surface, scene, others)
        elif number:
            edges += edges_in(tuple(other for other in others if other is not far), sought, scene)
        pixels, by_depth = _pixels(surface, patch, sigma)
        matches = matches_of(surface, patch, pixels, others, most)
        if not matches and not edges:
            return None
        surface = _agreeing(surface, matches, edges, loss, free, units)
    sharp = sharpened(surface, patch, pixels, matches)
    if edges and matches and sharp.textured < PLAIN:
        matches = tuple(replace(match, sigma=DISTRUST * match.sigma) for match in matches)
        surface = _agreeing(surface, matches, edges, tukey, free, units)
        sharp = sharpened(surface, patch, pixels, matches)
    elif edges and contest(surface, matches, free, units) > CONTESTED:
        return _let_go(
            Climbed(start, surface, free, pixels, by_depth, matches, tuple(edges), sharp), sigma, scene, others
        )
    return Climbed(start, surface, free, pixels, by_depth, matches, tuple(edges), sharp)


def _let_go(held: Climbed, sigma: float, scene: Scene, others: tuple[Other, ...]) -> Climbed:
    """Where texture has a surface that edges drew elsewhere, with the edges there if they agree to it."""
    patch, free, units = scene.patch, held.free, held.start.units(scene.length_m)
    surface = _agreeing(held.surface, held.matches, (), tukey, free, units)
    edges = edges_of(surface, scene, others)
    pixels, by_depth = _pixels(surface, patch, sigma)
    matches = matches_of(surface, patch, pixels, others, ROUNDS[-1][1])
    if not matches:
        return replace(held, contested=True)
    together = _agreeing(surface, matches, edges, tukey, free, units)
    contested = contest(together, matches, free, units) > CONTESTED
    if contested:
        together, edges = _agreeing(surface, matches, (), tukey, free, units), []
    sharp = sharpened(together, patch, pixels, matches)
    return Climbed(held.start, together, free, pixels, by_depth, matches, tuple(edges), sharp, contested)


def again(climbed: Climbed, scene: Scene) -> Climbed:
    """Where a surface goes on to with the pixels and the edges that are known."""
    units = climbed.surface.units(scene.length_m)
    surface = _agreeing(climbed.surface, climbed.matches, climbed.edges, tukey, climbed.free, units)
    sharp = sharpened(surface, scene.patch, climbed.pixels, climbed.matches)
    return replace(climbed, surface=surface, sharpened=sharp)


def _agreeing(
    surface: Surface, matches: tuple[Match, ...], edges: Sequence[Edge], loss: Loss, free: Bools, units: Floats
) -> Surface:
    """The surface that pictures and outlines agree on best."""
    measurements: list[Measurement] = [*(match.agreement for match in matches), *edges]
    weighting = [*(match.weighting for match in matches), *((1.0, 1.0) for _ in edges)]
    return refine(surface, measurements, weighting, loss, free, units, ITERATIONS).surface


def _pixels(surface: Surface, patch: Patch, sigma: float) -> tuple[Bools, float]:
    """Pixels (N,) that show a surface, and the share of them with which matched depth agrees; all where few do."""
    clear = clear_of(surface, patch)
    agreeing = shown(surface, patch, clear, sigma)
    by_depth = float(agreeing.sum() / max(clear.sum(), 1))
    return (agreeing if by_depth > DEPTH_SHARE else clear), by_depth


def edges_of(surface: Surface, scene: Scene, others: tuple[Other, ...]) -> list[Edge]:
    """The outline in all pictures."""
    own = seen_outline(surface, scene.patch, scene.segments, scene.length_m).edges
    return [*(() if own is None or _is_vague(own, surface) else (own,)), *edges_in(others, surface, scene)]


def _is_vague(edges: Outline, surface: Surface) -> bool:
    """Whether the outline of a ball is so faint that its edges, which err alike all round, would only mislead."""
    return isinstance(surface, Ball) and float(np.median(edges.sigma_px)) > VAGUE_PX


def edges_in(others: tuple[Other, ...], surface: Surface, scene: Scene) -> list[Edge]:
    """The outline in some other pictures."""
    if not others:
        return []
    low, high = 0.0, 0.0
    if not isinstance(surface, Ball):
        rays = scene.patch.rays[:, scene.patch.kept]
        points = (rays * surface.meet(rays)[0]).T
        low, high = np.percentile(surface.heights(points), [1, 99])
    edges: list[Edge] = []
    for other in others:
        seen = outline_in(other.view, other.carrier, surface, scene.patch, (float(low), float(high))).edges
        if seen is not None and not _is_vague(seen, surface):
            edges.append(CarriedOutline(seen, other.carrier))
    return edges


def moved_px(before: Surface, after: Surface, patch: Patch, others: tuple[Other, ...]) -> float:
    """How far the points of a surface moved in the other pictures, at most, in the median of the object's pixels."""
    rays = patch.rays[:, spread(np.flatnonzero(patch.kept).astype(np.int32), MOVED_PIXELS)]
    first, second = (surface.meet(rays)[0] for surface in (before, after))
    moved: list[Floats] = [
        np.linalg.norm(other.carrier.carried(rays, second)[0] - other.carrier.carried(rays, first)[0], axis=0)
        for other in others
    ]
    return float(max(np.nanmedian(one) for one in moved))

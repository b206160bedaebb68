"""A shape fitted to matched depth, refined against the pictures that the depth comes from."""

from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter

import numpy as np

from rotrecon.arrays import Floats, freeze
from rotrecon.frame import Frame
from rotrecon.photometry.carrying import carrier_of
from rotrecon.photometry.climbing import DEPTH_SHARE, PLAIN, SOUGHT_AGAIN_PX, Climbed, again, climb, moved_px
from rotrecon.photometry.drawn import as_wide_as_drawn, drawn, may_be_ball
from rotrecon.photometry.matches import FEWEST_PIXELS, Other
from rotrecon.photometry.scanning import TILTS_RAD, scanned
from rotrecon.photometry.sureness import covariance_of, outlined
from rotrecon.photometry.visible import clear_of
from rotrecon.rays.correlation import Likeness
from rotrecon.rays.hypotheses import Held, Scene
from rotrecon.rays.lateral import Lateral
from rotrecon.rays.ray_fit import RayFit, Sight, predicted
from rotrecon.rays.robust import PARAMETERS, Ranked
from rotrecon.rays.surfaces import Surface
from rotrecon.sections.radii import Shape
from rotrecon.turned.turned import Turned

SHARP_SHARE = 0.3
"""Of the pixels that a fit rests on, how many must have a depth from the pictures to take their place."""
FARTHEST_PX = 4.0
"""Pictures are matched to a fraction of a pixel; a surface that moves by more has lost its way, but for a plain one,
whose depth is anyhow that of its shading."""
MOST_CHANGED = 0.4
"""Share of its radius by which one that had another has lost its way too: a thin thing's is few pixels."""
AGREEING_SHARE = 0.75
"""Of the pixels, how many must agree in brightness for a surface to be where it is said to be."""
UNSURE = 0.1
"""Standard error of the radius over the radius of a fit that is no start."""
TEXTURED = 0.3
"""Of an object's pixels, how many must have a depth from the pictures for these to say what shape it has, or what size
where no outline is seen: shading passes for texture on up to a fifth."""
UNTEXTURED_DOUBT, TEXTURE_HOLDS = 0.015, 0.1
"""Standard error of the radius, over the radius, that outline and shading of a plain object leave; and the share of
textured pixels at which nothing of it is left."""
OUTLINED_LEEWAY = 2.0
"""Times as far as usual the drawing may be off that outlines in all pictures contradict."""
FULLY_TEXTURED = 0.5
"""Of an object's pixels, how many must have a depth from the pictures to have been enough to match."""
ALIKE = 5.0
"""Half a likelihood's logarithm: in a shallow valley of brightness, the end that matched depth led to is held to, for
its outline was looked for where the object is."""
LEAST_CORRELATION = 0.5
"""Of two pictures over a surface that is where they agree best; less is none that they show."""


@dataclass(frozen=True, eq=False)
class Refinement:
    """A shape as the pictures have it."""

    shape: Ranked
    """Its fit's pixels are those whose depth the pictures tell, if there are enough."""
    depth_m: Floats
    """(N,) of the patch: what the pictures tell where they do, what was matched elsewhere."""
    climbed: Climbed
    textured: float
    """Share of its pixels at which the pictures tell a depth."""
    by_depth: bool
    """Whether matched depth was its start."""
    trusted: bool
    """Whether nothing speaks for another start."""
    held: bool
    """Whether its size is told by texture, or by its outlines alone."""

    def __post_init__(self) -> None:
        freeze(self)

    @property
    def doubts(self) -> tuple[str, ...]:
        """Why no tool should rely on it."""
        if self.climbed.contested:
            return ("its texture and its outline speak for different sizes; light it better, or take more views",)
        if self.textured > TEXTURED or (self.by_depth and self.climbed.by_depth > DEPTH_SHARE):
            return ()
        return (
            "hardly any texture is seen on the object, so that its size rests on its outline; "
            "light it better, or bring the camera nearer",
        )


def others_of(frame: Frame) -> tuple[Other, ...]:
    """All views of a frame but the reference."""
    return tuple(Other(view, carrier_of(view, frame.T_base_camera)) for view in frame.views[1:])


def refined(one: Ranked, scene: Scene, others: tuple[Other, ...]) -> Refinement | None:
    """A shape fitted to matched depth, refined against other views.

    None where neither texture nor outlines hold the surface, and for a general surface of revolution.
    """
    fit = one.fit
    if not others or fit is None or isinstance(fit.surface, Turned):
        return None
    climbed = climb(fit.surface, fit.free, fit.sigma, scene, others)
    if climbed is None:
        return None
    size = fit.surface.size_place
    near = moved_px(fit.surface, climbed.surface, scene.patch, others) < FARTHEST_PX
    near &= abs(climbed.surface.size_m - fit.surface.size_m) < MOST_CHANGED * climbed.surface.size_m
    refinement = _finished(one, fit, climbed, scene, by_depth=near)
    by_outline = refinement.textured < PLAIN and refinement.held
    if not near and not by_outline:
        return None
    leeway = OUTLINED_LEEWAY if by_outline else 1.0
    as_drawn = as_wide_as_drawn(climbed.surface, scene.patch.camera, scene.segments, scene.length_m, leeway)
    sure = by_outline or float(np.sqrt(fit.covariance[size, size])) < UNSURE * fit.surface.size_m
    trusted = climbed.agreeing > AGREEING_SHARE and climbed.by_depth > DEPTH_SHARE and sure and as_drawn
    return replace(refinement, trusted=trusted, held=refinement.held or (trusted and refinement.textured > PLAIN))


def sought(scene: Scene, held: Held, like: RayFit, others: tuple[Other, ...]) -> tuple[Refinement, ...]:
    """The shapes that the drawing and the pictures alone speak for, whatever depth was matched.

    `like` is a fit to that depth, which says how rough it is.
    """
    known = scene.patch.depth_m[scene.patch.drawn]
    distance_m = float(np.nanmedian(known)) if np.isfinite(known).any() else 1.0
    found: list[Refinement] = []
    shapes: tuple[Shape, ...] = ("cylinder", "cone", "sphere") if may_be_ball(scene.segments) else ("cylinder", "cone")
    for shape in shapes:
        climbed = _widened(found[0].climbed, scene, others) if shape == "cone" and found else None
        if climbed is None:
            start = held.limiting(drawn(shape, scene.patch, scene.segments, distance_m))
            tilts = np.zeros(1) if shape == "sphere" or held.direction is not None else TILTS_RAD
            start, alike = scanned(start, scene.patch, clear_of(start, scene.patch), others[0], tilts)
            if alike >= LEAST_CORRELATION:
                climbed = climb(start, held.free(start), like.sigma, scene, others)
        if climbed is not None:
            base = replace(like, free=climbed.free, outlines=())
            one = Ranked(shape, climbed.surface, base, 0.0)
            found.append(_finished(one, base, climbed, scene, by_depth=False))
    return tuple(found)


def _widened(cylinder: Climbed, scene: Scene, others: tuple[Other, ...]) -> Climbed | None:
    """The cone near a cylinder; None where it lies so far that it has to be sought by itself."""
    surface = cylinder.surface
    if not isinstance(surface, Lateral):
        return None
    start, free = replace(surface, tapers=True), np.append(cylinder.free, True)
    cone = again(replace(cylinder, surface=start, free=free), scene)
    return cone if moved_px(surface, cone.surface, scene.patch, others) < SOUGHT_AGAIN_PX else None


def weighed(found: tuple[Refinement, ...]) -> tuple[Refinement, ...]:
    """Refinements with what the pictures have against each, the best first, and no shape twice.

    All are compared with the pixels, or without texture the edges too, of the one that explains most of its own.
    """
    matches = [match for one in found for match in one.climbed.matches]
    if not matches:
        return ()
    clearest = min(matches, key=lambda match: match.sigma)
    share = clearest.likeness.independent_share
    count = max(share * len(clearest.pixels), 2.0)
    # what looks like an edge may be a pattern's; texture does not lie
    by_edges = max(one.textured for one in found) < TEXTURED

    def credit(of: Refinement, surface: Surface) -> float:
        return of.climbed.credit(surface, clearest.sigma, share, by_edges=by_edges)

    lead = max(found, key=lambda one: credit(one, one.climbed.surface))
    costs = [PARAMETERS[_shape(one)] / 2 * np.log(count) - credit(lead, one.climbed.surface) for one in found]
    best: dict[Shape, Refinement] = {}
    for cost, one in sorted(zip(costs, found, strict=True), key=itemgetter(0)):
        relative = replace(one, shape=replace(one.shape, cost=float(cost - min(costs))))
        rival = best.setdefault(_shape(one), relative)
        if one.by_depth and relative.shape.cost < rival.shape.cost + ALIKE:
            best[_shape(one)] = replace(relative, shape=replace(relative.shape, cost=rival.shape.cost))
    return tuple(best.values())


def _shape(one: Refinement) -> Shape:
    shape = one.shape.shape
    assert shape != "revolution"
    return shape


def _finished(one: Ranked, fit: RayFit, climbed: Climbed, scene: Scene, *, by_depth: bool) -> Refinement:
    """What is known once a surface has come to its end, from where matched depth has it or from elsewhere."""
    patch, surface = scene.patch, climbed.surface
    sharp = climbed.sharpened
    depth_m, known, textured = sharp.depth_m, sharp.known, sharp.textured
    if not by_depth:
        # what was matched is known to be wrong; without texture, what agrees is where the surface says it is
        seen_m, hit = surface.meet(patch.rays)
        there = known if textured > TEXTURED else known | sharp.agreeing
        depth_m = np.where(there & ~known, seen_m, np.where(hit & ~known, np.nan, depth_m))
        pixels = np.flatnonzero(there).astype(np.int32)
        fit = replace(fit, pixels=pixels, sight=Sight(), sigma=1.0, likeness=Likeness(0.0, 0.0))
    pixels, sight = fit.pixels, fit.sight
    if known.sum() > max(SHARP_SHARE * len(pixels), FEWEST_PIXELS):
        pixels = np.flatnonzero(known).astype(np.int32)
        sight = Sight(guard=float(np.percentile(surface.off_middle(patch.rays[:, pixels]), 95)))
    residual = predicted(replace(patch, depth_m=depth_m), pixels, surface, sight).residual
    better = replace(
        fit,
        surface=surface,
        pixels=pixels,
        sight=sight,
        residual=residual,
        own_covariance=partial(_covariance, climbed, patch.shape),
        doubt=0.0,
    )
    by_texture = textured > (PLAIN if climbed.edges else TEXTURED)
    held = by_texture or outlined(surface, climbed.edges, climbed.free, scene.length_m)
    whole = replace(one, surface=surface, fit=better)
    return Refinement(whole, depth_m, climbed, textured, by_depth, trusted=False, held=held)


def _covariance(climbed: Climbed, shape: tuple[int, int]) -> Floats:
    """Of a surface's parameters (k, k), with what outline and shading of a plain object leave open."""
    surface, sharp = climbed.surface, climbed.sharpened
    matches = tuple(zip(climbed.matches, sharp.changes, strict=True))
    covariance = covariance_of(surface, matches, climbed.edges, climbed.free, shape)
    left_m = UNTEXTURED_DOUBT * max(1.0 - sharp.textured / TEXTURE_HOLDS, 0.0) * surface.size_m
    size = surface.size_place
    covariance[size, size] += left_m**2 * climbed.free[size]
    return covariance

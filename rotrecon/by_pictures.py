"""The chosen shape as the pictures of several views have it; they overrule what was matched where the two differ."""

from dataclasses import dataclass, replace

import numpy as np

from rotrecon.frame import Frame
from rotrecon.photometry.refinement import FULLY_TEXTURED, TEXTURED, Refinement, others_of, refined, sought, weighed
from rotrecon.primitives import Kind
from rotrecon.rays.hypotheses import Held, Scene
from rotrecon.rays.robust import Ranked
from rotrecon.rays.starts import ridge
from rotrecon.rays.surfaces import radius_seen_m
from rotrecon.recognition import chosen_of
from rotrecon.settings import Settings

APART = 0.1
"""Share of the radius by which two ways to it may differ."""


@dataclass(frozen=True, eq=False)
class Seen:
    """The shapes, the one that was chosen, and what they are compared with."""

    ranked: tuple[Ranked, ...]
    chosen: Ranked
    scene: Scene
    doubts: tuple[str, ...] = ()
    """What the pictures leave open."""
    textured: bool = True
    """Whether there is enough to match on most of the object."""
    held: bool = True
    """Whether the pictures tell its size at all."""


def by_pictures(matched: Seen, held: Held, frame: Frame, kind: Kind | None, settings: Settings) -> Seen:
    """What was found by matched depth, refined; as it is where the frame does not come from several views.

    Where the pictures do not bear out what was matched, shapes are sought by them and the drawing alone.
    """
    others = others_of(frame)
    if not others:
        return matched
    scene, fit = matched.scene, matched.chosen.fit
    assert fit is not None
    ranked, chosen, first = matched.ranked, matched.chosen, refined(matched.chosen, scene, others)
    by_depth, doubts = first, tuple[str, ...]()
    if first is None or not first.trusted:
        found = weighed((*((first,) if first else ()), *sought(scene, held, fit, others)))
        shapes = tuple(one.shape for one in found)
        best = chosen_of(shapes, kind, settings) if shapes else None
        if best is not None:
            ranked, chosen = shapes, best
            first = next(one for one in found if one.shape is best)
            doubts = _disagreement(by_depth, first, scene)
    if first is None:
        return replace(matched, textured=False)
    ranked = tuple(first.shape if one is chosen else one for one in ranked)
    textured = first.textured > FULLY_TEXTURED
    return Seen(ranked, first.shape, _scene_seen(first, scene, frame), (*first.doubts, *doubts), textured, first.held)


def _disagreement(by_depth: Refinement | None, by_drawing: Refinement, scene: Scene) -> tuple[str, ...]:
    """What speaks for another size than the one that the drawing led to."""
    if by_depth is None or by_depth is by_drawing:
        return ()
    rays = scene.patch.rays[:, by_drawing.climbed.pixels]
    other_m, found_m = (radius_seen_m(one.climbed.surface, rays) for one in (by_depth, by_drawing))
    if abs(other_m - found_m) < APART * found_m:
        return ()
    return (
        f"what was matched speaks for {2000 * other_m:.0f} mm, the pictures alone for {2000 * found_m:.0f} mm; "
        "light it better, or take more views",
    )


def _scene_seen(first: Refinement, scene: Scene, frame: Frame) -> Scene:
    """The scene with the depths of a refinement, and the ridge that they have if matched ones had none."""
    patch = replace(scene.patch, depth_m=first.depth_m)
    if first.by_depth:
        # matched on a plain object, depth says nothing of what stands beside what
        telling_m = scene.depth_m if first.textured > TEXTURED else np.full_like(scene.depth_m, np.nan)
        return replace(scene, patch=patch, depth_m=telling_m)
    depth_m = np.full(frame.camera.width * frame.camera.height, np.nan)
    pixels = np.flatnonzero(first.climbed.pixels).astype(np.int32)
    depth_m[patch.frame_pixels(pixels)] = first.depth_m[pixels]
    cells = depth_m[scene.segments.pixel]
    shown = scene.segments.inside & np.isfinite(cells)
    edge, seen_m = ridge(frame.camera, cells, scene.segments, shown), np.where(shown, cells, np.nan)
    return replace(scene, patch=patch, ridge=edge, depth_m=seen_m)

"""What a decision is bound to: one digest over all that it rests on (rule 1 of the decision)."""

from dataclasses import fields
from functools import lru_cache

from app.record.tree import Tree, as_tree, by_hash, hash_of, in_full
from rotrecon.drawing import Drawing
from rotrecon.frame import Frame
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings

GIVEN = {"frame", "drawing", "settings"}
"""Members of a reconstruction that went into it."""
INTERMEDIATE = {"segments", "segmentation", "first_cut", "sections", "second_cut"}
"""Members that are as large as the area: they count by the hashes of their arrays, the others by every number."""


def evidence_digest(frame: Frame, drawing: Drawing, settings: Settings, result: Reconstruction) -> str:
    """SHA-256 over frame, calibration, drawing, settings, tool table and result, as they are at this moment.

    The calibration is the frame's, the tool table the settings'. Equal digests mean equal to the last bit; the drawing
    is the operator's, which has no axis where the result's was proposed.
    """
    return digest_of_parts(frame_id(frame), tree_of(drawing), tree_of(settings), result_tree(result))


def digest_of_parts(frame: str, drawing: Tree, settings: Tree, result: Tree) -> str:
    """The same of a frame by its name and of trees, as the record holds them."""
    parts = {"drawing": hash_of(drawing), "frame": frame, "result": hash_of(result), "settings": hash_of(settings)}
    return hash_of(parts)


@lru_cache(maxsize=2)
def frame_id(frame: Frame) -> str:
    """The name of a frame: the hash of its picture, points, camera, pose, noise, workspace and time."""
    return hash_of(tree_of(frame))


def tree_of(value: object) -> Tree:
    """A value as a tree whose arrays are hashes."""
    return as_tree(value, by_hash)


def result_tree(result: Reconstruction) -> Tree:
    """All that a reconstruction found: numbers in full, intermediates by their hashes, and the drawing it used."""
    found = {field.name: getattr(result, field.name) for field in fields(result) if field.name not in GIVEN}
    tree = {name: as_tree(value, by_hash if name in INTERMEDIATE else in_full) for name, value in found.items()}
    return {**tree, "drawing": tree_of(result.drawing)}

"""The program's frozen dataclasses as JSON, exactly: what is hashed, what is stored, and the way back."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from datetime import datetime
from math import isfinite
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from rotrecon.camera import PinholeCamera
from rotrecon.contact import Place
from rotrecon.drawing import AreaOfInterest, Constraints, Drawing, ObjectAxis
from rotrecon.frame import DepthCameraNoise, Frame, StereoEvidence, StereoNoise, View
from rotrecon.settings import Settings
from rotrecon.tool_table import Tool
from rotrecon.workspace import Workspace

Tree = Any
"""What JSON holds; a dataclass is an object of one member, its name."""
Array = NDArray[Any]

KNOWN = {
    known.__name__: known
    for known in (
        AreaOfInterest,
        Constraints,
        DepthCameraNoise,
        Drawing,
        Frame,
        ObjectAxis,
        PinholeCamera,
        Place,
        Settings,
        StereoEvidence,
        StereoNoise,
        Tool,
        View,
        Workspace,
    )
}
"""Those that are built again from a tree: what a measurement is made of."""


def canonical(tree: Tree) -> bytes:
    """The one way to write a tree: ASCII, members sorted, no spaces, floats by the shortest digits that are exact.

    Raises ValueError for a number that is not finite, and TypeError for what JSON cannot hold.
    """
    return json.dumps(tree, sort_keys=True, separators=(",", ":"), allow_nan=False).encode("ascii")


def sha256(content: bytes) -> str:
    """In hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def hash_of(tree: Tree) -> str:
    """SHA-256 of a tree as it is written canonically."""
    return sha256(canonical(tree))


def as_tree(value: object, keep: Callable[[Array], Tree]) -> Tree:
    """A value as a tree, what `keep` makes of every array; raises TypeError for what the program's data never are."""
    if isinstance(value, np.ndarray):
        return keep(value)
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float):
        # a float may be one of NumPy's, which is written in the same digits
        return float(value) if isfinite(value) else {"number": str(float(value))}
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, tuple):
        return [as_tree(member, keep) for member in value]
    if isinstance(value, frozenset):
        return {"set": sorted(as_tree(member, keep) for member in value)}
    if isinstance(value, datetime):
        return {"datetime": value.isoformat()}
    if isinstance(value, msgspec.Struct):
        return {type(value).__name__: {name: as_tree(getattr(value, name), keep) for name in value.__struct_fields__}}
    if is_dataclass(value):
        members = {field.name: as_tree(getattr(value, field.name), keep) for field in fields(value)}
        return {type(value).__name__: members}
    raise TypeError(f"a {type(value).__name__} has no place in the record")


def by_hash(array: Array) -> Tree:
    """An array as the hash of its bytes, with its type and shape."""
    return {"array": sha256(np.ascontiguousarray(array).tobytes()), "dtype": array.dtype.str, "shape": [*array.shape]}


def in_full(array: Array) -> Tree:
    """An array as its numbers."""
    return {"numbers": _nested(array.tolist()), "dtype": array.dtype.str}


def _nested(numbers: Any) -> Tree:
    if isinstance(numbers, list):
        return [_nested(number) for number in numbers]
    return as_tree(numbers, in_full)


def from_tree(tree: Tree, load: Callable[[str], bytes]) -> Any:
    """The value that `as_tree` made a tree of, with `by_hash` for its arrays, whose bytes `load` gives by their hash.

    Raises ValueError for a tree that this version of the program cannot read.
    """
    if isinstance(tree, list):
        return tuple(from_tree(member, load) for member in tree)
    if not isinstance(tree, dict):
        return tree
    if "array" in tree:
        return np.frombuffer(bytearray(load(tree["array"])), np.dtype(tree["dtype"])).reshape(tree["shape"])
    if len(tree) != 1:
        raise ValueError(f"an object with the members {', '.join(tree)} is not of this version of the program")
    ((name, content),) = tree.items()
    if name == "number":
        return float(content)
    if name == "set":
        return frozenset(from_tree(member, load) for member in content)
    if name == "datetime":
        return datetime.fromisoformat(content)
    if name not in KNOWN:
        raise ValueError(f"a {name} is not of this version of the program")
    members = {key: from_tree(member, load) for key, member in content.items()}
    try:
        return KNOWN[name](**members)
    except TypeError as error:
        raise ValueError(f"its {name} is not of this version of the program ({error})") from error

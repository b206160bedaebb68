"""Frames in the record: each array stored once under the hash of its bytes, each frame under the hash of its tree."""

import json
import sqlite3
import zlib
from collections.abc import Iterator

from app.record.errors import NoSuchEntry, StoreError
from app.record.tree import Array, Tree, as_tree, by_hash, canonical, from_tree, sha256
from rotrecon.frame import Frame

COMPRESSION = 1
"""Depth is noise for the most part: more effort takes seconds and saves little."""


def save_frame(connection: sqlite3.Connection, frame: Frame) -> str:
    """Store a frame that is not there yet; its name."""

    def keep(array: Array) -> Tree:
        tree = by_hash(array)
        if connection.execute("SELECT 1 FROM arrays WHERE hash = ?", (tree["array"],)).fetchone() is None:
            content = zlib.compress(array.tobytes(), COMPRESSION)
            connection.execute("INSERT INTO arrays VALUES (?, ?)", (tree["array"], content))
        return tree

    tree = canonical(as_tree(frame, keep))
    name = sha256(tree)
    connection.execute("INSERT OR IGNORE INTO scenes VALUES (?, ?)", (name, tree.decode("ascii")))
    return name


def load_frame(connection: sqlite3.Connection, name: str) -> Frame:
    """The frame of a name; raises NoSuchEntry, StoreError for one that is damaged, ValueError for another version's."""
    return from_tree(_tree(connection, name), lambda digest: _array(connection, digest))


def scene_problem(connection: sqlite3.Connection, name: str) -> str | None:
    """Why a frame is not as it was stored, or None when it is."""
    try:
        for digest in _arrays_of(_tree(connection, name)):
            _array(connection, digest)
    except (NoSuchEntry, StoreError) as error:
        return str(error)
    return None


def _arrays_of(tree: Tree) -> Iterator[str]:
    """The hashes of the arrays of a tree."""
    if isinstance(tree, dict) and "array" in tree:
        yield tree["array"]
    elif isinstance(tree, (dict, list)):
        for member in tree.values() if isinstance(tree, dict) else tree:
            yield from _arrays_of(member)


def _tree(connection: sqlite3.Connection, name: str) -> Tree:
    row = connection.execute("SELECT CAST(tree AS BLOB) FROM scenes WHERE id = ?", (name,)).fetchone()
    if row is None:
        raise NoSuchEntry(f"there is no scene {name} in the record")
    if sha256(row[0]) != name:
        raise StoreError(f"scene {name} of the record is damaged; restore the record from a copy")
    return json.loads(row[0])


def _array(connection: sqlite3.Connection, digest: str) -> bytes:
    row = connection.execute("SELECT content FROM arrays WHERE hash = ?", (digest,)).fetchone()
    try:
        content = zlib.decompress(row[0]) if row is not None else b""
    except (zlib.error, TypeError):
        content = b""
    if row is None or sha256(content) != digest:
        raise StoreError(f"array {digest} of the record is missing or damaged; restore the record from a copy")
    return content

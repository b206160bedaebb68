"""Files that appear whole or not at all, and stay when the power goes."""

import os
import secrets
from pathlib import Path

ANYBODY = 0o666
"""Permissions of a file that the umask alone limits."""


def write_durably(path: Path, content: bytes, mode: int = ANYBODY) -> None:
    """Write a new file and put it on disk; OSError when it exists or cannot be written."""
    with open(path, "xb", opener=lambda name, flags: os.open(name, flags, mode)) as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def flush_folder(folder: Path) -> None:
    """Put a folder's own entries on disk; what was renamed into it is otherwise lost with the power."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_whole(path: Path, content: bytes, mode: int = ANYBODY) -> None:
    """Write or replace a file, aside first and renamed into place; `mode` is its permissions before the umask."""
    aside = path.with_name(f".{path.name}.{secrets.token_hex(4)}.partial")
    try:
        write_durably(aside, content, mode)
        aside.replace(path)
        flush_folder(path.resolve().parent)
    finally:
        aside.unlink(missing_ok=True)

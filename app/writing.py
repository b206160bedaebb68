"""Files that a command writes."""

from pathlib import Path

from rotrecon.errors import SceneError
from rotrecon.files import write_whole


def write_file(path: Path, what: str, content: bytes) -> None:
    """Write or replace a file; raises SceneError where that is not possible."""
    try:
        write_whole(path, content)
    except OSError as error:
        remedy = "name a file in a folder where you may write"
        raise SceneError(path, what, f"cannot be written ({error.strerror})", remedy) from error

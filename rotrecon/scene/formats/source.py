"""A file to be read together with the field that named it, so that every failure can say both."""

from dataclasses import dataclass
from pathlib import Path

from rotrecon.errors import SceneError

MAX_PIXELS = 64_000_000
"""Pixels or points in one file: above every stereo camera of today, and a cloud of them still fits in memory."""


@dataclass(frozen=True)
class SourceFile:
    """A file, and the field of the scene or the argument that named it."""

    path: Path
    field: str

    def error(self, problem: str, remedy: str) -> SceneError:
        """The error to raise; the sentence reads "file: field problem; remedy."."""
        return SceneError(self.path, self.field, problem, remedy)

    @property
    def ending(self) -> str:
        """The file's ending in lower case, with its dot."""
        return self.path.suffix.lower()

    @property
    def exists(self) -> bool:
        """Whether anything of that name can be seen, also where looking is not allowed."""
        try:
            return self.path.exists()
        except OSError:
            return False

    def read_bytes(self) -> bytes:
        """The whole file; raises SceneError when it is missing, not a file or not readable."""
        if not self.exists:
            raise self.error("names a file that does not exist", "add the file or correct its name")
        if not self.path.is_file():
            raise self.error("names something that is not a file", "name a regular file")
        try:
            content = self.path.read_bytes()
        except OSError as failure:
            raise self.error(f"cannot be read ({failure.strerror})", "check its permissions") from failure
        if not content:
            raise self.error("is an empty file", "copy or record it again")
        return content

    def check_count(self, count: int, unit: str) -> None:
        """Refuse a file that announces more than MAX_PIXELS, before memory is taken for it."""
        if count > MAX_PIXELS:
            raise self.error(
                f"announces {count:,} {unit}, more than the {MAX_PIXELS:,} that are read",
                "reduce its resolution, or record it again if its header is damaged",
            )

"""The one error for files that cannot be used."""

from pathlib import Path


class SceneError(Exception):
    """A file cannot be used; the message is one sentence naming the file, the field and the remedy."""

    def __init__(self, file: Path, field: str, problem: str, remedy: str) -> None:
        super().__init__(f"{file}: {field} {problem}; {remedy}.")
        self.file = file
        self.field = field

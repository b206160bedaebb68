"""The files that the browser needs and Python is not, in a checkout and in an installed wheel."""

from pathlib import Path


def static_text(name: str) -> str:
    """The text of a file in `static/`."""
    here = Path(__file__).resolve().parent
    installed = here / "static"
    return ((installed if installed.is_dir() else here.parent / "static") / name).read_text(encoding="utf-8")

"""Versions of all that a number depends on beside the data."""

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

LIBRARIES = ("numpy", "scipy", "opencv-python-headless", "trimesh", "msgspec")
"""Those that compute numbers or hold them."""


@cache
def versions() -> dict[str, str]:
    """Of the program, Python, the libraries and the machine, by name."""
    found = {name: _version(name) for name in ("rotrecon", *LIBRARIES)}
    return {**found, "python": platform.python_version(), "machine": f"{platform.system()} {platform.machine()}"}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"

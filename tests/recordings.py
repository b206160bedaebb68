"""Where the recorded scenes are: beside the checkout, never in it."""

import os
from pathlib import Path

import pytest

DATA = Path(__file__).resolve().parents[1].parent / "shared" / "data"
FRAMES = ("tin", "blue_mug", "green_bowl", "pr2_mug", "concrete_pipe")
"""Recordings whose folder is a scene with depth."""


def recording(name: str) -> Path:
    """The path of a recording, or a test that is skipped for it; where CI runs, a missing one is a failure."""
    path = DATA / name
    if not path.exists():
        message = f"the recording {name} is missing from {DATA}"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    return path

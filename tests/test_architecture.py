"""Which way dependencies point, checked in the source."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FORBIDDEN = {"app", "viser", "fastapi", "starlette", "uvicorn", "typer"}
ORDER = [
    "arrays", "camera", "primitives", "workspace", "tool_table", "settings", "frame", "drawing",
    "segmentation", "circles", "axis", "radii", "outcome", "section_fit", "tools", "reconstruct", "overlay",
]  # fmt: skip
"""The flow of data; a stage may import only what stands before it."""
STAGES = {"workspace", "drawing", "segmentation", "circles", "radii"}
"""They know the types, and not each other."""
TYPES = {"arrays", "camera", "primitives", "settings", "frame"}


def imports(path: Path) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module)
    return found


def local(path: Path) -> set[str]:
    return {name.split(".")[1] for name in imports(path) if name.startswith("rotrecon.")}


@pytest.mark.parametrize("path", sorted((ROOT / "rotrecon").rglob("*.py")), ids=lambda path: path.name)
def test_library_knows_neither_the_app_nor_a_web_framework(path):
    assert not {name.split(".")[0] for name in imports(path)} & FORBIDDEN


@pytest.mark.parametrize("name", ORDER)
def test_imports_point_up_the_flow(name):
    assert local(ROOT / "rotrecon" / f"{name}.py") & set(ORDER) <= set(ORDER[: ORDER.index(name)])


@pytest.mark.parametrize("name", sorted(STAGES))
def test_stages_know_only_the_types(name):
    assert local(ROOT / "rotrecon" / f"{name}.py") <= TYPES


def test_session_is_pure():
    assert not {name.split(".")[0] for name in imports(ROOT / "app" / "session.py")} & {"viser", "asyncio", "threading"}

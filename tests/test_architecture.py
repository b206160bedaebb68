"""Which way dependencies point, checked in the source."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FORBIDDEN = {"app", "viser", "fastapi", "starlette", "uvicorn", "typer"}
GIVEN = [
    "errors", "files", "arrays", "camera", "primitives", "workspace", "tool_table", "settings", "frame", "drawing",
    "outcome", "noise",
]  # fmt: skip
PROPOSED_AXIS = ["planes", "foreground", "stroke_ends", "mirror", "hollow", "axis_proposal", "axis_direction"]
SEGMENTED = ["segmentation", "circles", "axis", "tools", "reconstruction", "section_cuts"]
BY_SECTIONS = ["radii", "section_fit", "by_sections"]
FITTED = [
    "surfaces", "patch", "correlation", "fitting", "ray_fit", "coarse_fit", "starts", "edge_lines", "edge_steps",
    "edges", "limbs", "guard", "hypotheses", "robust",
]  # fmt: skip
TURNED = [
    "lines", "turned", "extent", "looks", "height_radii", "profile", "parts", "smoothness", "turned_start",
    "turned_fit",
]  # fmt: skip
JUDGED = ["intervals", "recognition", "soundness", "judgement", "section_radii", "by_rays"]
BY_RAYS = [*FITTED, *TURNED, *JUDGED]
SHOWN = ["answer", "curves", "overlay", "mesh"]
ORDER = [*GIVEN, *PROPOSED_AXIS, *SEGMENTED, *BY_SECTIONS, *BY_RAYS, "reconstruct", *SHOWN]
"""The flow of data; a stage may import only what stands before it."""
STAGES = {
    "workspace", "drawing", "segmentation", "circles", "radii", "noise", "planes", "surfaces", "correlation",
    "edge_lines", "starts", "tools",
}  # fmt: skip
"""They know the types, and not each other."""
TYPES = {
    "arrays", "camera", "primitives", "settings", "frame", "drawing", "outcome", "tool_table", "surfaces", "patch",
}  # fmt: skip


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


def test_every_module_has_its_place_in_the_flow():
    assert sorted(ORDER) == sorted(path.stem for path in (ROOT / "rotrecon").glob("[!_]*.py"))


def test_the_two_methods_share_what_is_segmented_and_not_their_own_stages():
    for name in BY_RAYS:
        assert not local(ROOT / "rotrecon" / f"{name}.py") & (set(BY_SECTIONS) - {"radii"}), name
    for name in BY_SECTIONS:
        assert not local(ROOT / "rotrecon" / f"{name}.py") & set(BY_RAYS), name


@pytest.mark.parametrize("name", ORDER)
def test_measuring_knows_neither_scene_folders_nor_simulations(name):
    assert not local(ROOT / "rotrecon" / f"{name}.py") & {"scene", "simulation"}


@pytest.mark.parametrize("name", ORDER)
def test_imports_point_up_the_flow(name):
    assert local(ROOT / "rotrecon" / f"{name}.py") & set(ORDER) <= set(ORDER[: ORDER.index(name)])


@pytest.mark.parametrize("name", sorted(STAGES))
def test_stages_know_only_the_types(name):
    assert local(ROOT / "rotrecon" / f"{name}.py") <= TYPES


def test_session_is_pure():
    assert not {name.split(".")[0] for name in imports(ROOT / "app" / "session.py")} & {"viser", "asyncio", "threading"}

"""Which way dependencies point, checked in the source."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FORBIDDEN = {"app", "viser", "fastapi", "starlette", "uvicorn", "typer"}
GIVEN = """
    errors files arrays compiled camera primitives contact workspace tool_table settings frame drawing outcome noise
    reading
""".split()
MATCHED = """
    stereo.rectification stereo.canvas stereo.disparity_noise stereo.matching stereo.carrying stereo.limits
    stereo.scouting stereo.features stereo.epipolar stereo.exposure stereo.geometry stereo.preparing stereo.fusion
    stereo.frames capture
""".split()
PROPOSED_AXIS = """
    stroke.planes stroke.foreground stroke.stroke_ends stroke.mirror stroke.hollow stroke.axis_proposal
    stroke.axis_direction
""".split()
SEGMENTED = """
    segmentation circles axis objections tools reconstruction sections.section_cuts
""".split()
BY_SECTIONS = """
    sections.radii sections.section_fit sections.by_sections
""".split()
FITTED = """
    rays.traces rays.lateral_rays rays.lateral rays.ball_rays rays.ball rays.surfaces rays.patch rays.correlation
    rays.losses rays.fitting rays.passing rays.whitening rays.covariance rays.ray_fit rays.doubting
    rays.coarse_fit rays.starts
    edges.light edges.line_loops edges.edge_lines edges.shading edges.step_likelihood edges.edge_model
    edges.edge_steps edges.edges
    rays.limbs rays.guard rays.hypotheses rays.outlined_fit rays.robust
""".split()
TURNED = """
    rays.lines turned.turned extent turned.look_rays turned.looks turned.height_radii turned.profile
    turned.runs turned.parts turned.smoothness turned.turned_start turned.turned_fit
""".split()
PHOTOMETRY = """
    photometry.splines photometry.carrying photometry.agreement photometry.visible photometry.smearing
    photometry.matches photometry.outlines photometry.sharpening photometry.sureness photometry.contest
    photometry.climbing photometry.scanning photometry.drawn photometry.refinement
""".split()
JUDGED = """
    two_objects intervals recognition by_pictures soundness judgement section_radii found by_rays calibration
    stroke.correction
""".split()
BY_RAYS = [*FITTED, *TURNED, *PHOTOMETRY, *JUDGED]
SHOWN = """
    clearance envelope grasp free_contact predicted_interval next_view answer curves overlay mesh line_stages residuals
    grasp_overlay distance
""".split()
ORDER = [*GIVEN, *MATCHED, *PROPOSED_AXIS, *SEGMENTED, *BY_SECTIONS, *BY_RAYS, "reconstruct", *SHOWN]
"""The flow of data; a stage may import only what stands before it."""
STAGES = set(
    """
    workspace drawing segmentation circles sections.radii noise stroke.planes rays.correlation
    edges.edge_lines rays.starts objections
""".split()
)
"""They know the types, and not each other."""
TYPES = set(
    """
    arrays compiled camera primitives contact settings frame drawing outcome reading tool_table
    rays.traces rays.lateral_rays rays.lateral rays.ball_rays rays.ball rays.surfaces rays.patch edges.line_loops
""".split()
)


def imports(path: Path) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module)
    return found


def local(path: Path) -> set[str]:
    return {name.removeprefix("rotrecon.") for name in imports(path) if name.startswith("rotrecon.")}


def source(name: str) -> Path:
    return (ROOT / "rotrecon").joinpath(*name.split(".")).with_suffix(".py")


@pytest.mark.parametrize("path", sorted((ROOT / "rotrecon").rglob("*.py")), ids=lambda path: path.name)
def test_library_knows_neither_the_app_nor_a_web_framework(path):
    assert not {name.split(".")[0] for name in imports(path)} & FORBIDDEN


def test_every_module_has_its_place_in_the_flow():
    library = ROOT / "rotrecon"
    modules = [
        path.relative_to(library)
        for path in library.rglob("[!_]*.py")
        if path.relative_to(library).parts[0] not in ("scene", "simulation")
    ]
    assert sorted(ORDER) == sorted(".".join(path.with_suffix("").parts) for path in modules)


def test_the_two_methods_share_what_is_segmented_and_not_their_own_stages():
    for name in BY_RAYS:
        assert not local(source(name)) & (set(BY_SECTIONS) - {"sections.radii"}), name
    for name in BY_SECTIONS:
        assert not local(source(name)) & set(BY_RAYS), name


@pytest.mark.parametrize("name", ORDER)
def test_measuring_knows_neither_scene_folders_nor_simulations(name):
    assert not {module.split(".")[0] for module in local(source(name))} & {"scene", "simulation"}


@pytest.mark.parametrize("name", ORDER)
def test_imports_point_up_the_flow(name):
    assert local(source(name)) & set(ORDER) <= set(ORDER[: ORDER.index(name)])


@pytest.mark.parametrize("name", sorted(STAGES))
def test_stages_know_only_the_types(name):
    assert local(source(name)) <= TYPES


PURE = [
    *(ROOT / "app" / f"{name}.py" for name in ("session", "session_state", "drawing_steps", "events", "decision_text")),
    *sorted((ROOT / "app" / "deciding").glob("*.py")),
]


@pytest.mark.parametrize("path", PURE, ids=lambda path: path.stem)
def test_session_and_decision_are_pure(path):
    """No view, no threads, and no clock but that of the events."""
    impure = {"viser", "asyncio", "threading", "time", "sqlite3"}
    assert not {name.split(".")[0] for name in imports(path)} & impure
    assert not imports(path) & {"app.clock", "app.console", "app.record.store"}

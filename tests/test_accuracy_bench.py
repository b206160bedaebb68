"""The accuracy benchmark itself: its bound, its clouds, its mistakes, its peers and its document."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares
from typer.testing import CliRunner

from app.bench.accuracy import document, peers
from app.bench.accuracy.bound import cramer_rao, derivatives, near_depth
from app.bench.accuracy.clouds import (
    CAMERA,
    CORRELATED,
    FOCAL_BASELINE,
    OUTLIER_PX,
    WHITE,
    Cell,
    Cloud,
    cloud_of,
    inside,
    pose_of,
)
from app.bench.accuracy.misdrawn import AREA_TWICE, MISTAKES, misdrawn, width_px
from app.bench.accuracy.outcome import TRUE_KINDS, Outcome
from app.bench.accuracy.statistics import coverage, errors, far_off_count, radius_coverage, refused_share
from app.bench.accuracy.trials import Plan
from app.bench.accuracy.unanswerable import AREAS
from app.cli import cli
from rotrecon.primitives import Frustum, Sphere
from rotrecon.simulation.raycast import first_hit


def exact(name: str, seed: int = 0) -> Cloud:
    return cloud_of(pose_of(name, seed), Cell("white", 1e-6))


@pytest.mark.parametrize("name", TRUE_KINDS)
def test_bound_s_derivatives_are_those_of_the_ray_cast_depth(name):
    pose = pose_of(name, 3)
    known = derivatives(pose)
    v, u = np.nonzero(known.pixel)
    rays = CAMERA.unproject(np.stack([u, v], axis=-1), np.ones(len(u)))
    front = pose.from_middle_rad[known.pixel] < np.radians(60)
    step_m, size = 1e-6, 3 if isinstance(pose.solid, Sphere) else 4
    depth = [cast(grown(pose.solid, by), rays) for by in (-step_m, step_m)]
    by_size = (FOCAL_BASELINE / depth[1] - FOCAL_BASELINE / depth[0]) / (2 * step_m)
    np.testing.assert_allclose(known.of_disparity[front, size], by_size[front], rtol=1e-5)
    moved_rays = [cast(moved(pose.solid, by), rays) for by in (-step_m, step_m)]
    by_place = (FOCAL_BASELINE / moved_rays[1] - FOCAL_BASELINE / moved_rays[0]) / (2 * step_m)
    unknowns = np.linalg.lstsq(known.of_disparity[front], by_place[front], rcond=None)
    assert (
        np.abs(known.of_disparity[front] @ unknowns[0] - by_place[front]).max() < 1e-4 * np.abs(by_place[front]).max()
    )


def grown(solid: Frustum | Sphere, by_m: float) -> Frustum | Sphere:
    return replace(solid, radius_m=solid.radius_m + by_m)


def moved(solid: Frustum | Sphere, by_m: float) -> Frustum | Sphere:
    """Sideways, which is a mixture of the bound's unknowns, whatever they are."""
    return replace(solid, center_m=solid.center_m + np.array([by_m, 0, 0]))


def cast(solid: Frustum | Sphere, rays: np.ndarray) -> np.ndarray:
    across = np.cross(solid.direction, [0.6, 0.0, 0.8])
    across /= np.linalg.norm(across)
    axes = np.stack([across, np.cross(solid.direction, across), solid.direction], axis=1)
    return first_hit(solid, -solid.center_m @ axes, rays @ axes)


@pytest.mark.parametrize("name", ["leg", "cone", "ball"])
def test_least_squares_in_disparity_reach_the_bound(name):
    """They are the maximum-likelihood estimate from the same pixels: as good as the bound, and no better."""
    scaled: list[float] = []
    for seed in range(8):
        pose = pose_of(name, seed)
        cloud = cloud_of(pose, Cell("white", 0.25, 0.0, 120.0))
        known, solid = derivatives(pose), pose.solid
        v, u = np.nonzero(cloud.own)
        rays = CAMERA.unproject(np.stack([u, v], axis=-1), np.ones(len(u)))
        seen, count = FOCAL_BASELINE / cloud.frame.depth_m[cloud.own].astype(np.float64), known.of_disparity.shape[1]
        jacobian = known.of_disparity[cloud.own[known.pixel]]

        def residual(change, solid=solid, rays=rays, seen=seen, count=count):
            return FOCAL_BASELINE / near_depth(solid, np.pad(change, (0, 6 - count)), rays) - seen

        change = least_squares(residual, np.zeros(count), x_scale="jac").x
        size = 3 if name == "ball" else 4
        sigma = 0.25 * np.sqrt(np.linalg.inv(jacobian.T @ jacobian)[size, size])
        scaled.append(change[size] / sigma)
        if name != "cone":
            assert sigma / solid.radius_m == pytest.approx(cramer_rao(cloud, known).radius)
    assert 0.6 < np.sqrt(np.mean(np.square(scaled))) < 1.5


def test_cells_have_the_noise_the_outliers_and_the_arc_they_name():
    pose = pose_of("pipe", 1)
    exact_px = FOCAL_BASELINE / pose.simulated.view.depth_m
    cloud = cloud_of(pose, Cell("white", 0.5, 0.2, 120.0))
    error_px = (FOCAL_BASELINE / cloud.frame.depth_m - exact_px)[cloud.surface]
    own_px = (FOCAL_BASELINE / cloud.frame.depth_m - exact_px)[cloud.own]
    assert own_px.std() == pytest.approx(0.5, rel=0.05)
    assert cloud.own.sum() / cloud.surface.sum() == pytest.approx(0.8, abs=0.02)
    assert 4.5 < np.abs(error_px).max() < OUTLIER_PX + 1e-3
    assert np.degrees(pose.from_middle_rad[cloud.surface].max()) == pytest.approx(60, abs=1)
    assert not np.isfinite(cloud.frame.depth_m[pose.from_middle_rad > np.radians(60.1)]).any()
    assert cloud.frame.noise is None
    assert not cloud.frame.image.any()


@pytest.mark.parametrize("cell", CORRELATED)
def test_both_readings_of_a_kernel_have_its_size_and_reach(cell):
    pose = pose_of("ball", 0)
    view = pose.simulated.view
    error_px = FOCAL_BASELINE / cloud_of(pose, cell).frame.depth_m - FOCAL_BASELINE / view.depth_m
    assert error_px.std() == pytest.approx(cell.sigma_px, rel=0.05)
    alike = [float((error_px[:, :-lag] * error_px[:, lag:]).mean()) / cell.sigma_px**2 for lag in (2, 4, 9)]
    expected = np.exp([-0.25, -1, -81 / 16]) if cell.noise == "length" else [0.5, 0, 0]
    np.testing.assert_allclose(alike, expected, atol=0.08)


def test_own_pixels_lie_in_what_was_drawn_and_caps_are_not_among_them():
    for name in TRUE_KINDS:
        pose = pose_of(name, 2)
        cloud = cloud_of(pose, WHITE[0])
        assert cloud.own.sum() > 1000
        assert not (cloud.own & ~inside(cloud.drawing)).any()
        assert not (cloud.own & ~pose.lateral).any()
        assert cloud_of(pose, WHITE[0]).frame.points_m.tobytes() == cloud.frame.points_m.tobytes()
        assert cloud_of(pose, WHITE[0], draw=1).drawing != cloud.drawing


def test_statistics_are_those_of_what_was_measured():
    outcomes = [Outcome(value, value, radius_interval=(value - 0.02, value + 0.02)) for value in (0.01, -0.03, 0.2)]
    outcomes.append(Outcome())
    assert refused_share(outcomes) == 0.25
    assert far_off_count(outcomes) == 1
    found = radius_coverage(outcomes)
    assert (found.count, found.covered, found.half_width) == (3, pytest.approx(1 / 3), pytest.approx(2))
    size = errors(np.array([0.03, -0.01, np.nan]))
    assert (size.bias, size.rms) == (pytest.approx(1), pytest.approx(np.sqrt(5)))
    assert coverage(np.array([0.1]), np.full((1, 2), np.nan)).count == 0


@pytest.mark.parametrize("name", TRUE_KINDS)
def test_mistakes_in_a_drawing_are_as_large_as_they_are_called(name):
    simulated, size_px = pose_of(name, 1).simulated, (CAMERA.width, CAMERA.height)
    drawing, solid = simulated.drawing, simulated.solid_in_camera
    bad = misdrawn(drawing, width_px(drawing), size_px)
    assert tuple(bad) == MISTAKES
    good, strokes = ends(drawing), [ends(bad[mistake]) for mistake in MISTAKES]
    turned, short, beside, _ = (stroke[1] - stroke[0] for stroke in strokes)
    along = good[1] - good[0]
    assert np.degrees(np.arccos(along @ turned / np.linalg.norm(along) / np.linalg.norm(turned))) == pytest.approx(10)
    np.testing.assert_allclose(short, 0.7 * along)
    np.testing.assert_allclose(beside, along)
    shift = strokes[2][0] - good[0]
    assert abs(shift @ along) < 1e-6
    assert np.linalg.norm(shift) == pytest.approx(0.2 * width_px(drawing))
    assert 0.7 < width_px(drawing) / (2 * solid.radius_m * CAMERA.focal_px / solid.center_m[2]) < 1.15
    spread = [np.ptp(np.array(each.area.vertices_px), axis=0) for each in (drawing, bad[AREA_TWICE])]
    assert (spread[1] <= np.sqrt(2) * spread[0] + 0.01).all()
    assert (spread[1] > spread[0]).any()


def ends(drawing) -> np.ndarray:
    return np.array([drawing.stroke.start_px, drawing.stroke.end_px])


@pytest.mark.parametrize("name", TRUE_KINDS)
def test_orthogonal_least_squares_are_exact_on_exact_depth(name):
    found = peers.orthogonal_least_squares(exact(name))
    assert abs(found.radius) < 1e-4
    if name == "cone":
        assert abs(found.half_angle) < 1e-4


@pytest.mark.parametrize(
    ("package", "peer", "names", "within"),
    [
        ("skimage", peers.scikit_image, ("leg", "pipe"), 1e-3),
        ("meshlib", peers.meshlib, ("pipe", "ball", "cone"), 1e-2),
        ("pyransac3d", peers.pyransac3d, ("ball",), 1e-2),
    ],
)
def test_peers_are_near_on_exact_depth(package, peer, names, within):
    pytest.importorskip(package)
    for name in names:
        found = peer(exact(name))
        assert found is not None
        assert abs(found.radius) < within


def test_package_that_is_missing_is_named_with_its_remedy(monkeypatch):
    monkeypatch.setattr(peers, "import_module", missing_module)
    with pytest.raises(peers.PeerMissing, match=r"pyransac3d.* is not installed; run pip install"):
        peers.require_peers()


def missing_module(name: str) -> None:
    raise ImportError(name)


def test_document_puts_figures_beside_what_is_asked():
    plan = Plan("paper", poses=1, draws=1, matched_draws=1, compared=False, supersampling=1, objects=("leg", "cone"))
    extent = document.Extent(plan, misdrawn_poses=1, areas=AREAS[:1], runs=1, processes=1)
    text = document.accuracy_document(extent=extent)
    assert "nan" not in text
    assert "Not measured: no folder of recordings was named." in text
    for part in (
        "## White noise",
        "### Leg",
        "### Cone",
        "## Intervals",
        "## Kinds",
        "## Nothing round",
        "## Careless drawings",
        "## Speed",
    ):
        assert part in text
    assert text.count("NOT REACHED") > 5, "one pose by the paper's method reaches next to nothing"


def test_command_writes_the_document_or_names_the_package_that_is_missing(monkeypatch, tmp_path):
    out, asked = tmp_path / "accuracy.md", []

    def written(recordings: Path | None) -> str:
        asked.append(recordings)
        if recordings is None:
            raise peers.PeerMissing("MeshLib is not installed; run pip")
        return "# How accurate it is\n"

    monkeypatch.setattr(document, "accuracy_document", written)
    refused = CliRunner().invoke(cli, ["bench", "--accuracy", str(out)])
    assert (refused.exit_code, out.exists()) == (2, False)
    assert refused.stderr == "rotrecon: MeshLib is not installed; run pip\n"
    done = CliRunner().invoke(cli, ["bench", "--accuracy", str(out), "--recordings", str(tmp_path)])
    assert (done.exit_code, out.read_text()) == (0, "# How accurate it is\n")
    assert asked == [None, tmp_path]

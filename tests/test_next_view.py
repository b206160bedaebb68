"""Where the camera should go next: what narrows an interval, and whether what was predicted is what comes of it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from rotrecon.camera import inverse
from rotrecon.frame import Frame, StereoNoise
from rotrecon.next_view import NEARNESSES, moved_round, next_view
from rotrecon.outcome import Fit
from rotrecon.predicted_interval import predicted_half_width
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.simulation.ideal_drawing import ideal_drawing
from rotrecon.simulation.rendering import render
from rotrecon.simulation.simulate import Simulated, simulate
from rotrecon.simulation.stereo_noise import StereoErrors, stereo_depth
from rotrecon.workspace import Workspace

ERRORS = StereoErrors(window_px=1, half_occlusion=False, hole_share=0.0)
"""Noise alone: what windows smear at the limbs makes intervals wider by chance, and no prediction knows of that."""
AGREES = 1.5


@cache
def scene(name: str) -> Simulated:
    return simulate(name, 0, noise=ERRORS, supersampling=1)


def measured(frame: Frame, scene: Simulated) -> Reconstruction:
    """Without a picture: which of the outline's edges can be trusted is another matter in every view."""
    blank = replace(frame, image=np.zeros_like(frame.image))
    drawing = ideal_drawing(scene.solid.moved(inverse(frame.T_base_camera)), frame.camera)
    return reconstruct(blank, drawing, Settings())


@cache
def present(name: str) -> Reconstruction:
    return measured(scene(name).frame, scene(name))


def moved(result: Reconstruction, angle_deg: float, nearness: float) -> np.ndarray:
    assert result.solid is not None
    return moved_round(result.frame.T_base_camera, result.solid, float(np.deg2rad(angle_deg)), nearness)


def predicted_mm(result: Reconstruction, angle_deg: float, nearness: float) -> float:
    half_width_m = predicted_half_width(result, moved(result, angle_deg, nearness))
    assert half_width_m is not None
    return 1000 * half_width_m


def half_width_mm(result: Reconstruction) -> float:
    assert isinstance(result.fit, Fit)
    assert result.fit.intervals is not None
    low_m, high_m = result.fit.intervals.diameter_m
    return 500 * (high_m - low_m)


@pytest.mark.parametrize(("name", "angle_deg", "nearness"), [("pipe", -30, 0.85), ("ball", 25, 0.7)])
def test_what_is_predicted_is_what_a_measurement_from_there_has(name: str, angle_deg: float, nearness: float) -> None:
    before, here = present(name), scene(name)
    pose = moved(before, angle_deg, nearness)
    view = render(here.world, here.frame.camera, pose, 1)
    depth_m = stereo_depth(view, ERRORS, np.random.default_rng(5))
    noise = StereoNoise(ERRORS.baseline_m, ERRORS.disparity_sigma_px)
    after = measured(Frame(view.image, here.frame.camera.cloud(depth_m), here.frame.camera, pose, noise), here)
    ratio = predicted_mm(before, angle_deg, nearness) / half_width_mm(after)
    assert 1 / AGREES < ratio < AGREES


@pytest.mark.parametrize("name", ["pipe", "ball"])
def test_nearer_is_better_and_staying_changes_nothing(name: str) -> None:
    result = present(name)
    widths = [predicted_mm(result, 0, nearness) for nearness in sorted(NEARNESSES)]
    assert widths == sorted(widths)
    assert predicted_mm(result, 0, 1.0) == pytest.approx(half_width_mm(result))


def behind_a_post(result: Reconstruction, side: int) -> Reconstruction:
    """The same measurement, in a cloud that has a post before one half of the object; 1 is right in the picture."""
    frame, fit = result.frame, result.fit
    assert isinstance(fit, Fit)
    camera = frame.camera
    v, u = np.indices(frame.depth_m.shape)
    line = camera.project(fit.solid.center_m + np.outer([0.0, 0.1], fit.solid.direction))
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    across = np.array([-along[1], along[0]])
    across *= np.sign(across[0])
    beside_px = (np.stack([u, v], axis=-1) - line[0]) @ across * side
    radius_px = float(fit.solid.radius_at(0.0)) * camera.focal_px / fit.solid.center_m[2]
    depth_m = frame.depth_m.copy()
    depth_m[(beside_px > 0.2 * radius_px) & (beside_px < 3 * radius_px)] = 0.85 * fit.solid.center_m[2]
    return replace(result, frame=replace(frame, points_m=camera.cloud(depth_m)), sections=None)


@pytest.mark.parametrize("side", [-1, 1])
def test_from_the_side_of_the_missing_arc_more_is_known(side: int) -> None:
    result = behind_a_post(present("pipe"), side)
    assert result.solid is not None
    T = result.frame.T_base_camera
    turned = {angle: moved(result, angle, 1.0) for angle in (-30.0, 30.0)}
    right = {angle: float(T[:3, 0] @ (pose[:3, 3] - T[:3, 3])) for angle, pose in turned.items()}
    free_side, post_side = sorted(turned, key=lambda angle: side * right[angle])
    assert predicted_mm(result, free_side, 1.0) < 0.7 * predicted_mm(result, post_side, 1.0)
    best = next_view(result)
    assert best is not None
    assert best.best.angle_rad * free_side > 0
    assert best.best.toward in ("left", "right", "up", "down")


def test_only_places_that_the_arm_reaches_are_named() -> None:
    result = present("pipe")
    free = next_view(result)
    assert free is not None
    assert free.best.half_width_m < free.now_m
    away_m = float(np.linalg.norm(result.frame.T_base_camera[:3, 3]))
    short = replace(result.frame, workspace=Workspace(reach_m=(0.0, away_m + 0.01)))
    held = next_view(replace(result, frame=short))
    assert held is not None
    assert held.beyond_reach > 0
    assert len(held.tried) + held.beyond_reach >= len(free.tried)
    assert all(np.linalg.norm(view.T_base_camera[:3, 3]) <= away_m + 0.01 for view in held.tried)
    nowhere = replace(result.frame, workspace=Workspace(reach_m=(50.0, 60.0)))
    assert next_view(replace(result, frame=nowhere)) is None


def test_the_papers_method_has_no_interval_to_predict() -> None:
    here = scene("pipe")
    assert next_view(reconstruct(here.frame, here.drawing, Settings(method="paper"))) is None

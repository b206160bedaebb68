"""The arm's limits as lines: they lie where the pre-selection stops taking points."""

import numpy as np

from app.limit_lines import limit_lines
from rotrecon.camera import PinholeCamera, inverse, transform
from rotrecon.workspace import Workspace, available

REACH_M, BOX_M, DEPTH_M = (0.2, 1.1), np.array([[-1.0, -1.0, 0.0], [1.0, 1.0, 1.5]]), (0.3, 2.0)
CAMERA = PinholeCamera(64, 48, np.array([[60.0, 0, 30.0], [0, 61.0, 25.0], [0, 0, 1]]))
T_BASE_CAMERA = np.array([[0.0, -0.6, 0.8, 0.2], [-1, 0, 0, 0.1], [0, -0.8, -0.6, 0.9], [0, 0, 0, 1]])
INSIDE, OUTSIDE = 1 - 1e-3, 1 + 1e-3


def lines(workspace: Workspace) -> dict[str, np.ndarray]:
    return limit_lines(workspace, CAMERA, T_BASE_CAMERA)


def taken(points_m: np.ndarray, workspace: Workspace) -> np.ndarray:
    """Which points (..., 3) in base coordinates the pre-selection takes."""
    in_camera = transform(inverse(T_BASE_CAMERA), points_m).astype(np.float32)
    return available(in_camera, T_BASE_CAMERA, workspace)


def test_the_reach_is_drawn_as_circles_round_the_base() -> None:
    workspace = Workspace(reach_m=REACH_M)
    drawn = lines(workspace)
    assert set(drawn) == {"reach"}
    distance = np.linalg.norm(drawn["reach"], axis=-1)
    assert sorted({round(float(value), 6) for value in distance.ravel()}) == list(REACH_M)
    outer = drawn["reach"][distance[:, 0] > 1]
    assert taken(INSIDE * outer, workspace).all()
    assert not taken(OUTSIDE * outer, workspace).any()


def test_the_depth_is_drawn_as_two_rectangles_across_the_picture() -> None:
    workspace = Workspace(depth_m=DEPTH_M)
    drawn = lines(workspace)
    assert set(drawn) == {"depth"}
    in_camera = transform(inverse(T_BASE_CAMERA), drawn["depth"])
    assert drawn["depth"].shape == (8, 2, 3)
    assert np.allclose(in_camera[:4, :, 2], DEPTH_M[0])
    assert np.allclose(in_camera[4:, :, 2], DEPTH_M[1])
    pixels = CAMERA.project(in_camera).reshape(-1, 2)
    assert np.allclose(pixels.min(axis=0), -0.5)
    assert np.allclose(pixels.max(axis=0), (CAMERA.width - 0.5, CAMERA.height - 0.5))


def test_the_box_is_drawn_by_its_edges() -> None:
    drawn = lines(Workspace(box_m=BOX_M))
    assert set(drawn) == {"box"}
    assert drawn["box"].shape == (12, 2, 3)
    assert np.array_equal(drawn["box"].reshape(-1, 3).min(axis=0), BOX_M[0])
    assert np.array_equal(drawn["box"].reshape(-1, 3).max(axis=0), BOX_M[1])


def test_what_is_not_limited_is_not_drawn() -> None:
    assert lines(Workspace()) == {}
    assert set(lines(Workspace(REACH_M, BOX_M, DEPTH_M))) == {"reach", "box", "depth"}

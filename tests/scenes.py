"""A small scene folder for tests, right in everything until a test changes it."""

from copy import deepcopy
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from rotrecon.camera import PinholeCamera
from rotrecon.errors import SceneError
from rotrecon.frame import Frame
from rotrecon.scene.formats.image import encode_png
from rotrecon.scene.formats.npz import encode_npz
from rotrecon.scene.reading import read_scene

WIDTH, HEIGHT = 8, 6
CAMERA = PinholeCamera(WIDTH, HEIGHT, np.array([[10.0, 0, 3.5], [0, 11.0, 2.5], [0, 0, 1]]))
TURNED = [[0.0, -1.0, 0.0, 0.1], [1.0, 0.0, 0.0, 0.2], [0.0, 0.0, 1.0, 0.3], [0.0, 0.0, 0.0, 1.0]]


def sample_frame() -> Frame:
    depth = np.linspace(0.5, 1.5, WIDTH * HEIGHT, dtype=np.float32).reshape(HEIGHT, WIDTH)
    return Frame(np.full((HEIGHT, WIDTH, 3), 90, np.uint8), CAMERA.cloud(depth), CAMERA)


def table() -> dict[str, Any]:
    """A scene.toml with everything that may stand in one with a frame."""
    return {
        "format": 1,
        "name": "a scene",
        "cameras": {"main": {"size": [WIDTH, HEIGHT], "K": CAMERA.K.tolist(), "distortion": []}},
        "frame": {
            "camera": "main",
            "image": "image.png",
            "depth": "depth.npz",
            "T_base_camera": deepcopy(TURNED),
            "captured_at": datetime(2026, 1, 31, tzinfo=UTC),
            "noise": {"model": "stereo", "baseline_m": 0.09, "disparity_sigma_px": 0.15},
        },
        "workspace": {"reach_m": [0.1, 1.5], "box_m": [[-1, -1, 0], [1, 1, 1]], "depth_m": [0.2, 3.0]},
    }


def with_views(*changes: dict[str, Any]) -> dict[str, Any]:
    scene = table()
    del scene["frame"]
    scene["views"] = [{"image": "image.png", "camera": "main", "T_base_camera": TURNED} | change for change in changes]
    return scene


def save(folder: Path, scene: dict[str, Any], **files: bytes) -> Path:
    depth = sample_frame().depth_m
    contents = {
        "image.png": encode_png(sample_frame().image),
        "depth.npz": encode_npz(depth_m=depth),
        "depth.png": encode_png(np.rint(depth * 1000).astype(np.uint16)),
        "cloud.npz": encode_npz(points_m=CAMERA.cloud(depth)),
        "flat.npz": encode_npz(points_m=CAMERA.cloud(depth).reshape(-1, 3)),
        "small.png": encode_png(np.zeros((2, 3, 3), np.uint8)),
        "small.npz": encode_npz(depth_m=np.ones((2, 3))),
        "empty.npz": encode_npz(depth_m=np.zeros((HEIGHT, WIDTH))),
        "slanted.npz": encode_npz(points_m=CAMERA.cloud(depth) + np.array([1, 0, 0], np.float32)),
        "cut.png": encode_png(sample_frame().image)[:-20],
        "cut.npz": encode_npz(depth_m=depth)[:-20],
        "scene.toml": tomli_w.dumps(scene).encode(),
    }
    for name, content in (contents | files).items():
        (folder / name).write_bytes(content)
    return folder


def assert_refused(folder: Path, words: str) -> None:
    with pytest.raises(SceneError) as refusal:
        read_scene(folder)
    message = str(refusal.value)
    assert message.startswith(str(folder))
    assert words in message
    assert "; " in message
    assert message.endswith(".")

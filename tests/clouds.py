"""Small clouds for tests, and the files of others that hold them."""

from pathlib import Path

import numpy as np
from plyfile import PlyData, PlyElement
from pypcd4 import Encoding, PointCloud

from rotrecon.scene.formats.source import SourceFile

SHAPE = (4, 5, 3)


def source(path: Path) -> SourceFile:
    return SourceFile(path, "the field")


def packed(colors: np.ndarray, alpha: int = 0) -> np.ndarray:
    red, green, blue = colors.reshape(-1, 3).astype(np.uint32).T
    return np.uint32(alpha) << np.uint32(24) | red << 16 | green << 8 | blue


def write_pcd(path: Path, points: np.ndarray, colors: np.ndarray, encoding: Encoding) -> Path:
    columns = [*points.reshape(-1, 3).T, packed(colors)]
    cloud = PointCloud.from_points(columns, ("x", "y", "z", "rgb"), (np.float32,) * 3 + (np.uint32,))
    cloud.metadata.width, cloud.metadata.height = points.shape[1], points.shape[0]
    cloud.metadata.viewpoint = (1.0, 2.0, 3.0, 0.0, 1.0, 0.0, 0.0)
    cloud.save(path, encoding)
    return path


def write_ply(path: Path, points: np.ndarray, colors: np.ndarray, **how: object) -> Path:
    vertices = np.empty(
        points.size // 3, [(axis, "f4") for axis in "xyz"] + [(c, "u1") for c in ("red", "green", "blue")]
    )
    for index, (axis, color) in enumerate(zip("xyz", ("red", "green", "blue"), strict=True)):
        vertices[axis], vertices[color] = points.reshape(-1, 3)[:, index], colors.reshape(-1, 3)[:, index]
    elements = [PlyElement.describe(vertices, "vertex"), *how.pop("elements", [])]
    PlyData(elements, **how).write(path)
    return path


def sample() -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(3)
    return random.uniform(0.5, 2, SHAPE).astype(np.float32), random.integers(0, 256, SHAPE, dtype=np.uint8)

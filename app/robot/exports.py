"""The scene and the model as files, in base coordinates, metres."""

from typing import Literal

import numpy as np
import trimesh

from rotrecon.camera import transform
from rotrecon.frame import Frame
from rotrecon.mesh import as_mesh
from rotrecon.primitives import Primitive

FileFormat = Literal["glb", "ply"]
MEDIA_TYPES: dict[FileFormat, str] = {"glb": "model/gltf-binary", "ply": "application/octet-stream"}


def scene_file(frame: Frame, form: FileFormat) -> bytes:
    """The frame's points with their colours."""
    seen = np.isfinite(frame.depth_m)
    points = transform(frame.T_base_camera, frame.points_m[seen].astype(np.float64))
    return _file(trimesh.PointCloud(points.astype(np.float32), frame.image[seen]), form)


def model_file(solid: Primitive, form: FileFormat) -> bytes:
    """The fitted solid as a closed mesh."""
    return _file(as_mesh(solid), form)


def _file(shape: trimesh.Trimesh | trimesh.PointCloud, form: FileFormat) -> bytes:
    content = trimesh.Scene(shape).export(file_type="glb") if form == "glb" else shape.export(file_type="ply")
    assert isinstance(content, bytes)
    return content

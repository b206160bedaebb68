"""What must hold in a scene.toml beyond the types of its fields."""

from pathlib import Path

import msgspec
import numpy as np

from rotrecon.arrays import Floats
from rotrecon.camera import is_rigid
from rotrecon.errors import SceneError
from rotrecon.scene.formats.depth_limits import FARTHEST_M
from rotrecon.scene.formats.source import MAX_PIXELS
from rotrecon.scene.lens import COEFFICIENT_COUNTS
from rotrecon.scene.schema import (
    EXAMPLES,
    CameraTable,
    DepthNoiseTable,
    FrameTable,
    SceneTable,
    ViewTable,
    WorkspaceTable,
)

FOCAL_LENGTHS_PER_SIDE = (0.05, 1000.0)
"""Focal lengths in larger sides of the picture, from beyond any fisheye to beyond any telescope: a focal length in
millimetres or as a part of the picture falls outside."""

MOST_UNEQUAL = 4.0
"""Ratio of the two focal lengths: pixels are square, or nearly so."""
PRINCIPAL_POINT_SIDES = 5.0
"""How far from the picture's middle the principal point may lie, in sides: crops and tilted lenses move it."""


def check_scene(file: Path, scene: SceneTable) -> None:
    """Check every rule that types cannot say; `file` is only named in errors. Raises SceneError."""
    if not scene.name.strip():
        raise SceneError(file, "name", "is empty", "write a name that an operator can tell it by")
    for name, camera in scene.cameras.items():
        _check_camera(file, f"cameras.{name}", camera)
    if (scene.frame is None) == (not scene.views):
        state = "are both missing" if scene.frame is None else "are both there"
        raise SceneError(file, "[frame] and [[views]]", state, "keep one: a frame with depth, or two or more views")
    if scene.frame is not None:
        _check_frame(file, scene.frame, scene.cameras)
    if len(scene.views) == 1:
        raise SceneError(file, "[[views]]", "has a single view", "add a second view, or give a [frame] with depth")
    for index, view in enumerate(scene.views):
        _check_use(file, f"views[{index}]", view, scene.cameras)
    _check_workspace(file, scene.workspace)


def _check_camera(file: Path, field: str, camera: CameraTable) -> None:
    width, height = camera.size
    if width < 1 or height < 1 or width * height > MAX_PIXELS:
        raise SceneError(
            file, f"{field}.size", f"is {width} x {height}", f"write {EXAMPLES['size']}, {MAX_PIXELS:,} pixels at most"
        )
    if problem := camera_matrix_problem(np.array(camera.K)):
        raise SceneError(file, f"{field}.K", problem, f"write {EXAMPLES['K']}")
    low, high = (limit * max(camera.size) for limit in FOCAL_LENGTHS_PER_SIDE)
    if not all(low <= camera.K[axis][axis] <= high for axis in (0, 1)):
        problem = (
            f"has focal lengths {camera.K[0][0]:g} and {camera.K[1][1]:g}, no pixels of a {width} x {height} picture"
        )
        raise SceneError(file, f"{field}.K", problem, f"write {EXAMPLES['K']}")
    if camera.K[0][0] > MOST_UNEQUAL * camera.K[1][1] or camera.K[1][1] > MOST_UNEQUAL * camera.K[0][0]:
        problem = (
            f"has focal lengths {camera.K[0][0]:g} and {camera.K[1][1]:g}, which no camera's pixels make so unequal"
        )
        raise SceneError(file, f"{field}.K", problem, f"write {EXAMPLES['K']}")
    cx, cy = camera.K[0][2], camera.K[1][2]
    if max(abs(cx / width - 0.5), abs(cy / height - 0.5)) > PRINCIPAL_POINT_SIDES:
        problem = f"has its principal point at ({cx:g}, {cy:g}), far outside a picture of {width} x {height} px"
        raise SceneError(file, f"{field}.K", problem, f"write {EXAMPLES['K']}")
    count = len(camera.distortion)
    if count not in COEFFICIENT_COUNTS or not np.isfinite(camera.distortion).all():
        raise SceneError(
            file,
            f"{field}.distortion",
            f"has {count} numbers, or one that is not finite",
            f"give OpenCV's {', '.join(map(str, COEFFICIENT_COUNTS))} coefficients",
        )


def camera_matrix_problem(K: Floats) -> str | None:
    """Why a (3, 3) matrix is not that of a pinhole camera in pixels, in words; None when it is."""
    if not np.isfinite(K).all():
        return "is not finite"
    if K[0, 0] <= 0 or K[1, 1] <= 0:
        return f"has focal lengths {K[0, 0]:g} and {K[1, 1]:g}, which must be positive"
    if K[0, 1] != 0 or K[1, 0] != 0:
        return "has skew, which a pinhole camera here does not have"
    if tuple(K[2]) != (0, 0, 1):
        return "has a last row other than [0, 0, 1]"
    return None


def _check_frame(file: Path, frame: FrameTable, cameras: dict[str, CameraTable]) -> None:
    _check_use(file, "frame", frame, cameras)
    if (frame.depth is None) == (frame.cloud is None):
        state = "are both missing" if frame.depth is None else "are both there"
        raise SceneError(file, "frame.depth and frame.cloud", state, "keep exactly one of them")
    scale = frame.depth_scale
    if scale is not None and not (np.isfinite(scale) and scale > 0 and frame.depth is not None):
        raise SceneError(
            file,
            "frame.depth_scale",
            f"is {scale:g}" if frame.depth is not None else "is given without a depth map",
            f"write {EXAMPLES['depth_scale']}, or leave it out",
        )
    noise = {} if frame.noise is None else msgspec.structs.asdict(frame.noise)
    for field, value in noise.items():
        may_be_zero = isinstance(frame.noise, DepthNoiseTable) and any(noise.values())
        if not (np.isfinite(value) and (value > 0 or (value == 0 and may_be_zero))):
            raise SceneError(file, f"frame.noise.{field}", f"is {value:g}", "give a positive number")


def _check_use(file: Path, field: str, use: FrameTable | ViewTable, cameras: dict[str, CameraTable]) -> None:
    if use.camera not in cameras:
        known = ", ".join(cameras) or "none"
        raise SceneError(
            file, f"{field}.camera", f"is {use.camera!r}, and the cameras here are {known}", "name one of [cameras]"
        )
    with np.errstate(over="ignore", invalid="ignore"):
        rigid = use.T_base_camera is None or is_rigid(np.array(use.T_base_camera))
    if not rigid:
        raise SceneError(
            file,
            f"{field}.T_base_camera",
            "is not a rigid pose",
            "give a rotation of determinant 1 and a translation in metres over [0, 0, 0, 1]",
        )
    if use.T_base_camera is not None and np.abs(np.array(use.T_base_camera)[:3, 3]).max() > FARTHEST_M:
        raise SceneError(
            file,
            f"{field}.T_base_camera",
            f"puts the camera over {FARTHEST_M:g} m away",
            "give the translation in metres",
        )


def _check_workspace(file: Path, workspace: WorkspaceTable) -> None:
    for field, limits in msgspec.structs.asdict(workspace).items():
        if limits is None:
            continue
        in_order = np.all(np.array(limits[0]) < np.array(limits[1]))
        if not in_order or np.abs(np.array(limits)).max() > FARTHEST_M:
            raise SceneError(
                file, f"workspace.{field}", f"has the limits {limits[0]} and {limits[1]}", f"write {EXAMPLES[field]}"
            )

"""The scene folder: everything is read and validated at this door, and written so that it passes it again."""

from pathlib import Path, PurePosixPath

import numpy as np

from rotrecon.arrays import Bytes, Cloud, Floats
from rotrecon.camera import PinholeCamera
from rotrecon.capture import Capture
from rotrecon.errors import SceneError
from rotrecon.frame import DepthCameraNoise, DepthNoise, Frame, StereoNoise, View
from rotrecon.scene.formats.cloud_file import read_cloud
from rotrecon.scene.formats.depth import read_depth
from rotrecon.scene.formats.image import read_image
from rotrecon.scene.formats.source import SourceFile
from rotrecon.scene.lens import Lens
from rotrecon.scene.organise import RAY_TOLERANCE_PX, distance_from_rays_px, shade, z_buffer
from rotrecon.scene.rules import check_scene
from rotrecon.scene.schema import (
    SCENE_FILE,
    CameraTable,
    DepthNoiseTable,
    FrameTable,
    Pose,
    SceneTable,
    StereoNoiseTable,
    ViewTable,
    WorkspaceTable,
    parse_scene,
)
from rotrecon.workspace import Workspace

SHADED_NOTE = "The scene has no picture: what is shown is shaded depth."


def read_scene(folder: Path) -> Capture:
    """Read a scene folder into a Capture, pictures undistorted with K unchanged; raises SceneError.

    The folder holds `scene.toml` and the files it names, all of them checked.
    """
    file = folder / SCENE_FILE
    source = SourceFile(file, SCENE_FILE)
    if not folder.is_dir():
        problem = "is a file" if folder.is_file() else "does not exist"
        raise SceneError(folder, "the scene", problem, "name a scene folder, one that holds a scene.toml")
    if not source.exists:
        raise SceneError(folder, SCENE_FILE, "is missing", "name a scene folder, or make one with rotrecon import")
    scene = parse_scene(file, source.read_bytes())
    check_scene(file, scene)
    notes = () if scene.source is None else (f"Source: {scene.source}",)
    if scene.frame is None:
        views = tuple(_read_view(folder, f"views[{index}]", view, scene) for index, view in enumerate(scene.views))
        return Capture(scene.name, views=views, notes=notes, workspace=_workspace(scene.workspace))
    frame, more_notes = _read_frame(folder, scene.frame, scene)
    return Capture(scene.name, recorded=frame, notes=notes + more_notes)


def _read_view(folder: Path, field: str, view: ViewTable, scene: SceneTable) -> View:
    lens = _lens(scene.cameras[view.camera])
    image = _read_picture(_named(folder, f"{field}.image", view.image), view.camera, lens)
    return View(image, lens.camera, _pose(view.T_base_camera))


def _read_frame(folder: Path, table: FrameTable, scene: SceneTable) -> tuple[Frame, tuple[str, ...]]:
    lens = _lens(scene.cameras[table.camera])
    if table.depth is not None:
        points, colors = _read_depth_points(_named(folder, "frame.depth", table.depth), table, lens), None
    else:
        points, colors = _read_cloud_points(folder, table, lens)
    if not np.isfinite(points[..., 2]).any():
        raise SceneError(
            folder / SCENE_FILE,
            f"cameras.{table.camera}",
            "sees none of the recorded points",
            "correct its K and distortion, or record points in its coordinates",
        )
    notes: tuple[str, ...] = ()
    if table.image is not None:
        image = _read_picture(_named(folder, "frame.image", table.image), table.camera, lens)
    elif colors is not None:
        image = colors
    else:
        image, notes = shade(points), (SHADED_NOTE,)
    frame = Frame(
        image=image,
        points_m=points,
        camera=lens.camera,
        T_base_camera=_pose(table.T_base_camera),
        noise=_noise(table.noise),
        workspace=_workspace(scene.workspace),
        captured_at=table.captured_at,
    )
    return frame, notes


def _read_picture(source: SourceFile, camera: str, lens: Lens) -> Bytes:
    image = read_image(source)
    check_size(source, image.shape, lens.camera, f"cameras.{camera}.size")
    return lens.undistort_image(image)


def _read_depth_points(source: SourceFile, table: FrameTable, lens: Lens) -> Cloud:
    depth = read_depth(source, table.depth_scale)
    check_size(source, depth.shape, lens.camera, f"cameras.{table.camera}.size")
    return lens.undistort_points(lens.cloud(depth))


def _read_cloud_points(folder: Path, table: FrameTable, lens: Lens) -> tuple[Cloud, Bytes | None]:
    source = _named(folder, "frame.cloud", table.cloud or "")
    cloud = read_cloud(source)
    if not cloud.organised:
        return z_buffer(cloud.points_m, cloud.colors, lens.camera)
    check_size(source, cloud.points_m.shape, lens.camera, f"cameras.{table.camera}.size")
    distance = distance_from_rays_px(cloud.points_m, lens)
    if distance > RAY_TOLERANCE_PX:
        raise SceneError(
            folder / SCENE_FILE,
            f"cameras.{table.camera}.K",
            f"puts the points of {table.cloud} {distance:.0f} px from their own pixels, in the median",
            "correct K, or save the cloud in this camera's coordinates",
        )
    colors = None if cloud.colors is None else lens.undistort_image(cloud.colors)
    return lens.undistort_points(cloud.points_m), colors


def check_size(source: SourceFile, shape: tuple[int, ...], camera: PinholeCamera, size_field: str) -> None:
    """Refuse an array (height, width, ...) that does not have the camera's size; raises SceneError."""
    if shape[:2] != (camera.height, camera.width):
        raise source.error(
            f"is {shape[1]} x {shape[0]} but {size_field} is {camera.width} x {camera.height}",
            "correct the size, or give the file that was recorded with this camera",
        )


def _named(folder: Path, field: str, name: str) -> SourceFile:
    path = PurePosixPath(name)
    if not name or path.is_absolute() or ".." in path.parts or "\\" in name or "\0" in name:
        raise SceneError(
            folder / SCENE_FILE,
            field,
            f"is {name!r}, which leads out of the scene folder",
            "copy the file into the folder and write its name alone",
        )
    return SourceFile(folder / path, field)


def _lens(table: CameraTable) -> Lens:
    width, height = table.size
    return Lens(PinholeCamera(width, height, np.array(table.K)), np.array(table.distortion, dtype=np.float64))


def _pose(pose: Pose | None) -> Floats:
    return np.eye(4) if pose is None else np.array(pose)


def _noise(table: StereoNoiseTable | DepthNoiseTable | None) -> DepthNoise | None:
    if isinstance(table, StereoNoiseTable):
        return StereoNoise(table.baseline_m, table.disparity_sigma_px)
    return None if table is None else DepthCameraNoise(table.sigma0_m, table.sigma2_per_m)


def _workspace(table: WorkspaceTable) -> Workspace:
    box = None if table.box_m is None else np.array(table.box_m)
    return Workspace(table.reach_m, box, table.depth_m)

"""Writes a scene folder: whole, or not at all."""

import secrets
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import tomli_w

from rotrecon.errors import SceneError
from rotrecon.files import flush_folder, write_durably
from rotrecon.frame import DepthNoise, Frame, StereoNoise
from rotrecon.scene.formats.depth_limits import check_depth
from rotrecon.scene.formats.image import encode_png
from rotrecon.scene.formats.npz import encode_npz
from rotrecon.scene.formats.source import SourceFile
from rotrecon.scene.lens import pinhole
from rotrecon.scene.organise import RAY_TOLERANCE_PX, distance_from_rays_px
from rotrecon.scene.rules import check_scene
from rotrecon.scene.schema import FORMAT, SCENE_FILE, convert_scene
from rotrecon.workspace import Workspace

_NOTHING: Mapping[str, bytes] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class SceneRecord:
    """One frame to be kept as a scene folder, and where it came from."""

    name: str
    frame: Frame
    source: str | None = None
    licence: str | None = None


def write_scene(folder: Path, record: SceneRecord, beside: Mapping[str, bytes] = _NOTHING) -> None:
    """Write a frame as a scene folder that `read_scene` gives back exactly, with the files `beside` it by name.

    `folder` must not exist or be empty. It appears complete or not at all. Raises SceneError when it cannot be
    written or would not be read again.
    """
    folder = folder.resolve()
    write_folder(folder, _scene_files(folder, record), beside)


def write_folder(folder: Path, files: Mapping[str, bytes], beside: Mapping[str, bytes]) -> None:
    """Write the files of a scene and those beside them, whole or not at all; raises SceneError, as `write_scene`."""
    if clash := [name for name in beside if name in files or Path(name).name != name]:
        raise ValueError(f"{clash[0]} cannot be a file beside the scene's own")
    aside = folder.with_name(f".{folder.name}.{secrets.token_hex(4)}.partial")
    try:
        if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
            raise _refusal(folder, "exists already and is not an empty folder", "name a new folder")
        folder.parent.mkdir(parents=True, exist_ok=True)
        aside.mkdir()
        for name, content in {**files, **beside}.items():
            write_durably(aside / name, content)
        flush_folder(aside)
        aside.rename(folder)
        flush_folder(folder.parent)
    except OSError as failure:
        remedy = "free some space, or name a new folder where you may write"
        raise _refusal(folder, f"cannot be written ({failure.strerror})", remedy) from failure
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def _refusal(folder: Path, problem: str, remedy: str) -> SceneError:
    return SceneError(folder, "the scene folder", problem, remedy)


def _scene_files(folder: Path, record: SceneRecord) -> dict[str, bytes]:
    frame, camera = record.frame, record.frame.camera
    if frame.image.shape != (camera.height, camera.width, 3) or frame.points_m.shape != frame.image.shape:
        raise ValueError(f"picture {frame.image.shape} and points {frame.points_m.shape} do not fit the camera")
    on_rays = np.array_equal(camera.cloud(frame.depth_m), frame.points_m, equal_nan=True)
    behind = {"depth": "depth.npz"} if on_rays else {"cloud": "cloud.npz"}
    table = _scene_table(record, behind)
    file = folder / SCENE_FILE
    check_scene(file, convert_scene(file, table))
    check_depth(SourceFile(folder, "the frame"), frame.depth_m)
    if distance_from_rays_px(frame.points_m, pinhole(camera)) > RAY_TOLERANCE_PX:
        raise SceneError(file, "cameras.main.K", "does not fit the points of the frame", "correct K")
    arrays = {"depth_m": frame.depth_m} if on_rays else {"points_m": frame.points_m}
    return {
        "image.png": encode_png(frame.image),
        next(iter(behind.values())): encode_npz(**arrays),
        SCENE_FILE: tomli_w.dumps(table).encode(),
    }


def _scene_table(record: SceneRecord, behind: dict[str, str]) -> dict[str, Any]:
    frame, camera = record.frame, record.frame.camera
    frame_table: dict[str, Any] = {"camera": "main", "image": "image.png", **behind}
    if not np.array_equal(frame.T_base_camera, np.eye(4)):
        frame_table["T_base_camera"] = frame.T_base_camera.tolist()
    if frame.captured_at is not None:
        frame_table["captured_at"] = frame.captured_at
    if frame.noise is not None:
        frame_table["noise"] = _noise_table(frame.noise)
    table: dict[str, Any] = {"format": FORMAT, "name": record.name}
    if record.source is not None:
        table["source"] = record.source
    if record.licence is not None:
        table["licence"] = record.licence
    main = {"size": [camera.width, camera.height], "K": camera.K.tolist(), "distortion": []}
    table |= {"cameras": {"main": main}, "frame": frame_table}
    if limits := _workspace_table(frame.workspace):
        table["workspace"] = limits
    return table


def _noise_table(noise: DepthNoise) -> dict[str, Any]:
    return {"model": "stereo" if isinstance(noise, StereoNoise) else "depth", **vars(noise)}


def _workspace_table(workspace: Workspace) -> dict[str, Any]:
    limits = {
        "reach_m": None if workspace.reach_m is None else list(workspace.reach_m),
        "box_m": None if workspace.box_m is None else workspace.box_m.tolist(),
        "depth_m": None if workspace.depth_m is None else list(workspace.depth_m),
    }
    return {field: value for field, value in limits.items() if value is not None}

"""Makes a scene folder from a foreign recording: a cloud, a picture with its depth, or a ROS bag."""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from rotrecon.arrays import Bytes, Cloud, Floats
from rotrecon.camera import PinholeCamera
from rotrecon.capture import Capture
from rotrecon.frame import Frame
from rotrecon.scene.formats.cloud import RawCloud
from rotrecon.scene.formats.cloud_file import CLOUD_ENDINGS, read_cloud
from rotrecon.scene.formats.depth import read_depth
from rotrecon.scene.formats.image import read_image
from rotrecon.scene.formats.rosbag import read_bag
from rotrecon.scene.formats.source import SourceFile
from rotrecon.scene.intrinsics import Intrinsics, recover_intrinsics
from rotrecon.scene.lens import pinhole
from rotrecon.scene.organise import RAY_TOLERANCE_PX, distance_from_rays_px, shade, z_buffer
from rotrecon.scene.reading import check_size, read_scene
from rotrecon.scene.rules import camera_matrix_problem
from rotrecon.scene.writing import SceneRecord, write_scene

STATED_TOLERANCE_PX = 0.5
"""How far a camera_info may put the points from their pixels: the camera that made the cloud does so exactly."""
_IMAGE_ENDINGS = frozenset({".png", ".jpg", ".jpeg"})


@dataclass(frozen=True)
class ImportOptions:
    """What a foreign recording does not say of itself."""

    depth: Path | None = None
    """The depth map of a picture: .npz (depth_m), or .png with `depth_scale`."""
    depth_scale: float | None = None
    """Metres of one count of a depth PNG."""
    intrinsics: Intrinsics | None = None
    size: tuple[int, int] | None = None
    """Width and height of the camera that an unorganised cloud is seen with, px."""
    topic: str | None = None
    """The PointCloud2 topic of a bag."""
    name: str | None = None
    """The scene's name; the file's when left out."""


@dataclass(frozen=True, eq=False)
class _Recording:
    """What was found in the source, and the sentence that says how it was understood."""

    points_m: Cloud
    image: Bytes | None
    camera: PinholeCamera
    remark: str
    captured_at: datetime | None = None


def import_scene(source: Path, out: Path, options: ImportOptions | None = None) -> Capture:
    """Make the scene folder `out` from a PCD, PLY or NPZ cloud, a picture with depth, or a ROS 1 or ROS 2 bag.

    Intrinsics that are not given are taken from the bag's camera_info, or recovered from an organised cloud; the
    scene's source says so. Returns the scene as it reads. Raises SceneError, and then leaves nothing behind.
    """
    options = options or ImportOptions()
    file = SourceFile(source, "source")
    _check_options(file, options)
    recording = _read(file, options)
    if not np.isfinite(recording.points_m[..., 2]).any():
        raise file.error("has no point that the camera sees", "correct the intrinsics and the size")
    remark, image = recording.remark, recording.image
    if image is None:
        remark, image = f"{remark}; picture shaded from depth", shade(recording.points_m)
    frame = Frame(image, recording.points_m, recording.camera, captured_at=recording.captured_at)
    write_scene(out, SceneRecord(options.name or source.resolve().stem, frame, source=remark))
    return read_scene(out)


def _check_options(file: SourceFile, options: ImportOptions) -> None:
    """Refuse what would have no effect, and numbers that are no camera."""
    if options.intrinsics is not None and (problem := camera_matrix_problem(options.intrinsics.K)):
        raise SourceFile(file.path, "intrinsics").error(problem, "give fx,fy,cx,cy in pixels")
    if options.size is not None and min(options.size) < 1:
        raise SourceFile(file.path, "size").error("is not positive", "give width and height in pixels")
    scale = options.depth_scale
    if scale is not None and not (np.isfinite(scale) and scale > 0 and options.depth is not None):
        raise SourceFile(file.path, "depth_scale").error(
            f"is {scale:g}", "give the metres of one count of a depth PNG, such as 0.001, with the depth map"
        )
    if options.topic is not None and not _is_bag(file):
        raise SourceFile(file.path, "topic").error("is given for a file that is not a bag", "leave it out")


def _is_bag(file: SourceFile) -> bool:
    return file.ending == ".bag" or file.path.is_dir()


def _read(file: SourceFile, options: ImportOptions) -> _Recording:
    if options.depth is not None:
        return _read_pair(file, SourceFile(options.depth, "depth"), options)
    if _is_bag(file):
        return _read_bag(file, options)
    if file.ending in CLOUD_ENDINGS:
        return _place(file, read_cloud(file), options, f"imported from {file.path.name}")
    if file.ending in _IMAGE_ENDINGS:
        raise file.error("is a picture without depth", "give its depth map too")
    raise file.error(
        f"has the unknown ending {file.path.suffix!r}",
        "give a .pcd, .ply or .npz cloud, a .png or .jpg picture with its depth, or a ROS bag",
    )


def _read_pair(file: SourceFile, depth_file: SourceFile, options: ImportOptions) -> _Recording:
    if options.intrinsics is None:
        raise file.error("is a picture, which does not tell its intrinsics", "give fx,fy,cx,cy in pixels")
    image = read_image(file)
    depth = read_depth(depth_file, options.depth_scale)
    camera = PinholeCamera(image.shape[1], image.shape[0], options.intrinsics.K)
    _check_given_size(file, image, options)
    check_size(depth_file, depth.shape, camera, f"the picture {file.path.name}")
    remark = f"imported from {file.path.name} and {depth_file.path.name}"
    return _Recording(camera.cloud(depth), image, camera, remark)


def _read_bag(file: SourceFile, options: ImportOptions) -> _Recording:
    bag = read_bag(file, options.topic)
    remark = f"imported from {file.path.resolve().name}, topic {bag.topic}, frame {bag.frame_id}"
    return _place(file, bag.cloud, options, remark, bag.camera_matrices, bag.captured_at)


def _place(
    file: SourceFile,
    cloud: RawCloud,
    options: ImportOptions,
    remark: str,
    stated: tuple[Floats, ...] = (),
    captured_at: datetime | None = None,
) -> _Recording:
    """Put a cloud behind the pixels of its camera; `stated` are camera matrices that came with it."""
    if cloud.organised:
        K, origin = _camera_matrix(file, cloud.points_m, options, stated)
        camera = PinholeCamera(cloud.points_m.shape[1], cloud.points_m.shape[0], K)
        return _Recording(cloud.points_m, cloud.colors, camera, remark + origin, captured_at)
    if options.intrinsics is None or options.size is None:
        raise file.error(
            "is an unorganised cloud, which does not tell its camera",
            "give the intrinsics fx,fy,cx,cy in pixels and the size WxH of the camera to see it with",
        )
    file.check_count(options.size[0] * options.size[1], "pixels in its size")
    camera = PinholeCamera(*options.size, options.intrinsics.K)
    points, colors = z_buffer(cloud.points_m, cloud.colors, camera)
    return _Recording(points, colors, camera, f"{remark}; nearest points of an unorganised cloud", captured_at)


def _camera_matrix(
    file: SourceFile, points_m: Cloud, options: ImportOptions, stated: tuple[Floats, ...]
) -> tuple[Floats, str]:
    """The (3, 3) camera matrix of an organised cloud, and in words where it is from."""
    _check_given_size(file, points_m, options)
    if options.intrinsics is not None:
        distance = _distance_px(points_m, options.intrinsics.K)
        if distance > RAY_TOLERANCE_PX:
            raise SourceFile(file.path, "intrinsics").error(
                f"put the points {distance:.0f} px from their own pixels, in the median",
                "correct them, or leave them out to have them recovered from the cloud",
            )
        return options.intrinsics.K, ""
    plausible = [K for K in stated if camera_matrix_problem(K) is None]
    nearest = min(plausible, key=lambda K: _distance_px(points_m, K), default=None)
    if nearest is not None and _distance_px(points_m, nearest) <= STATED_TOLERANCE_PX:
        return nearest, "; intrinsics from its camera_info"
    recovered = recover_intrinsics(points_m)
    if recovered is None or _distance_px(points_m, recovered.K) > RAY_TOLERANCE_PX:
        raise file.error(
            "is an organised cloud whose points are not on the rays of a pinhole camera",
            "save it in camera coordinates: x right, y down, z forward",
        )
    return recovered.K, f"; intrinsics recovered from the cloud ({recovered})"


def _check_given_size(file: SourceFile, raster: Bytes | Cloud, options: ImportOptions) -> None:
    if options.size is not None and options.size != (raster.shape[1], raster.shape[0]):
        raise SourceFile(file.path, "size").error(
            f"is {options.size[0]} x {options.size[1]} but the recording is {raster.shape[1]} x {raster.shape[0]}",
            "leave it out",
        )


def _distance_px(points_m: Cloud, K: Floats) -> float:
    return distance_from_rays_px(points_m, pinhole(PinholeCamera(points_m.shape[1], points_m.shape[0], K)))

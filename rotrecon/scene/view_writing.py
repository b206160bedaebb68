"""Writes a scene folder of views that still have to be matched."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import tomli_w

from rotrecon.arrays import Bytes, Floats, freeze
from rotrecon.scene.formats.image import encode_png
from rotrecon.scene.lens import Lens
from rotrecon.scene.rules import check_scene
from rotrecon.scene.schema import FORMAT, SCENE_FILE, convert_scene
from rotrecon.scene.writing import write_folder

_NOTHING: Mapping[str, bytes] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class RecordedView:
    """A picture in the raster that its lens recorded, and what is known of where from."""

    image: Bytes
    """(height, width, 3) RGB."""
    lens: Lens
    T_base_camera: Floats
    """(4, 4) rigid."""

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class ViewsRecord:
    """Views to be kept as a scene folder, and where they came from."""

    name: str
    views: tuple[RecordedView, ...]
    source: str | None = None
    licence: str | None = None


def write_views(folder: Path, record: ViewsRecord, beside: Mapping[str, bytes] = _NOTHING) -> None:
    """Write views as a scene folder that `read_scene` gives back undistorted, with the files `beside` it by name.

    `folder` must not exist or be empty. It appears complete or not at all. Raises SceneError when it cannot be
    written or would not be read again.
    """
    folder = folder.resolve()
    for view in record.views:
        if view.image.shape != (view.lens.camera.height, view.lens.camera.width, 3):
            raise ValueError(f"a picture of shape {view.image.shape} does not fit its camera")
    table = _views_table(record)
    check_scene(folder / SCENE_FILE, convert_scene(folder / SCENE_FILE, table))
    files = {_file(number): encode_png(view.image) for number, view in enumerate(record.views)}
    write_folder(folder, {**files, SCENE_FILE: tomli_w.dumps(table).encode()}, beside)


def _file(number: int) -> str:
    return f"view{number}.png"


def _views_table(record: ViewsRecord) -> dict[str, Any]:
    """The scene.toml: views with the same calibration share a camera."""
    cameras: dict[str, Any] = {}
    views: list[dict[str, Any]] = []
    for number, view in enumerate(record.views):
        camera = view.lens.camera
        size, distortion = [camera.width, camera.height], view.lens.distortion.tolist()
        calibration = {"size": size, "K": camera.K.tolist(), "distortion": distortion}
        known = next((name for name, other in cameras.items() if other == calibration), f"camera{len(cameras)}")
        cameras[known] = calibration
        views.append({"image": _file(number), "camera": known, "T_base_camera": view.T_base_camera.tolist()})
    stated = {"source": record.source, "licence": record.licence}
    table: dict[str, Any] = {"format": FORMAT, "name": record.name}
    table |= {field: value for field, value in stated.items() if value is not None}
    return table | {"cameras": cameras, "views": views}

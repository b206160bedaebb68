"""What scene.toml may say: its fields and their types."""

import tomllib
from datetime import date, datetime, time
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta, Struct

from rotrecon.errors import SceneError

SCENE_FILE = "scene.toml"
FORMAT = 1

Pair = tuple[float, float]
Row = tuple[float, float, float]
PoseRow = tuple[float, float, float, float]
Pose = tuple[PoseRow, PoseRow, PoseRow, PoseRow]
Moment = Annotated[datetime, Meta(tz=True)]


class CameraTable(Struct, forbid_unknown_fields=True, frozen=True):
    """`[cameras.NAME]`."""

    size: tuple[int, int]
    K: tuple[Row, Row, Row]
    distortion: tuple[float, ...] = ()


class StereoNoiseTable(Struct, forbid_unknown_fields=True, frozen=True, tag_field="model", tag="stereo"):
    """`[frame.noise]` with `model = "stereo"`."""

    baseline_m: float
    disparity_sigma_px: float


class DepthNoiseTable(Struct, forbid_unknown_fields=True, frozen=True, tag_field="model", tag="depth"):
    """`[frame.noise]` with `model = "depth"`."""

    sigma0_m: float
    sigma2_per_m: float


class FrameTable(Struct, forbid_unknown_fields=True, frozen=True):
    """`[frame]`."""

    camera: str
    image: str | None = None
    depth: str | None = None
    depth_scale: float | None = None
    cloud: str | None = None
    T_base_camera: Pose | None = None
    captured_at: Moment | None = None
    noise: StereoNoiseTable | DepthNoiseTable | None = None


class ViewTable(Struct, forbid_unknown_fields=True, frozen=True):
    """One of `[[views]]`."""

    image: str
    camera: str
    T_base_camera: Pose


class WorkspaceTable(Struct, forbid_unknown_fields=True, frozen=True):
    """`[workspace]`."""

    reach_m: Pair | None = None
    box_m: tuple[Row, Row] | None = None
    depth_m: Pair | None = None


class SceneTable(Struct, forbid_unknown_fields=True, frozen=True):
    """The whole of scene.toml."""

    format: int
    name: str
    cameras: dict[str, CameraTable]
    source: str | None = None
    licence: str | None = None
    frame: FrameTable | None = None
    views: tuple[ViewTable, ...] = ()
    workspace: WorkspaceTable = WorkspaceTable()


_TABLES: dict[str, type[Struct]] = {
    "cameras[...]": CameraTable,
    "frame": FrameTable,
    "views[...]": ViewTable,
    "workspace": WorkspaceTable,
    "": SceneTable,
}

EXAMPLES = {
    "format": f"format = {FORMAT}",
    "size": "size = [640, 480], width and height in pixels",
    "K": "K = [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], plain numbers in pixels",
    "distortion": "distortion = [], or OpenCV's coefficients",
    "depth_scale": "depth_scale = 0.001, the metres of one count as a plain number",
    "T_base_camera": "T_base_camera as four rows of four plain numbers, in metres",
    "captured_at": "captured_at = 2026-01-31T12:00:00Z, a moment with its time zone and no quotes",
    "noise": 'model = "stereo", baseline_m and disparity_sigma_px, or model = "depth", sigma0_m and sigma2_per_m',
    "reach_m": "reach_m = [0.1, 1.5], nearest and farthest in metres",
    "box_m": "box_m = [[-1, -1, 0], [1, 1, 1]], lowest and highest corner in metres",
    "depth_m": "depth_m = [0.2, 3.0], nearest and farthest in metres",
}
"""How a field is written rightly, by the name of the field."""


def parse_scene(file: Path, content: bytes) -> SceneTable:
    """The tables of a scene.toml, their types checked; `file` is only named in errors. Raises SceneError."""
    try:
        raw = tomllib.loads(content.decode())
    except (ValueError, RecursionError) as failure:
        raise SceneError(file, "the file", f"is not TOML ({failure})", "correct it at that place") from failure
    return convert_scene(file, raw)


def convert_scene(file: Path, raw: dict[str, Any]) -> SceneTable:
    """The tables of a scene.toml from plain dicts and lists, their types checked; raises SceneError."""
    version = raw.get("format")
    # A later format may have other fields, so its number is looked at before them.
    if version is True or version != FORMAT:
        problem = "is missing" if version is None else f"is {version!r}, which this version does not know"
        raise SceneError(file, "format", problem, f"write format = {FORMAT}, or update the program")
    try:
        # TOML has its own moments: text that looks like one is not taken for it.
        return msgspec.convert(raw, SceneTable, builtin_types=(datetime, date, time))
    except msgspec.ValidationError as failure:
        raise _explain(file, str(failure)) from failure


def _explain(file: Path, message: str) -> SceneError:
    """Name the field and the remedy of a message such as "Expected `float`, got `str` - at `$.frame.depth_scale`"."""
    what, _, place = message.partition(" - at ")
    field = place.strip("`").removeprefix("$").removeprefix(".")
    what = what.replace("`", "").removeprefix("Object ")
    words = field.replace("[...]", "").split(".")
    if "unknown field" in what and words[-1] != "noise":
        known = ", ".join(_TABLES[field].__struct_fields__) if field in _TABLES else "those of the format"
        remedy = f"remove it or correct its spelling; the fields there are {known}"
    elif example := next((EXAMPLES[_stem(word)] for word in reversed(words) if _stem(word) in EXAMPLES), None):
        remedy = f"write {example}"
    else:
        remedy = "write it as the format of the scene folder has it, text in quotes and numbers without units"
    return SceneError(file, field or "the file", f"is not valid ({what[:1].lower()}{what[1:]})", remedy)


def _stem(word: str) -> str:
    return word.partition("[")[0]

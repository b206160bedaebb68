"""A cloud in whichever of the known formats its file's ending says."""

from collections.abc import Callable

from rotrecon.scene.formats.cloud import RawCloud
from rotrecon.scene.formats.npz import read_npz_cloud
from rotrecon.scene.formats.pcd import read_pcd
from rotrecon.scene.formats.ply import read_ply
from rotrecon.scene.formats.source import SourceFile

_READERS: dict[str, Callable[[SourceFile], RawCloud]] = {
    ".npz": read_npz_cloud,
    ".pcd": read_pcd,
    ".ply": read_ply,
}
CLOUD_ENDINGS = frozenset(_READERS)


def read_cloud(source: SourceFile) -> RawCloud:
    """Read a PCD, PLY or NPZ cloud in camera coordinates and metres; raises SceneError."""
    if source.ending not in _READERS:
        raise source.error(
            f"has the unknown ending {source.path.suffix!r}", "save the cloud as .pcd, .ply or .npz (points_m)"
        )
    return _READERS[source.ending](source)

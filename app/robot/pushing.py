"""Reads a scene folder that comes over the wire as one ZIP file."""

import tempfile
import zlib
from pathlib import Path, PurePosixPath
from typing import IO
from zipfile import BadZipFile, ZipFile, ZipInfo

from rotrecon.capture import Capture
from rotrecon.errors import SceneError
from rotrecon.scene.reading import read_scene

LARGEST_PUSH = 256 << 20
"""Bytes of a ZIP file: a dozen pictures of 20 megapixels."""
LARGEST_UNPACKED = 1 << 30
MOST_FILES = 64
CHUNK = 1 << 20


class NotAScene(Exception):
    """What was pushed in cannot be used; the message says why and what to do."""


def read_pushed(file: IO[bytes]) -> Capture:
    """The capture in a ZIP file of a scene folder: `scene.toml` on top and the files it names. Raises NotAScene."""
    with tempfile.TemporaryDirectory(prefix="rotrecon-") as place:
        folder = Path(place)
        try:
            with ZipFile(file) as archive:
                _unpack(archive, folder)
        except (BadZipFile, RuntimeError, NotImplementedError, EOFError, ValueError, OSError, zlib.error) as error:
            raise NotAScene(f"this is no ZIP file that can be read ({error}); send a scene folder as one") from error
        try:
            return read_scene(folder)
        except SceneError as error:
            raise NotAScene(str(error).replace(f"{folder}/", "").replace(str(folder), "the ZIP file")) from error


def _unpack(archive: ZipFile, folder: Path) -> None:
    members = [member for member in archive.infolist() if not member.is_dir()]
    if len(members) > MOST_FILES:
        raise NotAScene(f"{len(members)} files are more than {MOST_FILES}; send one scene")
    left = LARGEST_UNPACKED
    for member in members:
        target = folder / _plain_name(member)
        target.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(member) as packed, target.open("xb") as unpacked:
            while chunk := packed.read(CHUNK):
                left -= len(chunk)
                if left < 0:
                    raise NotAScene(f"it unpacks to more than {LARGEST_UNPACKED >> 20} MB; send one scene")
                unpacked.write(chunk)


def _plain_name(member: ZipInfo) -> PurePosixPath:
    name = PurePosixPath(member.filename)
    if name.is_absolute() or ".." in name.parts or "\\" in member.filename or not name.parts:
        raise NotAScene(f"{member.filename!r} leads out of the folder; send plain names")
    return name

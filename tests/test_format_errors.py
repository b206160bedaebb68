"""Foreign files that are damaged, or of another kind, are refused in one sentence and never raise anything else."""

import pickle
import re
import struct
import zipfile
import zlib
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pypcd4 import Encoding

from rotrecon.errors import SceneError
from rotrecon.scene.formats.cloud_file import read_cloud
from rotrecon.scene.formats.depth import read_depth
from rotrecon.scene.formats.image import encode_png, read_image
from rotrecon.scene.formats.npz import encode_npz
from tests.clouds import sample, source, write_pcd, write_ply


def png_header(width: int, height: int) -> bytes:
    chunk = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + chunk + struct.pack(">I", zlib.crc32(chunk))


def jpeg_header(width: int, height: int) -> bytes:
    return b"\xff\xd8\xff\xe0\x00\x04ab\xff\xff\xc0\x00\x11\x08" + struct.pack(">HH", height, width) + bytes(32)


HUGE_NPY = (
    b"\x93NUMPY\x01\x00\x76\x00"
    + b"{'descr': '<f4', 'fortran_order': False, 'shape': (50000, 50000), }".ljust(117)
    + b"\n"
)


def archive(name: str, content: bytes) -> bytes:
    out = BytesIO()
    with zipfile.ZipFile(out, "w") as file:
        file.writestr(name, content)
    return out.getvalue()


PCD_HEADER = """VERSION 0.7
FIELDS {fields}
SIZE 4 4 4
TYPE F F F
COUNT 1 1 1
WIDTH {width}
HEIGHT {height}
POINTS {points}
DATA {data}
"""


def pcd_header(**change: object) -> bytes:
    return PCD_HEADER.format(
        **({"fields": "x y z", "width": 2, "height": 1, "points": 2, "data": "binary"} | change)
    ).encode()


ORDINARY = encode_npz(depth_m=np.ones((2, 2), np.float32))


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.png", b"", "empty"),
        ("a.png", b"GIF89a", "save it as PNG"),
        ("a.png", png_header(50_000, 50_000), "64,000,000"),
        ("a.jpg", jpeg_header(50_000, 50_000), "64,000,000"),
        ("a.png", png_header(8, 8), "truncated"),
        ("a.jpg", jpeg_header(8, 8), "truncated"),
        ("a.jpg", b"\xff\xd8\xff", "save it as PNG"),
    ],
)
def test_a_picture_that_cannot_be_used_is_refused_with_a_remedy(tmp_path, name, content, words):
    assert_refused(tmp_path / name, content, words, read_image)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.tiff", b"II*", "unknown ending"),
        ("a.npz", b"", "empty"),
        ("a.npz", ORDINARY[:-10], "not an NPZ archive, or is truncated"),
        ("a.npz", pickle.dumps([1]), "not an NPZ archive"),
        ("a.npz", encode_npz(depth=np.ones((2, 2))), "under the name depth_m"),
        ("a.npz", archive("depth_m.npy", HUGE_NPY), "reduce its resolution"),
        (
            "a.npz",
            archive("depth_m.npy", HUGE_NPY.replace(b"50000, 50000", b"5, 5" + b" " * 8)),
            "damaged array depth_m",
        ),
        ("a.npz", encode_npz(depth_m=np.ones((2, 2), np.int32)), "save floats in metres"),
        ("a.npz", encode_npz(depth_m=np.ones(4)), "shape (height, width)"),
        ("a.npz", encode_npz(depth_m=np.full((2, 2), 800.0)), "looks like millimetres"),
        ("a.npz", encode_npz(depth_m=np.array([[0, -1.0], [np.nan, np.inf]])), "no valid depth"),
        ("a.png", encode_png(np.ones((2, 2), np.uint16)), "depth_scale = 0.001"),
    ],
)
def test_depth_that_cannot_be_used_is_refused_with_a_remedy(tmp_path, name, content, words):
    assert_refused(tmp_path / name, content, words, lambda file: read_depth(file, None))


@pytest.mark.parametrize(
    ("pixels", "words"),
    [
        (np.ones((2, 2), np.uint8), "16-bit grey PNG"),
        (np.ones((2, 2, 3), np.uint8), "16-bit grey PNG"),
        (np.full((2, 2), 65535, np.uint16), "no valid depth"),
    ],
)
def test_a_depth_png_of_another_kind_is_refused(tmp_path, pixels, words):
    assert_refused(tmp_path / "a.png", encode_png(pixels), words, lambda file: read_depth(file, 0.001))


def test_a_pickled_array_is_never_loaded(tmp_path):
    np.savez(tmp_path / "a.npz", depth_m=np.array([{}], dtype=object))
    assert_refused(tmp_path / "a.npz", None, "pickles are never loaded", lambda file: read_depth(file, None))


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.xyz", b"1 2 3", "unknown ending"),
        ("a.pcd", b"VERSION 0.7\nFIELDS x y z\n", "cut off in its header"),
        ("a.pcd", pcd_header(data="zipped"), "save it again as PCD 0.7"),
        ("a.pcd", pcd_header(width=3), "WIDTH times HEIGHT is POINTS"),
        ("a.pcd", pcd_header(fields="x y i"), "save it with x, y and z"),
        ("a.pcd", pcd_header(width=50_000, height=50_000, points=2_500_000_000), "reduce its resolution"),
        ("a.pcd", pcd_header() + bytes(23), "truncated"),
        ("a.pcd", pcd_header(data="ascii") + b"1 2 3\n", "truncated"),
        ("a.pcd", pcd_header(data="ascii") + b"1 2 3\n4 5 metres\n", "truncated or damaged"),
        ("a.pcd", pcd_header(data="binary_compressed") + struct.pack("<II", 9, 24) + bytes(3), "truncated"),
        ("a.pcd", pcd_header(data="binary_compressed") + struct.pack("<II", 9, 2**31) + bytes(9), "truncated"),
        ("a.pcd", pcd_header() + np.full(6, -1, "<f4").tobytes(), "no valid depth"),
        ("a.ply", b"solid", "cut off in its header"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement face 3\nend_header\n", "has no vertices"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 2500000000\nend_header\n", "reduce its resolution"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 9000\nproperty float x\nend_header\n1\n", "truncated"),
        ("a.npz", ORDINARY, "under the name points_m"),
        ("a.npz", encode_npz(points_m=np.ones((2, 2))), "(height, width, 3)"),
        ("a.npz", encode_npz(points_m=np.ones((2, 2, 3)), colors=np.ones((2, 2, 3))), "colors as uint8"),
    ],
)
def test_a_cloud_that_cannot_be_used_is_refused_with_a_remedy(tmp_path, name, content, words):
    assert_refused(tmp_path / name, content, words, read_cloud)


def assert_refused(path, content, words, read):
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(SceneError) as refusal:
        read(source(path))
    message = str(refusal.value)
    assert message.startswith(f"{path}: the field ")
    assert words in message
    assert "; " in message
    assert "\n" not in message


def test_a_missing_file_and_a_folder_are_not_files(tmp_path):
    for path in (tmp_path / "none.png", tmp_path, tmp_path / ("n" * 300)):
        with pytest.raises(SceneError, match=r"does not exist|not a file"):
            source(path).read_bytes()


def written(folder: Path, ending: str) -> Path:
    points, colors = sample()
    path = folder / f"a.{ending}"
    if ending == "png":
        path.write_bytes(encode_png(colors))
    elif ending == "npz":
        path.write_bytes(encode_npz(points_m=points, colors=colors))
    elif ending == "ply":
        write_ply(path, points, colors, obj_info=["num_cols 5", "num_rows 4"])
    else:
        write_pcd(path, points, colors, Encoding(ending.removesuffix(".pcd")))
    return path


ENDINGS = st.sampled_from(["png", "npz", "ply", "ascii.pcd", "binary.pcd", "binary_compressed.pcd"])


@settings(deadline=None, max_examples=60)
@given(ENDINGS, st.floats(0, 0.9))
def test_a_file_cut_off_anywhere_is_refused(ending, kept):
    with TemporaryDirectory() as folder:
        path = written(Path(folder), ending)
        content = path.read_bytes()
        path.write_bytes(content[: int(kept * len(content))])
        with pytest.raises(SceneError, match=re.escape(str(path))):
            (read_image if ending == "png" else read_cloud)(source(path))


@settings(deadline=None, max_examples=120)
@given(ENDINGS, st.floats(0, 1, exclude_max=True), st.integers(1, 255))
def test_a_damaged_byte_is_read_or_refused_but_nothing_else(ending, place, change):
    with TemporaryDirectory() as folder:
        path = written(Path(folder), ending)
        content = bytearray(path.read_bytes())
        content[int(place * len(content))] ^= change
        path.write_bytes(content)
        with suppress(SceneError):
            (read_image if ending == "png" else read_cloud)(source(path))

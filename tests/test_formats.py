"""Foreign files: the same cloud, picture or depth reads the same from all of them."""

from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from plyfile import PlyElement
from pypcd4 import Encoding

from rotrecon.scene.formats.cloud import RawCloud
from rotrecon.scene.formats.cloud_file import read_cloud
from rotrecon.scene.formats.depth import read_depth
from rotrecon.scene.formats.image import encode_png, read_image
from rotrecon.scene.formats.npz import encode_npz
from tests.clouds import SHAPE, packed, sample, source, write_pcd, write_ply

LAWS = settings(deadline=None, max_examples=25)
POINTS = arrays(np.float32, SHAPE, elements=st.floats(0.125, 4, width=32))
COLORS = arrays(np.uint8, SHAPE)


def assert_same(cloud: RawCloud, points: np.ndarray, colors: np.ndarray) -> None:
    assert np.array_equal(cloud.points_m, points)
    assert np.array_equal(cloud.colors, colors)


@LAWS
@given(POINTS, COLORS)
def test_every_format_gives_the_same_cloud(points, colors):
    with TemporaryDirectory() as folder:
        here = Path(folder)
        for encoding in (Encoding.ASCII, Encoding.BINARY, Encoding.BINARY_COMPRESSED):
            assert_same(read_cloud(source(write_pcd(here / "a.pcd", points, colors, encoding))), points, colors)
        for text in (True, False):
            grid = ["num_cols 5", "num_rows 4"]
            ply = write_ply(here / "a.ply", points, colors, text=text, obj_info=grid)
            assert_same(read_cloud(source(ply)), points, colors)
        (here / "a.npz").write_bytes(encode_npz(points_m=points, colors=colors))
        assert_same(read_cloud(source(here / "a.npz")), points, colors)


def test_a_float_colour_is_its_bits_and_an_ascii_one_may_be_its_number(tmp_path):
    points, colors = sample()
    header = "VERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 5\nHEIGHT 4\nPOINTS 20\n"
    columns = np.column_stack([points.reshape(-1, 3), packed(colors).view(np.float32)]).astype("<f4")
    (tmp_path / "bits.pcd").write_bytes(f"{header}DATA binary\n".encode() + columns.tobytes())
    assert_same(read_cloud(source(tmp_path / "bits.pcd")), points, colors)
    rows = [
        f"{' '.join(map(repr, map(float, point)))} {number}"
        for point, number in zip(points.reshape(-1, 3), packed(colors, alpha=255), strict=True)
    ]
    (tmp_path / "number.pcd").write_text(f"{header}DATA ascii\n" + "\n".join(rows) + "\n")
    assert_same(read_cloud(source(tmp_path / "number.pcd")), points, colors)


def test_points_that_are_not_valid_are_nan_in_all_three(tmp_path):
    points, _ = sample()
    points[0, 0, 2], points[0, 1, 2], points[0, 2, 0], points[0, 3, 1] = 0, -1, np.inf, np.nan
    (tmp_path / "a.npz").write_bytes(encode_npz(points_m=points))
    read = read_cloud(source(tmp_path / "a.npz"))
    assert np.isnan(read.points_m[0, :4]).all()
    assert np.isfinite(read.points_m[1:]).all()
    assert read.colors is None


def test_a_ply_of_pcl_says_its_raster_in_its_camera(tmp_path):
    points, colors = sample()
    camera = PlyElement.describe(np.array([(5, 4)], [("viewportx", "i4"), ("viewporty", "i4")]), "camera")
    assert_same(read_cloud(source(write_ply(tmp_path / "a.ply", points, colors, elements=[camera]))), points, colors)


def test_a_range_grid_leaves_absent_points_out(tmp_path):
    points, colors = sample()
    cells = [np.array([index], "i4") for index in range(19)] + [np.array([], "i4")]
    rows = np.empty(20, [("vertex_indices", object)])
    rows["vertex_indices"] = cells
    grid = PlyElement.describe(
        rows, "range_grid", len_types={"vertex_indices": "u1"}, val_types={"vertex_indices": "i4"}
    )
    size = ["num_cols 5", "num_rows 4"]
    path = write_ply(
        tmp_path / "a.ply", points.reshape(-1, 3)[:19], colors.reshape(-1, 3)[:19], elements=[grid], comments=size
    )
    read = read_cloud(source(path))
    assert np.isnan(read.points_m[3, 4]).all()
    assert np.array_equal(read.points_m.reshape(-1, 3)[:19], points.reshape(-1, 3)[:19])


def test_a_ply_that_says_nothing_is_not_organised(tmp_path):
    points, colors = sample()
    assert_same(
        read_cloud(source(write_ply(tmp_path / "a.ply", points, colors))), points.reshape(-1, 3), colors.reshape(-1, 3)
    )


@LAWS
@given(COLORS)
def test_a_png_gives_back_its_picture(image):
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.png"
        path.write_bytes(encode_png(image))
        assert np.array_equal(read_image(source(path)), image)


def test_grey_and_jpeg_pictures_become_rgb(tmp_path):
    grey = np.full((8, 8), 77, np.uint8)
    for name in ("a.png", "a.jpg"):
        cv2.imwrite(str(tmp_path / name), grey)
        assert np.array_equal(read_image(source(tmp_path / name)), np.repeat(grey[..., None], 3, axis=-1))


def test_depth_is_nan_where_it_is_not_valid(tmp_path):
    counts = np.array([[0, 1000, 65535], [1, 65534, 250]], np.uint16)
    (tmp_path / "a.png").write_bytes(encode_png(counts))
    expected = np.array([[np.nan, 1, np.nan], [0.001, 65.534, 0.25]], np.float32)
    assert np.array_equal(read_depth(source(tmp_path / "a.png"), 0.001), expected, equal_nan=True)
    metres = np.array([[np.nan, 1, 1e30], [-1, 0, 0.25]])
    (tmp_path / "a.npz").write_bytes(encode_npz(depth_m=metres))
    expected = np.array([[np.nan, 1, np.nan], [np.nan, np.nan, 0.25]], np.float32)
    assert np.array_equal(read_depth(source(tmp_path / "a.npz"), None), expected, equal_nan=True)

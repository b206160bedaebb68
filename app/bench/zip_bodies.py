"""What schemathesis pushes in: ZIP files of scene folders that are nearly right, and bytes that are none.

Read by schemathesis itself, in its own process: see `app.bench.fuzzed`.
"""

from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile

import schemathesis  # pyright: ignore[reportMissingImports]
from hypothesis import strategies as st

CAMERA = "[cameras.main]\nsize = {size}\nK = {K}\ndistortion = {distortion}\n"
FRAME = '[frame]\ncamera = "main"\ndepth = "depth.png"\ndepth_scale = {scale}\nT_base_camera = {pose}\n'
VIEW = '[[views]]\ncamera = "main"\nimage = "image.png"\nT_base_camera = {pose}\n'
NUMBERS = st.sampled_from(["0", "1", "-1", "32", "1e308", "nan", "inf", "65536", "0.5", '"a"', "[]", "true"])
ROW = st.lists(NUMBERS, max_size=5).map(lambda row: f"[{', '.join(row)}]")
MATRIX = st.lists(ROW, max_size=5).map(lambda rows: f"[{', '.join(rows)}]")
IDENTITY = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
POSES = st.just(IDENTITY) | MATRIX
CALIBRATIONS = st.just("[[30, 0, 15.5], [0, 30, 11.5], [0, 0, 1]]") | MATRIX
SIZES = st.just("[32, 24]") | ROW
TABLES = st.builds(
    lambda head, size, K, distortion, scale, pose, part: (
        f"{head}\n{CAMERA.format(size=size, K=K, distortion=distortion)}{part.format(scale=scale, pose=pose)}"
    ),
    st.sampled_from(['format = 1\nname = "a"', "format = 2", 'name = ""', ""]),
    SIZES,
    CALIBRATIONS,
    ROW,
    NUMBERS,
    POSES,
    st.sampled_from([FRAME, VIEW, VIEW + VIEW, FRAME + VIEW, ""]),
)
NAMES = st.sampled_from(["depth.png", "image.png", "../out", "/etc/passwd", "a/b/c", "depth.png/inside", "con", "é"])
FILES = st.dictionaries(NAMES, st.binary(max_size=200), max_size=3)


def _zipped(table: str, files: dict[str, bytes]) -> bytes:
    packed = BytesIO()
    with ZipFile(packed, "w", ZIP_DEFLATED) as archive:
        archive.writestr("scene.toml", table)
        for name, content in files.items():
            archive.writestr(name, content)
    return packed.getvalue()


BODIES = st.binary(max_size=500) | st.builds(_zipped, TABLES | st.text(max_size=100), FILES)
schemathesis.openapi.media_type("application/zip", BODIES)


@schemathesis.serializer("application/zip")
def serialize(context: object, value: object) -> bytes:
    """The body as it is."""
    return value if isinstance(value, bytes) else str(value).encode()

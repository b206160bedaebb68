"""Bytes that claim to be a scene: whatever they are, they are read or refused with a reason."""

from contextlib import suppress
from io import BytesIO
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.robot.pushing import NotAScene, read_pushed
from rotrecon.scene.writing import SceneRecord, write_scene
from tests.exact import cylinder, exact_frame


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> dict[int, bytes]:
    """One small scene, packed and stored."""
    folder: Path = tmp_path_factory.mktemp("pushed") / "scene"
    write_scene(
        folder, SceneRecord("Pushed", exact_frame(cylinder(np.array([0.0, 0.0, 0.8]), np.array([0.0, 1.0, 0.0]), 0.06)))
    )
    packed = {}
    for method in (ZIP_DEFLATED, ZIP_STORED):
        content = BytesIO()
        with ZipFile(content, "w", method) as archive:
            for path in sorted(folder.iterdir()):
                archive.write(path, path.name)
        packed[method] = content.getvalue()
    return packed


def test_a_scene_is_read_and_nothing_of_it_stays_on_disk(scenes: dict[int, bytes]) -> None:
    capture = read_pushed(BytesIO(scenes[ZIP_DEFLATED]))
    assert capture.name == "Pushed"
    assert capture.recorded is not None
    assert capture.recorded.points_m.shape == (240, 320, 3)


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_a_scene_with_bytes_changed_is_read_or_refused(scenes: dict[int, bytes], data: st.DataObject) -> None:
    content = bytearray(scenes[data.draw(st.sampled_from([ZIP_DEFLATED, ZIP_STORED]))])
    ends = st.integers(0, 400) | st.integers(len(content) - 400, len(content) - 1) | st.integers(0, len(content) - 1)
    for place in data.draw(st.lists(ends, min_size=1, max_size=6)):
        content[place] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        del content[data.draw(st.integers(0, len(content) - 1)) :]
    with suppress(NotAScene):
        read_pushed(BytesIO(bytes(content)))


@settings(max_examples=100, deadline=None)
@given(text=st.binary(max_size=200), start=st.booleans())
def test_any_scene_toml_is_read_or_refused(text: bytes, start: bool) -> None:
    head = b'format = 1\nname = "a"\n' if start else b""
    content = BytesIO()
    with ZipFile(content, "w") as archive:
        archive.writestr("scene.toml", head + text)
    with pytest.raises(NotAScene):
        read_pushed(content)

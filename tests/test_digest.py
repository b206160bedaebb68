"""The digest that a decision is bound to: equal for equal evidence, another for whatever differs."""

from collections.abc import Callable
from copy import copy
from dataclasses import fields, is_dataclass, replace
from datetime import UTC, datetime, timedelta
from typing import Any, get_args, get_type_hints

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.digest import evidence_digest, frame_id, tree_of
from app.record.tree import KNOWN, as_tree, canonical, from_tree, in_full
from rotrecon.drawing import Constraints, Drawing
from rotrecon.frame import DepthCameraNoise, Frame, StereoNoise
from rotrecon.reconstruct import reconstruct
from rotrecon.reconstruction import Reconstruction
from rotrecon.settings import Settings
from rotrecon.workspace import Workspace
from tests.exact import cylinder, drawing_along, exact_frame

SOLID = cylinder(np.array([0.0, 0.0, 0.9]), np.array([0.1, 1.0, 0.2]), 0.06)
FRAME = replace(
    exact_frame(SOLID),
    noise=StereoNoise(0.05, 0.1),
    workspace=Workspace((0.1, 3.0), np.array([[-2.0, -2.0, -2.0], [2.0, 2.0, 2.0]]), (0.2, 2.9)),
    captured_at=datetime(2026, 1, 31, 12, tzinfo=UTC),
)
DRAWING = replace(drawing_along(SOLID), excluded_sections=frozenset({3}), constraints=Constraints((0.02, 0.04)))
SETTINGS = Settings()
RESULT = reconstruct(FRAME, DRAWING, SETTINGS)
BEFORE = evidence_digest(FRAME, DRAWING, SETTINGS, RESULT)
Change = tuple[str, Callable[[], Any]]


def changes(value: Any, name: str = "") -> list[Change]:
    """Every single member of nested data changed a little: a path, and what makes the changed copy."""
    if isinstance(value, msgspec.Struct) or is_dataclass(value):
        members = value.__struct_fields__ if isinstance(value, msgspec.Struct) else [f.name for f in fields(value)]
        swap = msgspec.structs.replace if isinstance(value, msgspec.Struct) else forced
        return [
            (path, lambda made=made, member=member: swap(value, **{member: made()}))
            for member in members
            for path, made in changes(getattr(value, member), f"{name}.{member}")
        ]
    if isinstance(value, tuple) and value:
        return [
            (path, lambda made=made, at=at: (*value[:at], made(), *value[at + 1 :]))
            for at, member in enumerate(value)
            for path, made in changes(member, f"{name}[{at}]")
        ] + [(f"{name} shorter", lambda: value[:-1])]
    return [(name, lambda: other(value))]


def forced(value: Any, **changed: Any) -> Any:
    """A copy with another member, also one that the class itself would refuse."""
    copied = copy(value)
    for name, member in changed.items():
        object.__setattr__(copied, name, member)
    return copied


def other(value: Any) -> Any:
    """A value next to this one, of the same kind."""
    if isinstance(value, np.ndarray):
        changed = value.copy()
        flat = changed.reshape(-1).view(np.uint8)
        flat[len(flat) // 2] ^= 1
        return changed
    match value:
        case bool():
            return not value
        case int():
            return value + 1
        case float():
            return float(np.nextafter(value, 0.0 if value == np.inf else np.inf))
        case str():
            return f"{value}x"
        case frozenset():
            return value | {999}
        case datetime():
            return value + timedelta(microseconds=1)
    assert value is None or value == ()
    return "something"


def parts() -> list[tuple[str, str, Callable[[], Any]]]:
    given = {"frame": FRAME, "drawing": DRAWING, "settings": SETTINGS}
    found = [(part, path, made) for part, value in given.items() for path, made in changes(value, part)]
    results = [name for name in (field.name for field in fields(Reconstruction)) if name not in given]
    for name in results:
        value = getattr(RESULT, name)
        found += [
            ("result", path, lambda made=made, name=name: replace(RESULT, **{name: made()}))
            for path, made in changes(value, name)
        ]
    return found


PARTS = parts()


@pytest.mark.parametrize(("part", "path", "changed"), PARTS, ids=[path for _, path, _ in PARTS])
def test_any_member_changed_changes_the_digest(part, path, changed):
    evidence = {"frame": FRAME, "drawing": DRAWING, "settings": SETTINGS, "result": RESULT}
    evidence[part] = changed()
    assert evidence_digest(**evidence) != BEFORE


def test_the_members_that_are_changed_reach_calibration_tools_and_numbers():
    paths = " ".join(path for _, path, _ in PARTS)
    for member in (
        "frame.camera.K",
        "frame.T_base_camera",
        "frame.noise.baseline_m",
        "settings.tools[1].diameter_mm[0]",
    ):
        assert member in paths
    assert "fit.solid.radius_m" in paths
    assert "segmentation.history" in paths


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_any_bit_of_any_array_changes_the_digest(data):
    name = data.draw(st.sampled_from(["image", "points_m"]))
    changed = getattr(FRAME, name).copy()
    flat = changed.reshape(-1).view(np.uint8)
    at, bit = data.draw(st.integers(0, len(flat) - 1)), data.draw(st.integers(0, 7))
    flat[at] ^= 1 << bit
    assert frame_id(replace(FRAME, **{name: changed})) != frame_id(FRAME)


def test_the_digest_is_of_the_content_and_not_of_the_objects():
    copied = from_tree(tree_of(FRAME), dict(arrays_of(FRAME)).__getitem__)
    assert copied is not FRAME
    again = reconstruct(copied, DRAWING, SETTINGS)
    assert evidence_digest(copied, replace(DRAWING), replace(SETTINGS), again) == BEFORE
    fortran = replace(FRAME, points_m=np.asfortranarray(FRAME.points_m))
    assert frame_id(fortran) == frame_id(FRAME)


def test_what_is_hashed_is_written_in_one_way_only():
    value = (1, 1.0, 0.1, -0.0, float("inf"), True, None, "ä", frozenset({2, 1}), datetime(2026, 1, 31, tzinfo=UTC))
    written = (
        '[1,1.0,0.1,-0.0,{"number":"inf"},true,null,"\\u00e4",{"set":[1,2]},{"datetime":"2026-01-31T00:00:00+00:00"}]'
    )
    assert canonical(as_tree(value, in_full)).decode() == written
    with pytest.raises(ValueError, match="not JSON compliant"):
        canonical([float("nan")])


def arrays_of(value: Any) -> list[tuple[str, bytes]]:
    kept: list[tuple[str, bytes]] = []

    def keep(array: np.ndarray) -> Any:
        tree = tree_of(array)
        kept.append((tree["array"], array.tobytes()))
        return tree

    as_tree(value, keep)
    return kept


finite = st.floats(allow_nan=False, allow_infinity=False)
noises = st.none() | st.builds(StereoNoise, finite, finite) | st.builds(DepthCameraNoise, finite, finite)
workspaces = st.builds(
    Workspace, st.none() | st.tuples(finite, finite), st.none(), st.none() | st.tuples(finite, finite)
)
frames = st.builds(
    lambda seed, shape, noise, workspace, when: Frame(
        np.random.default_rng(seed).integers(0, 256, (*shape, 3), dtype=np.uint8),
        np.random.default_rng(seed).integers(0, 2**32, (*shape, 3), dtype=np.uint32).view(np.float32),
        replace(FRAME.camera, width=shape[1], height=shape[0]),
        noise=noise,
        workspace=workspace,
        captured_at=when,
    ),
    st.integers(0, 2**32),
    st.tuples(st.integers(1, 6), st.integers(1, 6)),
    noises,
    workspaces,
    st.none() | st.datetimes() | st.datetimes(timezones=st.just(UTC)),
)


@settings(max_examples=60, deadline=None)
@given(frames)
def test_a_frame_comes_back_from_its_tree_to_the_last_bit(frame):
    back = from_tree(tree_of(frame), dict(arrays_of(frame)).__getitem__)
    assert back.points_m.tobytes() == frame.points_m.tobytes()
    assert back.image.tobytes() == frame.image.tobytes()
    assert (back.noise, back.captured_at, back.workspace.depth_m) == (
        frame.noise, frame.captured_at, frame.workspace.depth_m
    )  # fmt: skip
    assert frame_id(back) == frame_id(frame)


numbers = st.floats() | st.integers() | st.booleans() | st.text() | st.none()


@settings(max_examples=100, deadline=None)
@given(st.recursive(numbers, lambda inner: st.lists(inner).map(tuple), max_leaves=10))
def test_numbers_come_back_exactly(value):
    tree = as_tree(value, in_full)
    assert repr(from_tree(tree, lambda digest: b"")) == repr(value)
    assert canonical(as_tree(from_tree(tree, lambda digest: b""), in_full)) == canonical(tree)


def test_drawings_and_settings_come_back():
    for value in (DRAWING, SETTINGS, Drawing(DRAWING.area)):
        assert from_tree(tree_of(value), lambda digest: b"") == value


def data_types(of: Any) -> set[type]:
    """The dataclasses and structs that a type is made of, itself among them."""
    inner = set().union(*(data_types(argument) for argument in get_args(of)))
    if not (is_dataclass(of) or (isinstance(of, type) and issubclass(of, msgspec.Struct))):
        return inner
    return {of} | inner.union(*(data_types(hint) for hint in get_type_hints(of).values()))


def test_all_that_a_measurement_is_made_of_can_be_read_back():
    assert data_types(Frame) | data_types(Drawing) | data_types(Settings) <= set(KNOWN.values())
    assert StereoNoise in data_types(Frame)


def test_what_another_version_wrote_is_refused_and_not_guessed():
    tree = tree_of(DRAWING)
    tree["Drawing"]["colour"] = "red"
    with pytest.raises(ValueError, match="version of the program"):
        from_tree(tree, lambda digest: b"")
    with pytest.raises(ValueError, match="Unheard is not of this version"):
        from_tree({"Unheard": {}}, lambda digest: b"")
    with pytest.raises(TypeError, match="has no place in the record"):
        tree_of(object())

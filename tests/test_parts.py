from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.rays.lateral import Lateral
from rotrecon.turned.parts import Part, parts_of
from rotrecon.turned.profile import Profile, profile_of
from rotrecon.turned.turned_fit import fit_turned
from tests.bodies import BODIES, seen

SEEDS = range(5)


def profile(height: np.ndarray, radius: np.ndarray, sigma_m: float, lean: float = 0.0, alike_m: float = 0.0) -> Profile:
    own = np.full(len(height), sigma_m)
    return Profile(height, radius, radius - 1.96 * own, radius + 1.96 * own, own, lean, alike_m)


def noise(count: int, seed: int, alike: int = 1) -> np.ndarray:
    """Of standard deviation 1, smoothed over some heights."""
    white = np.random.default_rng(seed).standard_normal(count + alike - 1)
    return np.convolve(white, np.ones(alike), "valid") / np.sqrt(alike)


@given(
    st.integers(0, 2**32 - 1),
    st.floats(1e-6, 2e-3),
    st.integers(20, 120),
    st.sampled_from([1, 2, 4]),
    st.sampled_from([0.0, 0.01, 0.1]),
)
@settings(max_examples=150, deadline=None)
def test_a_cylinder_is_one_part_whatever_the_noise(seed, sigma_m, count, alike, lean):
    height = np.arange(count) * 0.002
    rng = np.random.default_rng(seed)
    radius = 0.04 + sigma_m * noise(count, seed, alike) + lean * rng.standard_normal() * (height - height.mean())
    (part,) = parts_of(profile(height, radius, sigma_m, lean, 0.002 * (alike if alike > 1 else 0)))
    assert part.kind == "cylinder"
    # what an axis that leans does to all radii together is not this interval's, but the profile's
    if lean == 0.0:
        assert part.radius_interval_m[0] - 0.01 * sigma_m <= 0.04 + 3 * sigma_m
        assert abs(part.radius_m - 0.04) < 5 * sigma_m * np.sqrt(alike / count) + 1e-9


@given(st.integers(0, 2**32 - 1), st.floats(1e-5, 5e-4), st.floats(-0.8, 0.8), st.integers(30, 100))
@settings(max_examples=60, deadline=None)
def test_a_cone_is_one_part(seed, sigma_m, slope, count):
    height = np.arange(count) * 0.002
    radius = 0.15 + slope * height + sigma_m * noise(count, seed)
    (part,) = parts_of(profile(height, radius, sigma_m))
    if abs(slope) > 50 * sigma_m:
        assert part.kind == "cone"
        assert part.slope == pytest.approx(slope, abs=0.02 + 10 * sigma_m)
        assert part.low_m == pytest.approx(-0.001, abs=0.0045)
        assert part.high_m == pytest.approx(height[-1] + 0.001, abs=0.0045)


@given(st.integers(0, 2**32 - 1), st.floats(0.03, 0.08), st.floats(-0.02, 0.02))
@settings(max_examples=40, deadline=None)
def test_a_ball_is_one_part_with_its_centre_and_radius(seed, size_m, center_m):
    height = center_m + np.linspace(-0.8, 0.8, 60) * size_m
    radius = np.sqrt(size_m**2 - (height - center_m) ** 2) + 1e-4 * noise(60, seed)
    (part,) = parts_of(profile(height, radius, 1e-4))
    assert part.kind == "sphere"
    assert part.center_m == pytest.approx(center_m, abs=5e-4)
    assert part.radius_interval_m[0] - 1e-4 <= size_m <= part.radius_interval_m[1] + 1e-4
    assert part.radius_m == pytest.approx(size_m, abs=5e-4)


@given(st.integers(0, 2**32 - 1), st.integers(15, 45), st.floats(0.003, 0.02))
@settings(max_examples=40, deadline=None)
def test_a_step_makes_two_cylinders_at_its_height(seed, at, step_m):
    height = np.arange(60) * 0.002
    radius = 0.03 + np.where(np.arange(60) >= at, step_m, 0.0) + 2e-4 * noise(60, seed)
    below, above = parts_of(profile(height, radius, 2e-4))
    assert (below.kind, above.kind) == ("cylinder", "cylinder")
    assert below.high_m == above.low_m == pytest.approx((at - 0.5) * 0.002, abs=0.0045)
    assert above.radius_m - below.radius_m == pytest.approx(step_m, abs=3e-4)


@pytest.mark.parametrize("seed", range(5))
def test_pixels_that_straddle_an_edge_are_no_part(seed):
    height = np.arange(60) * 0.002
    radius = 0.03 + np.interp(height, [0.058, 0.066], [0.0, 0.012]) + 1e-4 * noise(60, seed)
    radius[29:33] += [0.002, -0.001, 0.003, -0.001]
    parts = parts_of(profile(height, radius, 1e-4))
    assert [part.kind for part in parts] == ["cylinder", "cylinder"]
    assert parts[0].high_m == pytest.approx(0.062, abs=0.004)


def bottle(seed: int) -> tuple[np.ndarray, np.ndarray]:
    height = np.arange(100) * 0.002
    return height, np.interp(height, [0.0, 0.13, 0.16, 0.2], [0.035, 0.035, 0.014, 0.014]) + 1e-4 * noise(100, seed)


@pytest.mark.parametrize("seed", range(10))
def test_a_bottle_is_a_cylinder_a_cone_and_a_cylinder(seed):
    parts = parts_of(profile(*bottle(seed), 1e-4))
    assert [part.kind for part in parts] == ["cylinder", "cone", "cylinder"]
    assert [part.high_m for part in parts[:2]] == pytest.approx([0.13, 0.16], abs=0.001)
    assert parts[1].slope_interval is not None
    assert parts[1].slope_interval[0] <= -0.7 <= parts[1].slope_interval[1]
    assert parts[0].radius_interval_m[0] - 5e-5 <= 0.035 <= parts[0].radius_interval_m[1] + 5e-5


@given(st.integers(0, 20), st.floats(0.1, 10.0))
@settings(max_examples=20, deadline=None)
def test_parts_grow_with_the_object_and_turn_round_with_the_axis(seed, scale):
    height, radius = bottle(seed)
    plain = parts_of(profile(height, radius, 1e-4))
    larger = parts_of(profile(scale * height, scale * radius, scale * 1e-4))
    assert [part.kind for part in larger] == [part.kind for part in plain]
    for part, other in zip(plain, larger, strict=True):
        assert other.high_m == pytest.approx(scale * part.high_m, rel=1e-6)
        assert other.radius_m == pytest.approx(scale * part.radius_m, rel=1e-6)
        assert other.slope == pytest.approx(part.slope, abs=1e-6)
    turned = parts_of(profile(-height[::-1], radius[::-1], 1e-4))
    assert [part.kind for part in turned] == [part.kind for part in plain][::-1]
    assert [-part.low_m for part in turned[::-1]][:2] == pytest.approx([part.high_m for part in plain][:2], abs=0.002)


def test_stray_and_unknown_heights_are_no_parts():
    height, radius = bottle(3)
    radius = radius.copy()
    radius[[20, 71]] += 0.004
    radius[40:45] = np.nan
    parts = parts_of(profile(height, radius, 1e-4))
    assert [part.kind for part in parts] == ["cylinder", "cone", "cylinder"]
    assert parts_of(profile(height[:3], radius[:3], 1e-4)) == ()
    assert parts_of(profile(height, np.full(100, np.nan), 1e-4)) == ()


def test_a_slope_that_the_axis_may_have_made_is_none():
    height = np.arange(60) * 0.002
    radius = 0.04 + 0.02 * height + 5e-5 * noise(60, 0)
    sure = parts_of(profile(height, radius, 5e-5))
    unsure = parts_of(profile(height, radius, 5e-5, lean=0.02))
    assert [part.kind for part in sure] == ["cone"]
    assert [part.kind for part in unsure] == ["cylinder"]


def test_what_moves_all_radii_widens_every_interval():
    height, radius = bottle(1)
    own = profile(height, radius, 1e-4)
    both = replace(own, low_m=own.low_m - 0.001, high_m=own.high_m + 0.001)
    for part, other in zip(parts_of(own), parts_of(both), strict=True):
        assert width(other) > 0.001 > width(part)


def width(part: Part) -> float:
    return part.radius_interval_m[1] - part.radius_interval_m[0]


@pytest.mark.parametrize("name", [name for name in BODIES if name != "vase"])
def test_objects_fall_into_their_parts(name):
    right, off = [], []
    for seed in SEEDS:
        body, patch, edge = seen(BODIES[name], seed)
        fit = fit_turned(patch, edge)
        assert fit is not None
        assert isinstance(fit.surface, Lateral)
        heights = np.arange(fit.surface.low_m, fit.surface.high_m, 0.002)
        parts = parts_of(profile_of(fit, patch, heights))
        # a step is two knees at one height
        true = np.unique([height for height, _ in body.knees])[1:-1]
        borders = np.sort(body.on(fit.surface, np.array([part.low_m for part in parts[1:]])))
        right.append(len(borders) == len(true))
        if right[-1]:
            off += list(np.abs(borders - true))
    assert np.mean(right) >= 0.9
    # pixels are a millimetre wide there
    assert max(off, default=0.0) < 0.004
    assert np.median(off or [0.0]) < 0.003

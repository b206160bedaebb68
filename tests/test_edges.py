"""The outline in the picture: laws on drawn steps whose place is known, and one rendered object."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from rotrecon.camera import PinholeCamera
from rotrecon.edges.edges import find_edges
from rotrecon.edges.light import LINEAR_LIGHT, LightSpline
from rotrecon.simulation.ideal_drawing import outline_px
from rotrecon.simulation.simulate import simulate
from tests.strips import (
    DARK,
    LENGTH,
    LIGHT,
    MIDDLE,
    REACH_PX,
    SIZE,
    WALL,
    WOOD,
    covered,
    distances,
    encoded,
    found_on,
    mean_of,
    sides_of,
    strip,
    texture,
)


@settings(max_examples=30, deadline=None)
@given(
    angle=st.floats(0, np.pi),
    half_width=st.floats(6.0, 30.0),
    shift=st.floats(-3.0, 3.0),
    tilt_deg=st.floats(-1.5, 1.5),
    blur=st.floats(0.4, 0.9),
    colours=st.sampled_from([(WOOD, WALL), (WALL, WOOD), (DARK, LIGHT), (LIGHT, DARK), (LIGHT, WALL)]),
)
def test_a_step_is_found_wherever_it_is(angle, half_width, shift, tilt_deg, blur, colours):
    tilt = np.deg2rad(tilt_deg)
    edges = found_on(encoded(strip(angle, half_width, *colours, blur)), angle, half_width, shift, tilt)
    true = -shift - np.tile((np.arange(LENGTH) - (LENGTH - 1) / 2) * np.tan(tilt), 2)
    assert all(side.trusted for side in edges.sides)
    error = edges.offset_px - true
    # along the rows of pixels it ripples nowhere: all of it is off by as much
    along_rows = abs(np.sin(2 * angle)) < 0.1
    assert np.abs(error).max() < (0.1 if along_rows else 0.08), "a sharp edge ripples as it crosses the rows of pixels"
    assert max(abs(error[:LENGTH].mean()), abs(error[LENGTH:].mean())) < (0.1 if along_rows else 0.05)
    assert all(side.sigma_px < 0.15 for side in edges.sides)


@settings(max_examples=15, deadline=None)
@given(
    angle=st.floats(0, np.pi), half_width=st.floats(12.0, 25.0), lamp=st.floats(-0.35, 0.35), seed=st.integers(0, 99)
)
def test_shading_that_is_steepest_inside_a_limb_is_no_edge(angle, half_width, lamp, seed):
    """An even cylinder in the light of a lamp beside the camera, before a textured wall as bright as its limbs.

    A lamp farther aside leaves the last of a limb in its own shadow; less than 12 px do not tell how it is lit.
    """
    away = distances(angle) / half_width
    facing = np.cos(lamp) * np.sqrt(np.clip(1 - away**2, 0, 1)) + np.sin(lamp) * away
    lit = (0.25 + 0.75 * facing.clip(0, 1))[..., None] * np.array(WOOD) * 1.6
    wall = np.array(WOOD) * 0.9 * (1 + 0.15 * texture(seed, 2.0))
    inside = covered(np.abs(distances(angle)) - half_width, 0.4)[..., None]
    edges = found_on(encoded(inside * lit + (1 - inside) * wall), angle, half_width)
    for number, side in enumerate(edges.sides):
        if side.trusted:
            assert abs(mean_of(edges, slice(number * LENGTH, (number + 1) * LENGTH))) < 0.45


def test_colours_of_equal_grey_make_an_edge():
    green, red = LINEAR_LIGHT[[59, 130, 60]], LINEAR_LIGHT[[147, 85, 61]]
    edges = found_on(encoded(strip(0.4, 15, green, red)), 0.4, 15, shift=1.7)
    assert all(side.trusted for side in edges.sides)
    assert np.abs(edges.offset_px + 1.7).max() < 0.05


@pytest.mark.parametrize("name", ["blur", "prediction", "quarter turn", "whole pixels"])
def test_what_must_not_matter(name):
    angle, half_width, grain = 0.7, 14.0, 2.0
    light = strip(angle, half_width, WOOD, WALL) * (1 + 0.1 * texture(3, grain))
    image = encoded(light)
    point, normal, side = sides_of(angle, half_width, shift=1.0)
    before = find_edges(image, point, normal, REACH_PX, half_width, side).offset_px
    if name == "prediction":
        moved = find_edges(image, point + 0.6 * normal, normal, REACH_PX, half_width, side).offset_px + 0.6
        np.testing.assert_allclose(moved, before, atol=0.05)
    elif name == "quarter turn":
        turned = np.ascontiguousarray(np.rot90(image))  # (u, v) goes to (v, SIZE - 1 - u)
        point = np.stack([point[:, 1], SIZE - 1 - point[:, 0]], axis=1)
        normal = np.stack([normal[:, 1], -normal[:, 0]], axis=1)
        after = find_edges(turned, point, normal, REACH_PX, half_width, side).offset_px
        np.testing.assert_allclose(after, before, atol=1e-4)
    elif name == "whole pixels":
        larger = np.pad(image, ((7, 0), (11, 0), (0, 0)), mode="edge")
        moved = find_edges(larger, point + np.array([11, 7]), normal, REACH_PX, half_width, side).offset_px
        np.testing.assert_allclose(moved, before, atol=1e-6)
    else:
        blurred = encoded(strip(angle, half_width, WOOD, WALL, 1.0) * (1 + 0.1 * texture(3, grain)))
        after = find_edges(blurred, point, normal, REACH_PX, half_width, side).offset_px
        assert abs(np.nanmean(after) - np.nanmean(before)) < 0.05


def test_shading_toward_the_limb_moves_nothing():
    inside = np.maximum(14 - np.abs(distances(0.3)), 0)[..., None]
    shaded = strip(0.3, 14, (0.3, 0.25, 0.2), (0.02, 0.02, 0.02))
    image = encoded(shaded * (0.6 + 0.05 * inside))
    assert np.abs(found_on(image, 0.3, 14, shift=1.0).offset_px + 1.0).max() < 0.1


@pytest.mark.parametrize("seed", range(4))
def test_texture_on_either_side_is_no_edge_and_the_error_is_as_stated(seed):
    angle, half_width = 0.4 + seed, 15.0
    inner, outer = (1 + 0.15 * texture(seed + offset, 2.0, 1) for offset in (10, 20))
    inside = covered(np.abs(distances(angle)) - half_width, 0.5)[..., None]
    light = inside * inner * np.array(WOOD) + (1 - inside) * outer * np.array(WALL)
    edges = found_on(encoded(light), angle, half_width, shift=-2.0)
    for number, side in enumerate(edges.sides):
        rows = np.arange(LENGTH) + number * LENGTH
        assert side.trusted
        error = mean_of(edges, rows) - 2.0
        assert abs(error) < 0.12
        assert abs(error) < 3 * side.sigma_px
        together = np.nansum(edges.sigma_px[rows] ** -2.0) ** -0.5
        assert together == pytest.approx(side.sigma_px, rel=0.01)


@pytest.mark.parametrize("radius", [12.0, 40.0])
def test_a_round_outline_is_moved_and_grown_in_one_piece(radius):
    v, u = np.indices((SIZE, SIZE), dtype=np.float64)
    inside = covered(np.hypot(u - MIDDLE[0], v - MIDDLE[1]) - radius, 0.5)[..., None]
    image = encoded(inside * np.array(WOOD) + (1 - inside) * np.array(WALL))
    angle = np.linspace(0, 2 * np.pi, round(2 * np.pi * radius), endpoint=False)
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    moved = np.array([1.4, -0.9])
    point = MIDDLE + moved + (radius - 1.2) * normal
    edges = find_edges(image, point, normal, REACH_PX, radius)
    to_centre = point - MIDDLE
    ahead = (to_centre * normal).sum(axis=1)
    true = -ahead + np.sqrt(ahead**2 - (to_centre**2).sum(axis=1) + radius**2)
    assert edges.sides[0].trusted
    assert np.nanmax(np.abs(edges.offset_px - true)) < 0.1
    assert edges.sides[0].found > 0.95


def test_the_sides_of_a_rendered_object():
    camera = PinholeCamera(320, 240, np.array([[420.0, 0, 159.5], [0, 420.0, 119.5], [0, 0, 1]]))
    scene = simulate("cone", 4, camera, noise=None, supersampling=4)
    corners = outline_px(scene.solid_in_camera, camera)
    ends = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    limbs = ends[np.argsort(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))[-2:]]
    middle = limbs.mean(axis=(0, 1))
    errors = []
    for start, end in limbs:
        along = (end - start) / np.linalg.norm(end - start)
        normal = np.array([-along[1], along[0]])
        normal *= np.sign(normal @ (start - middle))
        share = np.linspace(0.08, 0.92, 60)
        point = start + share[:, None] * (end - start)
        half_width = abs(normal @ (start - middle))
        edges = find_edges(scene.frame.image, point + 2.5 * normal, np.tile(normal, (60, 1)), REACH_PX, half_width)
        assert edges.sides[0].trusted
        errors.append(mean_of(edges, np.arange(60)) + 2.5)
    assert np.abs(errors).max() < 0.1


@pytest.mark.parametrize("size", [(40, 60), (9, 13)])
def test_light_between_pixels_is_that_of_the_cubic_splines(size):
    rng = np.random.default_rng(0)
    image = rng.integers(0, 256, (*size, 3), dtype=np.uint8)
    point = rng.uniform(0, size[::-1], (30, 2))
    angle = rng.uniform(0, 2 * np.pi, 30)
    normal, offset = np.stack([np.cos(angle), np.sin(angle)], axis=1), rng.normal(size=30)
    across = np.array([-4.0, -1.5, 0.0, 2.5])
    place = point + (across[:, None] + offset)[..., None] * normal
    expected = [
        ndimage.map_coordinates(
            ndimage.spline_filter(LINEAR_LIGHT[image[..., channel]]),
            [place[..., 1], place[..., 0]],
            prefilter=False,
            mode="nearest",
        )
        for channel in range(3)
    ]
    found = LightSpline.of(image).across(point, normal, offset, across)
    np.testing.assert_allclose(found, expected, atol=1e-12)

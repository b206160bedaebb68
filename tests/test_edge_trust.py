"""Whether an edge in the picture is the outline: what else may be there, and what is left out."""

import numpy as np
import pytest

from rotrecon.edges.edge_steps import CLEAR_PX
from rotrecon.edges.edges import LEAST_HALF_WIDTH_PX, find_edges
from tests.strips import (
    DARK,
    LENGTH,
    LIGHT,
    MIDDLE,
    REACH_PX,
    SIZE,
    WALL,
    WOOD,
    distances,
    encoded,
    found_on,
    mean_of,
    sides_of,
    strip,
    texture,
)


def test_nothing_is_found_where_there_is_nothing():
    edges = found_on(np.full((SIZE, SIZE, 3), 90, dtype=np.uint8), 0.5, 15)
    assert np.isnan(edges.offset_px).all()
    assert not any(side.trusted for side in edges.sides)


@pytest.mark.parametrize("grain", [0.0, 1.0, 3.0, 6.0])
def test_texture_alone_is_not_trusted(grain):
    trusted = [
        side.trusted
        for seed in range(16)
        for side in found_on(encoded(0.3 * (1 + 0.25 * texture(seed, grain))), 0.5, 15).sides
    ]
    assert sum(trusted) <= 3, "32 sides that are not there"


@pytest.mark.parametrize(("colour", "stronger"), [((0.29, 0.20, 0.12), False), ((0.22, 0.25, 0.25), True)])
def test_a_print_that_runs_along_the_inside_is_not_the_outline(colour, stronger):
    light = strip(0.5, 16, WOOD, WALL)
    light[np.abs(np.abs(distances(0.5)) - 12) < 1.5] = colour
    edges = found_on(encoded(light), 0.5, 16)
    assert np.isnan(edges.offset_px).all() if stronger else np.abs(edges.offset_px).max() < 0.1
    for side in edges.sides:
        # it is farther from the prediction than the outline, and would outvote it but for that
        assert (side.runner_up > 0.8 * side.support) == stronger
        assert side.trusted != stronger


def test_two_lines_of_like_strength_are_told_and_not_trusted():
    light = strip(0.5, 16, WOOD, WALL)
    beside = (np.abs(distances(0.5)) > 16) & (np.abs(distances(0.5)) < 19.5)
    light[beside] = (0.10, 0.10, 0.11)
    for side in found_on(encoded(light), 0.5, 16).sides:
        assert side.runner_up > 0.5
        assert not side.trusted


def test_what_is_known_of_the_prediction_tells_two_lines_of_like_strength_apart():
    light = strip(0.5, 16, WOOD, WALL)
    beside = (np.abs(distances(0.5)) > 16) & (np.abs(distances(0.5)) < 19.5)
    light[beside] = (0.10, 0.10, 0.11)
    for shift, is_near in ((3.5, True), (0.0, False)):
        point, normal, side = sides_of(0.5, 16, shift)
        edges = find_edges(encoded(light), point, normal, REACH_PX, 16, side, spread_px=1.0)
        assert all(one.trusted == is_near for one in edges.sides), (
            "the outer line is the outline, if it is where it may be"
        )


def test_a_clear_stretch_that_is_elsewhere_does_not_outvote_all_others():
    u = np.indices((SIZE, SIZE))[1]
    clear = ((u > 60) & (u < 76))[..., None]
    faint = strip(0.0, 15, (0.30, 0.25, 0.22), WALL) * (1 + 0.08 * texture(1, 1.0))
    edges = found_on(encoded(np.where(clear, strip(0.0, 15.6, DARK, LIGHT), faint)), 0.0, 15)
    both = [mean_of(edges, slice(number * LENGTH, (number + 1) * LENGTH)) for number in (0, 1)]
    assert max(both) < 0.6 * 15 / LENGTH + 0.08, "it has little more of a say than its length"


def test_what_hides_a_part_of_a_side_is_left_out():
    light = strip(0.0, 15, WOOD, WALL)
    light[70:100, 40:60] = WOOD
    edges = found_on(encoded(light), 0.0, 15, shift=1.0)
    column = np.where(np.arange(2 * LENGTH) < LENGTH, sides_of(0.0, 15)[0][:, 0], np.inf)
    assert np.isnan(edges.offset_px[(column > 43) & (column < 56)]).all()
    beside = (column < 36) | (column > 63)
    assert np.abs(edges.offset_px[beside] + 1.0).max() < 0.1
    assert edges.sides[0].found < edges.sides[1].found == 1.0
    assert all(side.trusted for side in edges.sides)


def test_points_at_the_border_and_objects_too_thin_or_short_have_no_edge():
    image = encoded(strip(0.0, 15, WOOD, WALL))
    point, normal, side = sides_of(0.0, 15)
    outside = find_edges(image, point - [0, 75], normal, REACH_PX, 15, side)
    assert np.isnan(outside.offset_px).all()
    assert not any(verdict.trusted for verdict in outside.sides)
    thin = find_edges(image, point, normal, REACH_PX, LEAST_HALF_WIDTH_PX - 0.1, side)
    assert np.isnan(thin.offset_px).all()
    assert LEAST_HALF_WIDTH_PX > CLEAR_PX
    end_on = MIDDLE + 0.1 * (point - MIDDLE)
    assert np.isnan(find_edges(image, end_on, normal, REACH_PX, 15, side).offset_px).all()


def test_sides_come_in_the_order_of_their_numbers():
    image = encoded(strip(0.0, 15, WOOD, WALL))
    image[:70] = 90
    point, normal, side = sides_of(0.0, 15)
    below, above = find_edges(image, point, normal, REACH_PX, 15, side).sides
    assert below.trusted
    assert not above.trusted
    swapped = find_edges(image, point, normal, REACH_PX, 15, 5 - side).sides
    assert swapped == (above, below)


def test_callers_mistakes_raise():
    image = np.zeros((SIZE, SIZE, 3), dtype=np.uint8)
    point, normal, side = sides_of(0.0, 15)
    with pytest.raises(ValueError, match="points and normals"):
        find_edges(image, point, normal[:5], REACH_PX, 15, side)
    with pytest.raises(ValueError, match="points and normals"):
        find_edges(image, point, normal, REACH_PX, 15, side[:5])
    with pytest.raises(ValueError, match="reach"):
        find_edges(image, point, normal, 0.0, 15, side)

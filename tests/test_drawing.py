import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotrecon.drawing import AreaOfInterest, DrawingError, ObjectAxis, cut_sections

SIZE = (200, 150)
RECTANGLE = AreaOfInterest.rectangle((40, 30), (120, 110))


def test_upright_axis_takes_every_pixel_of_a_rectangle_once():
    segments = cut_sections(RECTANGLE, ObjectAxis((80, 30), (80, 110)), SIZE)
    v, u = np.divmod(segments.pixel, SIZE[0])
    assert segments.pixel.shape == (81, 81)
    assert (v == np.arange(30, 111)[:, None]).all()
    assert (np.sort(u, axis=1) == np.arange(40, 121)).all()


def test_strokes_between_pixels_take_every_pixel_once_too():
    segments = cut_sections(RECTANGLE, ObjectAxis((80.5, 30.5), (80.5, 109.5)), SIZE)
    pixels = segments.pixel[segments.inside]
    assert len(np.unique(pixels)) == len(pixels)


@settings(deadline=None)
@given(st.floats(0, 2 * np.pi), st.floats(10, 35))
def test_every_cell_is_its_own_place_in_the_area(angle, half_length):
    middle, along = np.array([80.0, 70.0]), np.array([np.cos(angle), np.sin(angle)])
    ends = middle - half_length * along, middle + half_length * along
    segments = cut_sections(RECTANGLE, ObjectAxis(tuple(ends[0]), tuple(ends[1])), SIZE)
    rows, columns = np.nonzero(segments.inside)
    place = (
        segments.origin_px
        + rows[:, None] * segments.along
        + (columns[:, None] + segments.first_offset_px) * segments.across
    )
    v, u = np.divmod(segments.pixel[rows, columns], SIZE[0])
    assert np.abs(np.stack([u, v], axis=1) - place).max() <= 0.5 + 1e-3
    assert u.min() >= 40
    assert u.max() <= 120
    assert v.min() >= 30
    assert v.max() <= 110


def test_polygon_leaves_out_what_lies_beside_it():
    triangle = AreaOfInterest(((40, 30), (120, 30), (80, 110)))
    segments = cut_sections(triangle, ObjectAxis((80, 35), (80, 105)), SIZE)
    widths = segments.inside.sum(axis=1)
    assert widths[0] > 70
    assert widths[-1] < 10
    assert (np.diff(widths) <= 0).all()


@pytest.mark.parametrize(
    ("area", "axis", "says"),
    [
        (((40, 30), (120, 110)), ((80, 30), (80, 110)), "fewer than three"),
        (((40, 30), (400, 30), (400, 110)), ((80, 30), (80, 110)), "outside the frame"),
        (((40, 30), (float("nan"), 30), (90, 110)), ((80, 30), (80, 110)), "corner nan,30 lies outside"),
        (((40, 30), (40, 30), (40, 30)), ((80, 30), (80, 110)), "no size"),
        (((40, 30), (120, 110), (120, 30), (40, 110)), ((80, 30), (80, 110)), "crosses"),
        (RECTANGLE.vertices_px, ((80, 70), (80, 70)), "no length"),
        (((40, 30), (90, 30), (90, 30.4)), ((80, 30), (80, 110)), "no size"),
        (((40, 30), (120, 110), (120, 30), (80, 70), (40, 110)), ((80, 30), (80, 110)), "crosses or touches itself"),
        (((40, 30), (80, 70), (120, 30), (120, 110), (80, 70), (40, 110)), ((80, 30), (80, 99)), "touches itself"),
        (((40, 30), (120, 30), (120, 110), (120, 60)), ((80, 30), (80, 110)), "touches itself"),
        (RECTANGLE.vertices_px, ((80, float("inf")), (80, 70)), "end 80,inf lies outside"),
        (RECTANGLE.vertices_px, ((80, 30), (80, 1e8)), "end 80,1e\\+08 lies outside"),
        (RECTANGLE.vertices_px, ((150, 30), (150, 110)), "outside the area"),
    ],
)
def test_drawings_nothing_can_be_measured_with(area, axis, says):
    with pytest.raises(DrawingError, match=says):
        cut_sections(AreaOfInterest(area), ObjectAxis(*axis), SIZE)


def test_a_corner_given_twice_is_one_corner():
    twice = AreaOfInterest(((40, 30), (120, 30), (120, 30), (120, 110), (40, 110)))
    once = cut_sections(RECTANGLE, ObjectAxis((80, 30), (80, 110)), SIZE)
    assert np.array_equal(cut_sections(twice, ObjectAxis((80, 30), (80, 110)), SIZE).pixel, once.pixel)


def test_the_whole_frame_may_be_named_by_its_size():
    whole = AreaOfInterest.rectangle((0, 0), SIZE)
    segments = cut_sections(whole, ObjectAxis((100, 0), (100, 150)), SIZE)
    assert np.array_equal(np.sort(segments.pixel[segments.inside]), np.arange(SIZE[0] * SIZE[1]))

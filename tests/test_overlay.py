import numpy as np
import pytest

from rotrecon.camera import PinholeCamera
from rotrecon.drawing import AreaOfInterest, Drawing, ObjectAxis
from rotrecon.mesh import as_mesh
from rotrecon.overlay import (
    NAVY,
    RED,
    blend,
    depth_colors,
    depth_range_m,
    first_cut_line,
    outlines,
    section_pixels,
    with_outlines,
    with_segmentation,
)
from rotrecon.primitives import Sphere
from rotrecon.reconstruct import reconstruct
from rotrecon.settings import Settings
from tests.exact import CAMERA, cone, cylinder, drawing_along, exact_frame

UPRIGHT = cylinder(np.array([0, 0.02, 0.8]), np.array([0, 1.0, 0.4]), 0.1, 0.25)


def result_of(solid, kind=None):
    return reconstruct(exact_frame(solid), drawing_along(solid, 0.7, kind=kind), Settings())


def test_depth_colours_are_black_without_depth_and_bright_when_near():
    depth = np.array([[0.5, 1.0], [np.nan, 0.75]], dtype=np.float32)
    colors = depth_colors(depth, (0.5, 1.0)).astype(int)
    assert colors[1, 0].tolist() == [0, 0, 0]
    assert colors[0, 0].sum() > colors[1, 1].sum() > colors[0, 1].sum()


def test_depth_range_ignores_spikes_and_survives_nothing():
    depth = np.full((100, 100), 1.0, dtype=np.float32)
    depth[:50] = 0.5
    depth[0, 0] = 65.0
    assert depth_range_m(depth) == pytest.approx((0.5, 1.0))
    assert depth_range_m(np.full((4, 4), np.nan, dtype=np.float32)) == (0.0, 1.0)


def test_blend_touches_only_what_is_masked():
    image, layer = np.full((4, 4, 3), 100, np.uint8), np.full((4, 4, 3), 200, np.uint8)
    mask = np.zeros((4, 4), dtype=bool)
    mask[1, 2] = True
    mixed = blend(image, layer, mask, 0.5)
    assert (mixed[mask] == 150).all()
    assert (mixed[~mask] == 100).all()
    assert (image == 100).all()


@pytest.mark.parametrize("stroke", [((160, 70), (160, 180)), ((120, 80), (200, 170)), ((60, 120), (260, 130))])
def test_segmentation_colours_lie_on_the_pixels_they_are_about(stroke):
    """Red where the nearest cell was kept, navy where it was too far, nothing outside the area."""
    frame = exact_frame(UPRIGHT)
    result = reconstruct(
        frame, Drawing(AreaOfInterest.rectangle((60, 60), (260, 190)), ObjectAxis(*stroke), "cylinder"), Settings()
    )
    shown = with_segmentation(frame.image, result, opacity=1.0)
    kept = result.segments.pixel[result.segmentation.kept]
    red = (shown.reshape(-1, 3) == RED).all(axis=1)
    assert red[np.unique(kept)].mean() > 0.97
    shown_outside = shown.copy()
    shown_outside[59:192, 59:262] = 0
    assert not shown_outside.any()
    assert (shown == NAVY).all(axis=2).any()


def test_stages_of_figure_3_differ():
    result = result_of(UPRIGHT)
    pictures = [with_segmentation(result.frame.image, result, stage) for stage in ("close", "accepted", "object")]
    assert len({picture.tobytes() for picture in pictures}) == 3


def test_bases_of_a_cylinder_are_re_projected_with_the_far_side_hidden():
    result = result_of(UPRIGHT, "cylinder")
    near, far, *limbs = outlines(result)
    assert len(limbs) == 2
    solid = result.fit.solid
    for base, end in ((near, solid.ends[0]), (far, solid.ends[1])):
        center = CAMERA.project(solid.center_m + end * solid.direction)
        assert np.nanmean(base.points_px[:-1], axis=0) == pytest.approx(center, abs=2)
    # the axis leans away from the camera: its first base faces the camera, of its second one half is behind the solid
    assert near.visible.all()
    assert 0.3 < far.visible.mean() < 0.7
    edges = np.diff(np.flatnonzero(np.diff(result.segmentation.kept[40].astype(int))))
    assert np.linalg.norm(limbs[0].points_px[0] - limbs[1].points_px[0]) == pytest.approx(edges[0], rel=0.1)


def test_limbs_of_a_cone_and_a_ball_surround_their_pixels():
    ball = Sphere(np.array([0.02, 0, 0.8]), np.array([0, 1.0, 0]), 0.1)
    section, limb = outlines(result_of(ball))
    across = np.linalg.norm(limb.points_px - limb.points_px.mean(axis=0), axis=1)
    assert across.mean() == pytest.approx(400 * np.tan(np.arcsin(0.1 / np.hypot(0.8, 0.02))), rel=0.01)
    assert 0.4 < section.visible.mean() < 0.6
    body = cone(np.array([0, 0, 0.7]), np.array([0, 1.0, 0.2]), 0.1, 12, 0.2)
    assert len(outlines(result_of(body))) == 4


def test_nothing_measured_has_no_outline():
    frame = exact_frame(cylinder(np.array([0.9, 0, 0.8]), np.array([0, 1.0, 0]), 0.01))
    drawing = Drawing(AreaOfInterest.rectangle((60, 60), (260, 190)), ObjectAxis((160, 70), (160, 180)))
    assert outlines(reconstruct(frame, drawing, Settings())) == ()


def test_hidden_parts_are_dashed():
    result = result_of(UPRIGHT, "cylinder")
    blank = np.zeros((240, 320, 3), dtype=np.uint8)
    drawn = with_outlines(blank, (outlines(result)[1],))
    solid_line = with_outlines(blank, outlines(result)[:1])
    assert 0.5 < drawn.any(axis=2).sum() / solid_line.any(axis=2).sum() < 0.95
    assert not blank.any()


def test_a_section_finds_the_line_of_pixels_that_holds_most_of_it():
    result = result_of(UPRIGHT, "cylinder")
    line = first_cut_line(result, 30)
    assert line is not None
    v = section_pixels(result, 30)[:, 1]
    assert v.min() <= result.segments.pixel[line].max() // CAMERA.width <= v.max()


def test_pixels_of_a_section_lie_across_the_object():
    result = result_of(UPRIGHT, "cylinder")
    pixels = section_pixels(result, 30)
    assert len(pixels) > 20
    assert np.ptp(pixels[:, 0]) > 3 * np.ptp(pixels[:, 1])


@pytest.mark.parametrize(
    ("solid", "volume"),
    [
        (UPRIGHT, np.pi * 0.05**2 * 0.25),
        (Sphere(np.array([1.0, 2, 3]), np.array([0, 1.0, 0]), 0.1), 4 / 3 * np.pi * 0.1**3),
        (cone(np.array([0, 0, 0.7]), np.array([0, 0, 1.0]), 0.1, 12, 0.2), None),
    ],
)
def test_meshes_are_closed_and_as_large_as_their_solids(solid, volume):
    mesh = as_mesh(solid)
    assert mesh.is_watertight
    assert mesh.center_mass == pytest.approx(solid.center_m, abs=0.03)
    if volume is None:
        low, high = (float(solid.radius_at(end)) for end in solid.ends)
        volume = np.pi * solid.length_m * (low**2 + low * high + high**2) / 3
    assert mesh.volume == pytest.approx(volume, rel=0.01)


def test_projecting_behind_the_camera_is_not_a_pixel():
    camera = PinholeCamera(4, 4, np.array([[2.0, 0, 2], [0, 2.0, 2], [0, 0, 1]]))
    assert np.isnan(camera.project(np.array([0, 0, -1.0]))).all()

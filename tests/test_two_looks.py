"""An outline that is seen twice is doubted by how far its sides have moved in between."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotrecon.rays.fitting import Outline
from rotrecon.rays.limbs import NOTHING_SEEN, SeenOutline, limbs_of
from tests.bodies import CAMERA, CYLINDER, body_at

SURFACE = body_at(CYLINDER, 3).lateral()
SIGMA_PX, ALIKE_PX = 0.3, 0.02


def look(moved_px: dict[int, float]) -> SeenOutline:
    """Some sides of the surface's outline, each moved outward."""
    limbs = limbs_of(SURFACE, CAMERA, np.linspace(-0.08, 0.08, 60))
    limbs = limbs.chosen(np.isin(limbs.side, list(moved_px)))
    outward_px = np.array([moved_px[side] for side in limbs.side.tolist()])
    point_px = limbs.point_px + outward_px[:, None] * limbs.normal_px
    rays = np.ascontiguousarray(CAMERA.unproject(point_px, np.ones(len(point_px))).T)
    alike = tuple((np.flatnonzero(limbs.side == side).astype(np.int32), ALIKE_PX) for side in moved_px)
    return SeenOutline(Outline(rays, np.full(len(point_px), SIGMA_PX), CAMERA.focal_px, alike), tuple(moved_px))


def of_sides(seen: SeenOutline) -> list[tuple[float, float]]:
    """What every side errs by alike, and the standard error of its mean were its edges independent."""
    edges = seen.edges
    assert edges is not None
    return [(alike_px, float(np.sum(edges.sigma_px[stretch] ** -2.0) ** -0.5)) for stretch, alike_px in edges.alike]


@given(st.floats(-2, 2), st.floats(-2, 2))
def test_how_far_inside_a_surface_a_side_passes_is_what_it_was_moved_by(first_px, second_px):
    edges = look({0: first_px, 1: second_px}).edges
    assert edges is not None
    assert edges.offsets_px(SURFACE) == pytest.approx([-first_px, -second_px], rel=0.03, abs=0.005)


@given(st.floats(0, 3), st.floats(0, 3))
def test_sides_that_err_alike_by_more_do_so_together_and_taken_as_independent(first_px, second_px):
    seen = look({0: 0.0, 1: 0.0})
    assert seen.edges is not None
    before, after = of_sides(seen), of_sides(replace(seen, edges=seen.edges.less_sure(np.array([first_px, second_px]))))
    for more_px, old, new in zip((first_px, second_px), before, after, strict=True):
        assert new == pytest.approx(np.hypot(old, more_px))


@given(st.floats(-1, 1), st.floats(-1, 1))
def test_a_side_is_doubted_by_what_it_moved_between_two_looks_and_the_other_is_not(here_px, there_px):
    again = look({0: here_px, 1: 0.1})
    kept, other = of_sides(again.doubting(look({0: there_px, 1: 0.1}), SURFACE))
    assert kept[0] == pytest.approx(np.hypot(ALIKE_PX, here_px - there_px), rel=0.03, abs=0.005)
    assert other == pytest.approx(of_sides(again)[1])


@pytest.mark.parametrize("before", [NOTHING_SEEN, look({1: 0.7})], ids=["nothing", "the other side"])
def test_a_side_that_was_not_seen_before_is_not_doubted(before):
    again = look({0: 0.3})
    assert of_sides(again.doubting(before, SURFACE)) == of_sides(again)
    assert NOTHING_SEEN.doubting(before, SURFACE).edges is None

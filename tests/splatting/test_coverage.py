"""What a frame shows of its references: coverage, holes and overdraw, counted by hand."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from ibr_ref import Camera, DepthImage, splatting
from ibr_ref.splatting import Coverage, Params, Scene
from tests.splatting.scenes import looking, noise, parallel

pytestmark = pytest.mark.usefixtures("one_thread")


def wall(size: tuple[int, int], mask: object = None, depth: object = 4.0) -> DepthImage:
    """A wall across the view."""
    width, height = size
    return DepthImage(color=noise(height, width, 3), depth=np.broadcast_to(depth, (height, width)), mask=mask,  # type: ignore[arg-type]
                      camera=parallel((0, -4, 0), size=size))  # fmt: skip


def measured(images: list[DepthImage], view: Camera, **params: float) -> Coverage:
    scene = Scene(images=images, camera=view, light=None)
    return splatting.coverage(scene, splatting.render(scene, Params(**params)))


def test_a_picture_from_its_own_camera_has_no_hole() -> None:
    """The union of the quads reaches from the first pixels' centres, which are its left and upper border, to the last,
    which are not in it.
    """
    image = wall((12, 9))
    found = measured([image], image.camera)
    assert found.covered.all()
    assert found.coverage == 1.0
    assert found.surface[:-1, :-1].all()
    assert not found.surface[-1].any()
    assert not found.surface[:, -1].any()
    assert found.hole_share == 0.0
    assert found.mean_overdraw == 1.0
    assert (found.overdraw == 1).all()


@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_picture_n_times_as_large_has_holes_of_all_but_one_in_n_squared(n: int) -> None:
    """Quads from n/2 to n/2 + n (w - 1), as an interval half open: n^2 (w - 1)(h - 1) centres, one splat in each n^2."""
    image = wall((12, 9))
    view = parallel((0, -4, 0), size=(12 * n, 9 * n))
    found = measured([image], view)
    assert found.surface.sum() == n * n * 11 * 8
    assert found.covered.sum() == 12 * 9
    inside = n * n * 11 * 8 - 11 * 8
    assert found.holes.sum() == inside
    assert found.hole_share == inside / (n * n * 11 * 8)
    assert found.coverage == 1 / n**2
    assert found.mean_overdraw == 1.0, "of the covered pixels"
    closed = measured([image], view, alpha=float(n))
    assert closed.hole_share == 0.0
    assert closed.mean_overdraw == 1.0


def test_there_is_no_quad_across_a_jump_or_a_hole_in_the_mask() -> None:
    """Two halves at depths 4 and 4 (1.05 + e), in a view twice as large; then with pixels missing."""
    view = parallel((0, -4, 0), size=(24, 18))
    step = np.where(np.arange(12) < 6, 4.0, 4.0 * 1.0501)
    found = measured([wall((12, 9), depth=step)], view)
    columns = found.surface[4]
    assert_array_equal(np.flatnonzero(~columns), [0, 11, 12, 23])
    near = measured([wall((12, 9), depth=np.where(np.arange(12) < 6, 4.0, 4.0 * 1.0499))], view)
    assert_array_equal(np.flatnonzero(~near.surface[4]), [0, 23])
    mask = np.ones((9, 12), bool)
    mask[4, 6] = False
    holed = measured([wall((12, 9), mask=mask)], view)
    missing = ~holed.surface[1:17, 1:23]
    assert missing.sum() == 16, "the four quads around it, four pixels each"
    assert not missing[:, :10].any()


def test_two_images_make_one_union_and_their_overdraw_adds_up() -> None:
    left, right = np.arange(12) < 7, np.arange(12) >= 5
    images = [wall((12, 9), mask=np.broadcast_to(m, (9, 12))) for m in (left, right)]
    found = measured(images, images[0].camera)
    assert found.surface[:-1, :-1].all()
    assert found.overdraw.sum() == 9 * 14
    assert found.mean_overdraw == 14 / 12
    assert_array_equal(found.overdraw, np.broadcast_to(1 + (left & right), (9, 12)))


def test_a_view_that_sees_nothing_has_no_hole() -> None:
    found = measured([wall((12, 9))], looking((0, -40, 0), (0, -80, 0)))
    assert found.coverage == 0.0
    assert found.hole_share == 0.0
    assert found.mean_overdraw == 0.0
    assert not found.surface.any()


@pytest.mark.parametrize("size", [(1, 1), (1, 7), (7, 1)])
def test_rows_and_columns_of_pixels_have_no_surface(size: tuple[int, int]) -> None:
    image = wall(size)
    found = measured([image], image.camera)
    assert found.coverage == 1.0
    assert not found.surface.any()


def test_the_box_around_all_points() -> None:
    """Walls in planes y = 0 and y = -1, one of them with a single pixel; an empty image has none."""
    size, one = (12, 9), np.zeros((9, 12))
    one[0, 11] = 1
    low, high = splatting.bounds([wall(size), wall(size, mask=one, depth=3.0), wall(size, mask=0 * one)])
    right, up = 2.5 / 9 * 5.5, 2.5 / 9 * 4.0
    np.testing.assert_allclose(low, (-right, -1.0, -up), atol=1e-12)
    np.testing.assert_allclose(high, (right, 0.0, up), atol=1e-12)
    low, high = splatting.bounds([wall(size, mask=one, depth=3.0)])
    np.testing.assert_allclose(low, (right, -1.0, up), atol=1e-12)
    assert_array_equal(low, high)
    with pytest.raises(ValueError, match=r"^images: found .*without a valid pixel.*allowed: "):
        splatting.bounds([wall(size, mask=0 * one)])

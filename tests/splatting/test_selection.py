"""Which reference images to keep: closed forms, and the best of all choices."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest

from ibr_ref import DepthImage, models
from ibr_ref.splatting import Selection, choose_references
from ibr_ref.splatting.selection import greedy
from tests.splatting.scenes import box_depths, image_of, looking, parallel
from tests.splatting.test_bad_input import EMPTY, IMAGE, NOT_NUMBERS, rejected

pytestmark = pytest.mark.usefixtures("one_thread")

AXES: list[Any] = [(4, 0, 0), (-4, 0, 0), (0, 4, 0), (0, -4, 0), (0, 0, 4), (0, 0, -4)]


def side(eye: Any, size: int = 12) -> DepthImage:
    """A face of the cube, seen straight on."""
    camera = parallel(eye, size=(size, size), up=(0, 1, 0) if eye[2] else (0, 0, 1))
    return image_of(camera, box_depths(camera))


def test_a_cube_needs_its_six_sides_once_each() -> None:
    images = [side(eye) for eye in AXES for _ in range(2)]
    chosen = choose_references(images, 1.0)
    assert chosen.order == (0, 2, 4, 6, 8, 10), "the earlier of two that are the same"
    np.testing.assert_allclose(chosen.shares, np.arange(1, 7) / 6, rtol=1e-9)
    assert choose_references(images, 0.5).order == (0, 2, 4)
    assert choose_references(images, 0.51).order == (0, 2, 4, 6)


def test_the_area_counts_not_the_number_of_pixels() -> None:
    """A side with four times the pixels is no more than a side."""
    images = [side(AXES[0]), side(AXES[2], 24)]
    chosen = choose_references(images, 1.0)
    assert set(chosen.order) == {0, 1}
    assert chosen.shares[0] == pytest.approx(0.5, abs=0.09), "the border of a side is cut to whole pixels"


def test_an_image_that_sees_two_sides_comes_first() -> None:
    camera = looking((4, 4, 0), size=(24, 24), vertical_fov=30.0)
    images = [side(AXES[0]), image_of(camera, box_depths(camera)), side(AXES[2]), side(AXES[1])]
    assert choose_references(images, 0.9, tolerance=0.02).order == (1, 3)


def test_behind_another_surface_a_point_is_not_seen() -> None:
    """Two walls in line, both seen from the front and from behind: each camera sees the nearer."""
    front, behind = parallel((0, -4, 0), size=(5, 5)), parallel((0, 4, 0), size=(5, 5))
    images = [DepthImage(color=np.ones((5, 5, 3)), depth=np.full((5, 5), 3.0), camera=c) for c in (front, behind)]
    assert choose_references(images, 1.0) == Selection((0, 1), (0.5, 1.0))
    assert choose_references(images, 1.0, tolerance=1.0) == Selection((0,), (1.0,))


def test_greedy_is_never_far_from_the_best_choice() -> None:
    """At least 1 - 1/e of what the best choice of as many covers; here usually all of it."""
    random, best_found = np.random.RandomState(0), 0
    for _ in range(30):
        seen = random.random_sample((7, 60)) < random.uniform(0.1, 0.5)
        seen[-1] |= ~seen.any(axis=0)
        areas = random.randint(1, 100, 60).astype(np.int64)
        chosen = greedy(seen, areas, 1.0)
        assert list(chosen.shares) == sorted(chosen.shares)
        assert chosen.shares[-1] == 1.0
        for count, share in enumerate(chosen.shares, 1):
            best = max(areas[seen[list(some)].any(axis=0)].sum() for some in combinations(range(7), count))
            assert share >= (1 - 1 / np.e) * best / areas.sum()
            best_found += share == best / areas.sum()
    assert best_found > 60


def test_a_rig_is_thinned() -> None:
    images = models.depth_rig(models.kettle(), 16, size=32)
    chosen = choose_references(images, 0.95)
    assert len(chosen.order) < 14
    assert len(set(chosen.order)) == len(chosen.order)
    assert chosen.shares[-2] < 0.95 <= chosen.shares[-1]


@pytest.mark.parametrize("field", ["coverage", "tolerance"])
def test_what_is_out_of_range_is_named(field: str) -> None:
    for value, found in [*NOT_NUMBERS, (0.0, "0.0"), (1.01, "1.01"), (-0.5, "-0.5")]:
        rejected(field, found, choose_references, [IMAGE], **{field: value})


def test_images_without_sense_are_named() -> None:
    rejected("images", "0 images", choose_references, [])
    rejected("images", "1 images", choose_references, [EMPTY])
    rejected("images[1]", "int", choose_references, [IMAGE, 1])

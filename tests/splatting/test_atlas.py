"""The atlas: rectangles within the pages that never overlap, and every texel where they say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from ibr_ref import DepthImage, splatting
from ibr_ref.io import Frame
from ibr_ref.splatting.atlas import PAGES, pack
from tests.splatting.scenes import frame, looking, noise

pytestmark = pytest.mark.usefixtures("one_thread")

LIMIT = 32
sides = st.one_of(st.integers(1, LIMIT), st.sampled_from([1, LIMIT // 2, LIMIT]))
sizes = st.lists(st.tuples(sides, sides), min_size=1, max_size=20)


def fitting(sizes: list[tuple[int, int]]) -> int:
    """How many of the images fit, by the error's word."""
    try:
        return len(pack(sizes, LIMIT))
    except ValueError as error:
        return int(str(error).split("images[")[1].split("]: found no room in the atlas")[0])


@settings(derandomize=True, deadline=None, max_examples=300)
@given(sizes)
def test_rectangles_fit_and_never_overlap(sizes: list[tuple[int, int]]) -> None:
    """Where not all images fit, those before the one that is named do, and they have got to the last page."""
    count = fitting(sizes)
    rects = pack(sizes[:count], LIMIT)
    assert count == len(sizes) or rects[-1, 0] == PAGES - 1
    sizes = sizes[:count]
    assert rects.dtype == np.int32
    assert [tuple(size) for size in rects[:, 3:].tolist()] == sizes
    pages = np.zeros((PAGES, LIMIT, LIMIT), int)
    for page, x, y, width, height in rects.tolist():
        assert 0 <= x <= LIMIT - width
        assert 0 <= y <= LIMIT - height
        pages[page, y : y + height, x : x + width] += 1
    assert pages.max() <= 1
    assert (np.diff(rects[:, 0]) >= 0).all(), "in input order"
    assert sorted(set(rects[:, 0].tolist())) == list(range(rects[-1, 0] + 1)), "no page is left out"


def test_shelves_by_hand() -> None:
    sizes = [(10, 5), (12, 7), (10, 3), (1, 1), (32, 20), (32, 1), (5, 5), (30, 2)]
    expected = [[0, 0, 0], [0, 10, 0], [0, 22, 0], [0, 0, 7], [0, 0, 8], [0, 0, 28], [1, 0, 0], [1, 0, 5]]
    assert pack(sizes, LIMIT)[:, :3].tolist() == expected


@pytest.mark.parametrize(
    ("size", "count"), [((32, 32), 4), ((16, 16), 16), ((32, 8), 16), ((8, 32), 16), ((1, 32), 128)]
)
def test_pages_are_filled_to_the_last_texel(size: tuple[int, int], count: int) -> None:
    rects = pack([size] * count, LIMIT)
    assert (rects[:, 3] * rects[:, 4]).sum() == PAGES * LIMIT * LIMIT
    with pytest.raises(
        ValueError, match=rf"^images\[{count}\]: found no room in the atlas, allowed: .*4 pages of 32 x 32"
    ):
        pack([*[size] * count, (1, 1)], LIMIT)


@pytest.mark.parametrize("size", [(33, 1), (1, 33)])
def test_an_image_larger_than_a_page(size: tuple[int, int]) -> None:
    with pytest.raises(
        ValueError, match=rf"^images\[1\]: found {size[0]} x {size[1]} pixels, allowed: max_atlas_size = 32"
    ):
        pack([(32, 32), size], LIMIT)


# Texels


def images_of(sizes: list[tuple[int, int]]) -> list[DepthImage]:
    """Pictures of noise; every other one has a mask with holes, but for its first pixel."""
    images = []
    for i, (width, height) in enumerate(sizes):
        mask = noise(height, width, seed=i) < (0.6 if i % 2 else 2.0)
        mask[0, 0] = True
        camera = looking((3.0, i, 1.0), size=(width, height))
        color = 0.1 + 0.8 * noise(height, width, 3, seed=i)
        images.append(DepthImage(color=color, depth=2 + noise(height, width, seed=i), camera=camera, mask=mask))
    return images


def check_texels(images: list[DepthImage], here: Frame) -> None:
    """The rectangles hold the images, bit for bit, with 0 off the mask, and there is nothing else; pages are cropped."""
    rects, stages = here.stages["atlas.rects"], here.stages
    held = [np.zeros(page.shape, bool) for page in stages["atlas.depth"]]
    for image, (page, x, y, width, height) in zip(images, rects.tolist(), strict=True):
        color, depth, mask = image.arrays
        part = np.s_[y : y + height, x : x + width]
        assert_array_equal(stages["atlas.color"][page][part], np.where(mask[..., None], color, 0.0))
        assert_array_equal(stages["atlas.depth"][page][part], depth)
        assert_array_equal(stages["atlas.normal"][page][part].any(axis=2), mask)
        held[page][part] = mask
    for page, inside in enumerate(held):
        for name in ("atlas.color", "atlas.depth", "atlas.normal"):
            assert not stages[name][page][~inside].any(), name
        own = rects[rects[:, 0] == page]
        assert inside.shape == ((own[:, 2] + own[:, 4]).max(), (own[:, 1] + own[:, 3]).max())
    assert stages["atlas.normal"][0].dtype == np.uint8


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.lists(st.tuples(st.integers(1, 9), st.integers(1, 9)), min_size=1, max_size=7), st.integers(0, 4))
def test_every_texel_comes_back(sizes: list[tuple[int, int]], room: int) -> None:
    limit = max(max(size) for size in sizes) + room
    try:
        pack(sizes, limit)
    except ValueError:
        limit = 64
    images = images_of(sizes)
    check_texels(images, frame(images, looking((5.0, 0.0, 0.0), size=(8, 8)), max_atlas_size=limit))


@pytest.mark.parametrize("count", [1, 2, 4])
def test_images_that_fill_pages_exactly(count: int) -> None:
    images = images_of([(16, 16)] * count)
    here = frame(images, looking((5.0, 0.0, 0.0)), max_atlas_size=16)
    assert len(here.stages["atlas.color"]) == count
    check_texels(images, here)


def test_the_stages_of_vertices_and_atlas_go_together() -> None:
    """A port that reads the atlas at `vertex.source` finds the colours that the points have."""
    images = images_of([(7, 5), (4, 9), (8, 3)])
    here = frame(images, looking((5.0, 0.0, 0.0)), max_atlas_size=9)
    image, row, column = here.stages["vertex.source"].T
    page, x, y = here.stages["atlas.rects"][image, :3].T
    assert len(set(page.tolist())) > 1
    found = [here.stages["atlas.color"][p][j, i] for p, i, j in zip(page, x + column, y + row, strict=True)]
    assert_array_equal(found, here.stages["vertex.color"])


def test_an_atlas_that_does_not_fit_is_an_error_with_and_without_stages() -> None:
    """Whatever is asked for: a port could not draw it."""
    scene = splatting.Scene(images=images_of([(8, 8)] * 5), camera=looking((5.0, 0.0, 0.0)), light=None)
    for stages in (True, False):
        with pytest.raises(ValueError, match=r"^images\[4\]: found no room .*max_atlas_size"):
            splatting.render(scene, splatting.Params(max_atlas_size=8), stages=stages)

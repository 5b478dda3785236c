"""The built-in models: what is in them, and that it never changes."""

import hashlib

import numpy as np
import pytest
from numpy.typing import NDArray

from ibr_ref.models import box, buildings, city, city_blocks
from ibr_ref.models.city_ground import streets
from ibr_ref.models.city_plan import SIZE, Wing
from ibr_ref.models.facades import brick_facade, street_facade
from ibr_ref.models.heights import HEIGHT_STEPS, clear_of_lattice
from ibr_ref.scene import BasePolygon

SEEDS = (0, 1, 2, 3, 2**32 - 1)
DIGESTS = {
    "box": "1dff320ed7ee7062de0f28fce4b3d1636b6637dc54442c72e526b0295b64e6b2",
    "city": "5bef725a2dddb622ec1fdd93b99be6c9f1110ce9db2a407fcb8805b0c28ea362",
}


@pytest.fixture(scope="module")
def town() -> BasePolygon:
    return city()


@pytest.fixture(scope="module", params=["box", "city"])
def model(request: pytest.FixtureRequest, town: BasePolygon) -> BasePolygon:
    return town if request.param == "city" else box()


def maps(polygon: BasePolygon) -> list[NDArray[np.float64]]:
    """Height, colour and facade map."""
    assert polygon.facade_map is not None
    return [np.asarray(texels) for texels in (polygon.height_map, polygon.color_map, polygon.facade_map)]


def digest(polygon: BasePolygon) -> str:
    """SHA-256 of the maps' little-endian float64 bytes."""
    return hashlib.sha256(b"".join(texels.astype("<f8").tobytes() for texels in maps(polygon))).hexdigest()


def footprints(seed: int) -> NDArray[np.int64]:
    """The number of the building on every texel, −1 on open ground; fails where two buildings overlap."""
    ground = np.full((SIZE, SIZE), -1)
    for row in buildings(seed).tolist():
        wing = Wing(*row)
        plot = ground[wing.south : wing.north, wing.west : wing.east]
        assert plot.size > 0
        assert np.isin(plot, (-1, wing.building)).all()
        plot[:] = wing.building
    return ground


def test_box_maps_have_the_sizes_of_the_paper() -> None:
    heights, colors, _ = maps(box())
    assert heights.shape == (256, 256)
    assert colors.shape == (512, 512, 3)
    assert set(np.unique(heights)) == {0.0, heights[128, 128]}


def test_box_is_about_half_as_high_as_wide() -> None:
    polygon = box()
    heights, _, _ = maps(polygon)
    width = np.count_nonzero(heights[128]) / 256
    assert 0.4 * width < heights.max() * polygon.height_scale < 0.6 * width


def test_box_outline_lies_on_the_walls() -> None:
    heights, colors, _ = maps(box())
    first_inside = np.flatnonzero(heights[128])[0]
    assert (colors[256, 2 * first_inside - 1 : 2 * first_inside + 1] == 0).all()


def test_city_maps_have_the_sizes_of_the_paper(town: BasePolygon) -> None:
    heights, colors, _ = maps(town)
    assert heights.shape == (1024, 1024)
    assert colors.shape == (1024, 1024, 3)


def test_texels_are_in_range(model: BasePolygon) -> None:
    for texels in maps(model):
        assert texels.min() >= 0
        assert texels.max() <= 1


def test_heights_are_16_bit_steps_below_the_top(model: BasePolygon) -> None:
    heights = maps(model)[0]
    assert (np.rint(heights * HEIGHT_STEPS) / HEIGHT_STEPS == heights).all()
    assert 0.9 < heights.max() < 1


@pytest.mark.parametrize("linear_steps", [10, 15, 24, 25, 40, 50])
def test_no_roof_ties_with_the_lattice_of_the_search(model: BasePolygon, linear_steps: int) -> None:
    heights = np.unique(maps(model)[0])[1:]
    lattice = linear_steps * 2**6
    assert np.abs(heights - np.rint(heights * lattice) / lattice).min() > 6e-6


def test_every_height_finds_a_clear_neighbour() -> None:
    heights = np.arange(HEIGHT_STEPS)
    raised = clear_of_lattice(heights)
    assert (clear_of_lattice(raised) == raised).all()
    assert (raised[1:] - heights[1:]).max() <= 3
    assert raised[0] == 0


@pytest.mark.parametrize("seed", SEEDS)
def test_city_has_hundreds_of_buildings_clear_of_the_streets(seed: int) -> None:
    ground = footprints(seed)
    assert len(np.unique(ground[ground >= 0])) == buildings(seed)[-1, 0] + 1 >= 200
    on_street = streets().carriageway | streets().pavement
    assert (ground[on_street] == -1).all()
    assert (ground[:, on_street] == -1).all()


def test_map_is_as_high_as_its_buildings(town: BasePolygon) -> None:
    heights = maps(town)[0]
    for row in buildings(0).tolist():
        wing = Wing(*row)
        assert heights[wing.south : wing.north, wing.west : wing.east].min() >= wing.height / HEIGHT_STEPS


def test_nothing_on_the_open_ground_is_steep_by_default(town: BasePolygon) -> None:
    assert maps(town)[0][footprints(0) == -1].max() < 0.1


@pytest.mark.parametrize("facade", [brick_facade(), street_facade()], ids=["brick", "street"])
@pytest.mark.parametrize("axis", [0, 1])
def test_facade_tiles_without_a_seam(facade: NDArray[np.float64], axis: int) -> None:
    steps = np.abs(facade - np.roll(facade, 1, axis)).mean(axis=(1 - axis, 2))
    assert steps[0] <= steps[1:].max()


@pytest.mark.parametrize("count", [2, 8])
def test_city_blocks_reassemble_to_the_city(town: BasePolygon, count: int) -> None:
    blocks = city_blocks(0, count)
    assert len(blocks) == count * count
    rows = [blocks[first : first + count] for first in range(0, count * count, count)]
    for number in range(2):
        whole = np.concatenate([np.concatenate([maps(block)[number] for block in row], axis=1) for row in rows])
        assert np.array_equal(whole, maps(town)[number])
    corner, edge_u, edge_v = blocks[0].arrays
    assert np.array_equal(corner, town.arrays[0])
    assert np.array_equal(blocks[1].arrays[0], corner + edge_u)
    assert np.array_equal(blocks[count].arrays[0], corner + edge_v)
    assert np.array_equal(sum(blocks[-1].arrays), sum(town.arrays))


def test_seeds_differ(town: BasePolygon) -> None:
    assert digest(city(1)) != digest(town)


@pytest.mark.parametrize("name", DIGESTS)
def test_maps_have_the_same_bits_everywhere(name: str, town: BasePolygon) -> None:
    assert digest(town if name == "city" else box()) == DIGESTS[name]


@pytest.mark.parametrize("count", [0, -4, 3, 2048, 4.5, True])
def test_bad_count_is_named(count: object) -> None:
    with pytest.raises(ValueError, match=r"count.*allowed"):
        city_blocks(0, count)  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", [-1, 2**32, 0.5, "a"])
def test_bad_seed_is_named(seed: object) -> None:
    with pytest.raises(ValueError, match=r"seed.*allowed"):
        city(seed)  # type: ignore[arg-type]

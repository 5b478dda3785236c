"""The city of the paper's figures 15 and 16 in spirit: a polygon of 1024 × 1024 texels full of buildings, by formula.

Only integers, additions, multiplications and NumPy's frozen random stream (RandomState) are used, so the maps have the
same bits on every machine.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.models.city_ground import ground
from ibr_ref.models.city_plan import SEED_LIMIT, SIZE, buildings, districts
from ibr_ref.models.city_stamps import raise_city
from ibr_ref.models.facades import street_facade
from ibr_ref.models.heights import HEIGHT_STEPS, clear_of_lattice
from ibr_ref.scene import BasePolygon
from ibr_ref.scene.checks import reject, whole

EXTENT = 4.0
"""Side of the city in world units; one unit is 128 m."""

HEIGHT_SCALE = 0.5
FACADE_TILE = (0.5, 0.5)
"""The facade spans one city block and the whole volume, so that its shops stand on the ground only."""


class Maps(NamedTuple):
    """Heights (1024, 1024), colours (1024, 1024, 3) and the facade tile of the whole city, float64 in [0, 1]."""

    heights: NDArray[np.float64]
    colors: NDArray[np.float64]
    facade: NDArray[np.float64]


def city(seed: int = 0) -> BasePolygon:
    """A city of some 300 buildings, 4 × 4 world units around the origin, z up; maps 1024 × 1024 texels, heights to 0.5.

    Eight by eight blocks: towers, slabs, terraces around courts, houses in gardens, parks, and a river with bridges.
    Every whole seed in [0, 2^32) gives another city; ValueError for anything else.
    """
    return _polygon(_draw(seed), 0, 0, 1)


def city_blocks(seed: int = 0, count: int = 4) -> tuple[BasePolygon, ...]:
    """The same city cut into count × count polygons, row by row from the corner of `city`; the cuts run along streets.

    `count` divides 1024; ValueError otherwise. (From 16 on cuts meet buildings, and above 8 the facades change phase.)
    """
    count = whole("count", count, low=1, high=SIZE)
    if SIZE % count:
        raise reject("count", count, f"a divisor of {SIZE}")
    maps = _draw(seed)
    return tuple(_polygon(maps, row, column, count) for row in range(count) for column in range(count))


def _draw(seed: int) -> Maps:
    """The whole city's maps, with a little grain over all colours."""
    seed = whole("seed", seed, low=0, high=SEED_LIMIT)
    wings = buildings(seed)
    drawn = raise_city(seed, ground(seed, districts(seed), wings), wings)
    grain = np.random.RandomState([seed, 8]).randint(-5, 6, drawn.heights.shape)
    colors = np.clip(drawn.colors + grain[..., np.newaxis], 0, 255)
    cleared = clear_of_lattice(np.arange(HEIGHT_STEPS))
    return Maps(cleared[drawn.heights] / HEIGHT_STEPS, colors / 255, street_facade())


def _polygon(maps: Maps, row: int, column: int, count: int) -> BasePolygon:
    """The polygon in one row and column of a city cut into count × count."""
    side, texels = EXTENT / count, SIZE // count
    part = (slice(row * texels, (row + 1) * texels), slice(column * texels, (column + 1) * texels))
    return BasePolygon(
        corner=(column * side - EXTENT / 2, row * side - EXTENT / 2, 0.0),
        edge_u=(side, 0.0, 0.0),
        edge_v=(0.0, side, 0.0),
        height_map=maps.heights[part],
        color_map=maps.colors[part],
        height_scale=HEIGHT_SCALE,
        facade_map=maps.facade,
        facade_tile=FACADE_TILE,
    )

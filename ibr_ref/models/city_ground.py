"""The city's ground: the colours at height 0, painted as integers 0 … 255, by masks over whole maps."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.models.city_plan import BLOCK, FLOOR, LOT, LOTS_BEGIN, SIZE, District, Wing, river_middle

AVENUE_ROAD = 11
STREET_ROAD = 6
"""Half the width of a carriageway in texels; every second street is an avenue."""

PAVEMENT = 5

ASPHALT = np.array((72, 74, 78))
PAVING = np.array((168, 164, 156))
LANE_WHITE = np.array((226, 226, 220))
LANE_YELLOW = np.array((222, 178, 62))
GRASS = np.array((104, 142, 70))
GRASS_DARK = np.array((92, 130, 62))
HEDGE = np.array((58, 92, 48))
GRAVEL = np.array((196, 184, 154))
PLAZA = np.array((186, 182, 176))
JOINT = np.array((160, 154, 148))
QUAY = np.array((176, 168, 152))
WATER = np.array((56, 104, 134))
FOUNDATION = np.array((104, 94, 86))
PLASTER = np.array((188, 170, 144))

RIVER_HALF_WIDTH = 30
QUAY_WIDTH = 5
PROMENADE = 9


class Streets(NamedTuple):
    """Where the streets are along one axis: all arrays (1024,), the streets run along the other axis.

    distance: texels from the middle of the nearest street to the texel's near edge; road, avenue: half the width of
    that street's carriageway, and whether it is an avenue; carriageway, pavement: whether the texel is part of it.
    """

    distance: NDArray[np.int64]
    road: NDArray[np.int64]
    avenue: NDArray[np.bool_]
    carriageway: NDArray[np.bool_]
    pavement: NDArray[np.bool_]


class Ground(NamedTuple):
    """Colours (1024, 1024, 3) int64 and the mask (1024, 1024) of the places where trees may grow."""

    colors: NDArray[np.int64]
    growing: NDArray[np.bool_]


def streets() -> Streets:
    """The streets across one axis; the same for rows and columns."""
    texels = np.arange(SIZE)
    before = texels % BLOCK
    after = BLOCK - 1 - before
    distance = np.minimum(before, after)
    avenue = (texels + BLOCK // 2) // BLOCK % 2 == 0
    road = np.where(avenue, AVENUE_ROAD, STREET_ROAD)
    pavement = (road <= distance) & (distance < road + PAVEMENT)
    return Streets(distance, road, avenue, distance < road, pavement)


def ground(seed: int, districts: NDArray[np.int64], wings: NDArray[np.int64]) -> Ground:
    """The ground of all blocks, the river, the streets over it, and the foundations of the buildings."""
    of_texel = districts.repeat(BLOCK, axis=0).repeat(BLOCK, axis=1)
    colors = _lawns(of_texel)
    _plant_gardens(colors, of_texel)
    _pave_plazas(colors, of_texel)
    _lay_out_parks(colors, of_texel)
    _flood_river(colors, of_texel, seed)
    growing = _is_lawn(colors)
    _lay_streets(colors, growing)
    _mark_lanes(colors)
    _dig_foundations(colors, growing, wings)
    return Ground(colors, growing)


def _is_lawn(colors: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Mask of the grass, of either tone."""
    lawn: NDArray[np.bool_] = (colors == GRASS).all(axis=-1) | (colors == GRASS_DARK).all(axis=-1)
    return lawn


def _from_block_middle() -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Distances of every texel (1024, 1024) from the middle of its block, northwards and eastwards, in half texels."""
    rows, columns = np.indices((SIZE, SIZE))
    return 2 * (rows % BLOCK) + 1 - BLOCK, 2 * (columns % BLOCK) + 1 - BLOCK


def _lawns(districts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Grass everywhere, mown in stripes in the parks."""
    rows, columns = np.indices(districts.shape)
    striped = ((rows + columns) // 10 % 2 == 0) & (districts == District.PARK)
    return np.where(striped[..., np.newaxis], GRASS_DARK, GRASS)


def _plant_gardens(colors: NDArray[np.int64], districts: NDArray[np.int64]) -> None:
    """Hedges around the gardens of the houses, and paths along the lots of terraces and slabs."""
    rows, columns = np.indices(districts.shape)
    on_edge = [(texels % BLOCK - LOTS_BEGIN) % LOT < 2 for texels in (rows, columns)]
    inside = [np.abs(2 * (texels % BLOCK) - BLOCK) <= BLOCK - 2 * LOTS_BEGIN for texels in (rows, columns)]
    lines = (on_edge[0] | on_edge[1]) & inside[0] & inside[1]
    colors[lines & (districts == District.HOUSES)] = HEDGE
    colors[lines & ((districts == District.TERRACES) | (districts == District.SLABS))] = GRAVEL


def _pave_plazas(colors: NDArray[np.int64], districts: NDArray[np.int64]) -> None:
    """Slabs of stone, four metres square, between the towers."""
    rows, columns = np.indices(districts.shape)
    joints = (rows % 8 == 0) | (columns % 8 == 0)
    colors[districts == District.TOWERS] = PLAZA
    colors[joints & (districts == District.TOWERS)] = JOINT


def _lay_out_parks(colors: NDArray[np.int64], districts: NDArray[np.int64]) -> None:
    """A pond in the middle of every park, a path around it, and paths to the corners."""
    north, east = _from_block_middle()
    park = districts == District.PARK
    around = 9 * north * north + 4 * east * east
    diagonal = np.abs(np.abs(north) - np.abs(east)) < 7
    colors[park & (diagonal | (around < 9 * 62 * 62))] = GRAVEL
    colors[park & (around < 9 * 54 * 54)] = GRASS
    colors[park & (around < 9 * 44 * 44)] = QUAY
    colors[park & (around < 9 * 40 * 40)] = WATER


def _flood_river(colors: NDArray[np.int64], districts: NDArray[np.int64], seed: int) -> None:
    """The river between its quays, with a promenade on either side."""
    rows = np.arange(SIZE)[:, np.newaxis] + 0.5
    across = np.abs(rows - river_middle(seed))
    river = districts == District.RIVER
    promenade = (across >= RIVER_HALF_WIDTH + PROMENADE) & (across < RIVER_HALF_WIDTH + PROMENADE + 4)
    colors[river & promenade] = GRAVEL
    colors[river & (across < RIVER_HALF_WIDTH + QUAY_WIDTH)] = QUAY
    depth = np.minimum(np.floor((RIVER_HALF_WIDTH - across) / 3), 5).astype(np.int64)
    water = river & (across < RIVER_HALF_WIDTH)
    colors[water] = WATER - 3 * depth[water][:, np.newaxis]


def _lay_streets(colors: NDArray[np.int64], growing: NDArray[np.bool_]) -> None:
    """Pavements, then carriageways over them: over the river, too, where they are bridges."""
    along = streets()
    paved = along.pavement | along.carriageway
    pavement = paved[:, np.newaxis] | paved
    rows, columns = np.indices(pavement.shape)
    colors[pavement] = PAVING
    colors[pavement & ((rows % 4 == 0) | (columns % 4 == 0))] = PAVING - 10
    colors[along.carriageway[:, np.newaxis] | along.carriageway] = ASPHALT
    growing[pavement] = False


def _mark_lanes(colors: NDArray[np.int64]) -> None:
    """Lane marks of the streets along both axes."""
    _mark_lanes_northwards(colors)
    _mark_lanes_northwards(colors.swapaxes(0, 1))


def _mark_lanes_northwards(colors: NDArray[np.int64]) -> None:
    """Broken white lines, the avenues' yellow middle line, and zebra crossings, of the streets along axis 0."""
    along = streets()
    to_crossing = (along.distance - along.road)[:, np.newaxis]
    dashed = (np.arange(SIZE) % 12 < 6)[:, np.newaxis]
    middle = along.distance == 0
    open_road = to_crossing >= 9
    colors[open_road & dashed & (middle & ~along.avenue)] = LANE_WHITE
    colors[open_road & dashed & (along.avenue & (along.distance == 5))] = LANE_WHITE
    colors[open_road & (middle & along.avenue)] = LANE_YELLOW
    stripe = along.carriageway & (along.distance // 2 % 2 == 0)
    colors[(to_crossing >= 1) & (to_crossing < 6) & stripe] = LANE_WHITE


def _dig_foundations(colors: NDArray[np.int64], growing: NDArray[np.bool_], wings: NDArray[np.int64]) -> None:
    """A plinth one texel wide around every wing, of plaster around a house: walls below the steep threshold smear it.

    Trees keep three texels away from the walls.
    """
    for row in wings.tolist():
        wing = Wing(*row)
        plinth = PLASTER if wing.height < 3 * FLOOR else FOUNDATION
        colors[wing.south - 1 : wing.north + 1, wing.west - 1 : wing.east + 1] = plinth
        growing[wing.south - 3 : wing.north + 3, wing.west - 3 : wing.east + 3] = False

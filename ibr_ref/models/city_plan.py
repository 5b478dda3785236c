"""The plan of the city: what kind of quarter each block is, where its river runs, and every building on its lots.

Rows count northwards and columns eastwards, as the maps' texels do (row 0 is v = 0). One texel is half a metre.
Streets run along all multiples of `BLOCK`; the lots of a block keep clear of them: three by three, each four facade
bays wide, so that no wall cuts a strip of the facade map.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.scene.checks import whole

SEED_LIMIT = 2**32 - 1
SIZE = 1024
"""Texels along each side of the city."""

BLOCK = 128
BLOCKS = SIZE // BLOCK
LOT = 32
LOTS_BEGIN = 16
"""Texels from the middle of a street to the first lot: no street with its pavements is wider."""

BAY = 8
METRE = 1024
"""Height steps (of 1/65535) a metre: the volume is 64 m high."""

FLOOR = 4 * METRE


class District(IntEnum):
    """What a block is used for."""

    RIVER = 0
    PARK = 1
    HOUSES = 2
    TERRACES = 3
    SLABS = 4
    TOWERS = 5


class Roof(IntEnum):
    """The form of a wing's roof."""

    FLAT = 0
    HIP = 1


class Wing(NamedTuple):
    """A rectangular part of a building: half-open ranges of texels, height of the eaves in steps of 1/65535.

    `tint` numbers the roof's colour; all wings of a building have the same.
    """

    building: int
    west: int
    south: int
    east: int
    north: int
    height: int
    roof: int
    tint: int


class Parcel(NamedTuple):
    """Rectangles (west, south, east, north) in texels that one building stands on, and the lots among them."""

    rectangles: list[tuple[int, int, int, int]]
    lots: list[tuple[int, int, int, int]]


# Nine lots seen from above; lots of one letter belong to one building, a dot is open ground.
TEMPLATES = {
    District.HOUSES: ("ABC DEF GHI", "ABC D.E FGH", "AB. CDE .FG", "ABC DEF G.H"),
    District.TERRACES: ("AAB C.B CDD", "AAB A.C DCC", "ABC D.E FGH", "AAA B.C BDD", "ABB C.D EED"),
    District.SLABS: ("AAA ... BBC", "A.B A.B C.B", "AAA AAA BBC", "AAA A.. A.B", "AB. A.. CCC"),
    District.TOWERS: ("AAB AA. C.D", "AAA ... BBC", "AA. AAB CC.", "ABB .BB CC.", "A.B A.. ACC"),
}


def districts(seed: int) -> NDArray[np.int64]:
    """The `District` of every block (8, 8): towers around a centre, a river through one row, parks here and there."""
    random = np.random.RandomState([seed, 0])
    river_row = random.randint(3, 5)
    centre_row = river_row - 2 if random.randint(2) else river_row + 2
    centre_column = random.randint(2, 6)
    rows, columns = np.indices((BLOCKS, BLOCKS))
    rows, columns = rows - centre_row, columns - centre_column
    distance = rows * rows + columns * columns + random.randint(0, 3, rows.shape)
    middle = np.where(random.randint(0, 3, rows.shape) > 0, District.TERRACES, District.SLABS)
    outer = np.where(random.randint(0, 4, rows.shape) > 0, District.HOUSES, middle)
    plan = np.select([distance < 4, distance < 13], [np.full_like(rows, District.TOWERS), middle], outer)
    plan[river_row] = District.RIVER
    candidates = np.flatnonzero((plan != District.RIVER) & (plan != District.TOWERS))
    plan.flat[random.permutation(candidates)[:4]] = District.PARK
    return plan


def river_middle(seed: int) -> NDArray[np.float64]:
    """Row (1024,) of the river's middle in every column, a float: it winds between its banks, level at each bridge."""
    random = np.random.RandomState([seed, 1])
    bends = random.randint(-14, 15, BLOCKS + 1).astype(np.float64)
    columns = np.arange(SIZE)
    bridge, along = columns // BLOCK, (columns % BLOCK + 0.5) / BLOCK
    blend = along * along * (3 - 2 * along)
    river_row = int(np.flatnonzero((districts(seed) == District.RIVER).all(axis=1))[0])
    return (river_row + 0.5) * BLOCK + bends[bridge] * (1 - blend) + bends[bridge + 1] * blend


def buildings(seed: int = 0) -> NDArray[np.int64]:
    """All wings of all buildings of the city, (wings, 8) int64, columns as in `Wing`; the maps are drawn from them.

    Column 0 numbers the buildings from 0: their count is its maximum + 1. Wings of one building may overlap, those of
    two never do, and none touches a street. Lower wings come before those that stand on them.
    ValueError for a seed that is not a whole number in [0, 2^32).
    """
    seed = whole("seed", seed, low=0, high=SEED_LIMIT)
    random = np.random.RandomState([seed, 2])
    wings: list[Wing] = []
    count = 0
    plan = districts(seed)
    for row, column in np.ndindex(plan.shape):
        district = District(int(plan[row, column]))
        for parcel in _parcels(district, row, column, random):
            wings += _raise_building(count, district, parcel, random)
            count += 1
    return np.array(wings, dtype=np.int64)


def _parcels(district: District, row: int, column: int, random: np.random.RandomState) -> list[Parcel]:
    """The parcels of one block: a template of its district, turned by a random number of quarters."""
    templates = TEMPLATES.get(district)
    if templates is None:
        return []
    template = templates[random.randint(len(templates))]
    letters = np.rot90(np.array([list(lots) for lots in template.split()]), random.randint(4))
    south, west = row * BLOCK + LOTS_BEGIN, column * BLOCK + LOTS_BEGIN
    names = sorted(set(template) - set(" ."))
    return [_parcel(letters == name, west, south) for name in names]


def _parcel(lots: NDArray[np.bool_], west: int, south: int) -> Parcel:
    """Rectangles and lots of one parcel, from its mask of lots (3, 3)."""
    rows, columns = np.nonzero(lots)
    bounds = (int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1)
    is_rectangle = lots[bounds[1] : bounds[3], bounds[0] : bounds[2]].all()
    rectangles = [bounds] if is_rectangle else _runs(lots) + [(y, x, v, u) for x, y, u, v in _runs(lots.T)]
    singles = [(x, y, x + 1, y + 1) for y, x in zip(rows.tolist(), columns.tolist(), strict=True)]
    return Parcel(_in_texels(rectangles, west, south), _in_texels(singles, west, south))


def _runs(lots: NDArray[np.bool_]) -> list[tuple[int, int, int, int]]:
    """Rectangles (west, south, east, north) one lot high over the rows that hold two or three lots side by side."""
    runs = []
    for row, line in enumerate(lots):
        columns = np.flatnonzero(line).tolist()
        if len(columns) > 1 and columns[-1] - columns[0] == len(columns) - 1:
            runs.append((columns[0], row, columns[-1] + 1, row + 1))
    return runs


def _in_texels(rectangles: list[tuple[int, int, int, int]], west: int, south: int) -> list[tuple[int, int, int, int]]:
    """Rectangles of lots in texels of the map."""
    return [(west + LOT * x, south + LOT * y, west + LOT * u, south + LOT * v) for x, y, u, v in rectangles]


def _raise_building(number: int, district: District, parcel: Parcel, random: np.random.RandomState) -> list[Wing]:
    """The wings of the building on a parcel."""
    if district == District.HOUSES:
        return _house(number, parcel, random)
    if district == District.TERRACES:
        return _terrace(number, parcel, random)
    if district == District.SLABS:
        return _slab(number, parcel, random)
    return _tower(number, parcel, random)


def _house(number: int, parcel: Parcel, random: np.random.RandomState) -> list[Wing]:
    """A house of two or three bays by two or three, somewhere on its lot, under a hipped roof."""
    west, south, _, _ = parcel.lots[0]
    width, depth = (BAY * random.randint(2, 4, 2)).tolist()
    west += random.randint(2, LOT - width - 1)
    south += random.randint(2, LOT - depth - 1)
    height = random.randint(70, 105) * METRE // 10
    return [Wing(number, west, south, west + width, south + depth, height, Roof.HIP, random.randint(4))]


def _terrace(number: int, parcel: Parcel, random: np.random.RandomState) -> list[Wing]:
    """Houses wall to wall around a court: three to five floors, all wings alike, mostly under hipped roofs."""
    height = _storeys(random.randint(3, 6))
    roof = Roof.HIP if random.randint(4) else Roof.FLAT
    tint = random.randint(4)
    if roof == Roof.FLAT:
        return [Wing(number, *lot, height, roof, tint) for lot in parcel.lots]
    return [Wing(number, *rectangle, height, roof, tint) for rectangle in parcel.rectangles]


def _slab(number: int, parcel: Parcel, random: np.random.RandomState) -> list[Wing]:
    """A flat-roofed block of four to eight floors; a wing at an angle is lower or higher."""
    tint = random.randint(6)
    floors = random.randint(4, 8)
    wings = []
    for index, rectangle in enumerate(parcel.rectangles):
        wings.append(Wing(number, *rectangle, _storeys(floors + index), Roof.FLAT, tint))
    return wings


def _tower(number: int, parcel: Parcel, random: np.random.RandomState) -> list[Wing]:
    """A podium over the whole parcel, a tower on one of its lots, and often a crown set back by one bay."""
    tint = random.randint(6)
    podium = _storeys(random.randint(2, 5))
    wings = [Wing(number, *rectangle, podium, Roof.FLAT, tint) for rectangle in parcel.rectangles]
    west, south, east, north = parcel.lots[random.randint(len(parcel.lots))]
    floors = random.randint(7, 13)
    wings.append(Wing(number, west, south, east, north, _storeys(floors), Roof.FLAT, tint))
    if random.randint(3):
        crown = _storeys(floors + random.randint(2, 4))
        wings.append(Wing(number, west + BAY, south + BAY, east - BAY, north - BAY, crown, Roof.FLAT, tint))
    return wings


def _storeys(floors: int) -> int:
    """Height of so many floors, with a ledge of a quarter of a metre above them."""
    return floors * FLOOR + METRE // 4

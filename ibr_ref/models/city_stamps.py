"""What stands on the city's ground, drawn as stamps: wherever a stamp rises above what is there, it takes its place."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.models.city_ground import AVENUE_ROAD, Ground, streets
from ibr_ref.models.city_plan import BLOCK, METRE, SIZE, Roof, Wing

FLAT_ROOFS = np.array(
    [(178, 174, 166), (150, 146, 142), (116, 116, 120), (196, 188, 172), (126, 152, 104), (138, 162, 152)]
)
HIP_ROOFS = np.array([(168, 82, 58), (146, 70, 54), (98, 104, 118), (126, 88, 66)])
COPING = np.array((214, 208, 196))
EAVES = np.array((206, 194, 174))
MACHINE = np.array((204, 206, 208))
MACHINE_TOP = np.array((152, 156, 160))
SKYLIGHT = np.array((120, 156, 178))
CARS = np.array([(196, 44, 40), (236, 236, 232), (40, 44, 52), (60, 96, 160), (150, 154, 160), (214, 170, 52)])
WINDSCREEN = np.array((36, 44, 54))
FOLIAGE = np.array([(62, 104, 46), (78, 120, 52), (52, 90, 50), (112, 132, 56)])

PARAPET = METRE * 3 // 5
RISE = METRE // 4
"""How much a hipped roof rises in one texel (half a metre)."""

HIP_LIMIT = 5 * METRE
TREE = 6 * METRE
"""Height of the tallest trees, 0.094: below the default steep threshold, or they would be given windows."""


class Canvas(NamedTuple):
    """Heights (1024, 1024) in steps of 1/65535 and colours (1024, 1024, 3) in 0 … 255; drawn on in place."""

    heights: NDArray[np.int64]
    colors: NDArray[np.int64]


def raise_city(seed: int, ground: Ground, wings: NDArray[np.int64]) -> Canvas:
    """The whole city over its ground: trees, cars, buildings."""
    canvas = Canvas(np.zeros((SIZE, SIZE), dtype=np.int64), ground.colors)
    _plant_avenues(canvas, np.random.RandomState([seed, 3]))
    _plant_lawns(canvas, ground.growing, np.random.RandomState([seed, 4]))
    _park_cars(canvas, np.random.RandomState([seed, 5]))
    _park_cars(Canvas(canvas.heights.T, canvas.colors.swapaxes(0, 1)), np.random.RandomState([seed, 6]))
    random = np.random.RandomState([seed, 7])
    for row in wings.tolist():
        _raise_wing(canvas, Wing(*row), random)
    return canvas


def _stamp(canvas: Canvas, west: int, south: int, heights: NDArray[np.int64], colors: NDArray[np.int64]) -> None:
    """Draw heights (h, w) and colours (h, w, 3) where they rise above the canvas, cut at its border."""
    depth, width = heights.shape
    rows = slice(max(0, -south), min(depth, SIZE - south))
    columns = slice(max(0, -west), min(width, SIZE - west))
    target = (slice(south + rows.start, south + rows.stop), slice(west + columns.start, west + columns.stop))
    heights, colors = heights[rows, columns], colors[rows, columns]
    rises = heights > canvas.heights[target]
    canvas.heights[target][rises] = heights[rises]
    canvas.colors[target][rises] = colors[rises]


def _raise_wing(canvas: Canvas, wing: Wing, random: np.random.RandomState) -> None:
    """One wing with its roof; machines and skylights on a flat one."""
    if wing.roof == Roof.HIP:
        _stamp(canvas, wing.west, wing.south, *_hip_roof(wing))
        return
    _stamp(canvas, wing.west, wing.south, *_flat_roof(wing))
    area = (wing.east - wing.west) * (wing.north - wing.south)
    for _ in range(random.randint(1, 3 + area // 400)):
        _install_machine(canvas, wing, random)


def _from_edge(wing: Wing) -> NDArray[np.int64]:
    """Whole texels between each texel of a wing and its nearest edge, (rows, columns)."""
    rows, columns = np.indices((wing.north - wing.south, wing.east - wing.west))
    to_south_or_north = np.minimum(rows, len(rows) - 1 - rows)
    to_west_or_east = np.minimum(columns, columns.shape[1] - 1 - columns)
    from_edge: NDArray[np.int64] = np.minimum(to_south_or_north, to_west_or_east)
    return from_edge


def _flat_roof(wing: Wing) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Heights and colours of a flat roof inside a parapet one texel wide."""
    from_edge = _from_edge(wing)
    on_edge = from_edge == 0
    heights = np.where(on_edge, wing.height + PARAPET, wing.height)
    field = FLAT_ROOFS[wing.tint % len(FLAT_ROOFS)]
    colors = np.where((from_edge == 3)[..., np.newaxis], field - 16, field)
    return heights, np.where(on_edge[..., np.newaxis], COPING, colors)


def _hip_roof(wing: Wing) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Heights and colours of a roof that rises from all four eaves, in rows of tiles, to a ridge or a flat top."""
    from_edge = _from_edge(wing)
    heights = wing.height + np.minimum(from_edge * RISE, HIP_LIMIT)
    field = HIP_ROOFS[wing.tint % len(HIP_ROOFS)] + 2 * np.minimum(from_edge, 8)[..., np.newaxis]
    colors = np.where((from_edge % 3 == 0)[..., np.newaxis], field - 14, field)
    return heights, np.where((from_edge == 0)[..., np.newaxis], EAVES, colors)


def _install_machine(canvas: Canvas, wing: Wing, random: np.random.RandomState) -> None:
    """An air conditioner, a lift's head, or a flat skylight, anywhere on the roof clear of the parapet."""
    width, depth = random.randint(4, 9, 2).tolist()
    west = wing.west + random.randint(3, wing.east - wing.west - width - 2)
    south = wing.south + random.randint(3, wing.north - wing.south - depth - 2)
    skylight = random.randint(3) == 0
    height = wing.height + (METRE // 3 if skylight else random.randint(4, 8) * METRE // 2)
    colors = np.full((depth, width, 3), COPING if skylight else MACHINE)
    colors[1:-1, 1:-1] = SKYLIGHT if skylight else MACHINE_TOP
    _stamp(canvas, west, south, np.full((depth, width), height), colors)


def _plant_lawns(canvas: Canvas, growing: NDArray[np.bool_], random: np.random.RandomState) -> None:
    """Trees at random places where they may grow."""
    places = random.randint(0, SIZE, (5200, 2))
    for row, column in places[growing[places[:, 0], places[:, 1]]].tolist():
        _plant_tree(canvas, row, column, random.randint(4, 8), random)


def _plant_avenues(canvas: Canvas, random: np.random.RandomState) -> None:
    """Rows of small trees on the pavements of the avenues, none at the crossings."""
    places = [place for place in range(0, SIZE, 16) if 28 < place % BLOCK < BLOCK - 28]
    sides = [middle + side for middle in range(0, SIZE + 1, 2 * BLOCK) for side in (-AVENUE_ROAD - 3, AVENUE_ROAD + 2)]
    for side in sides[1:-1]:
        for place in places:
            _plant_tree(canvas, place, side, 3, random)
            _plant_tree(canvas, side, place, 3, random)


def _plant_tree(canvas: Canvas, row: int, column: int, radius: int, random: np.random.RandomState) -> None:
    """A round crown, lighter towards its top."""
    offsets = np.arange(-radius, radius + 1)
    squared = offsets[:, np.newaxis] * offsets[:, np.newaxis] + offsets * offsets
    limit = radius * radius + 1
    top = TREE * random.randint(70, 101) * (radius + 5) // 1200
    heights = np.where(squared < limit, top - 3 * top * squared // (4 * limit), 0)
    leaves = FOLIAGE[random.randint(len(FOLIAGE))]
    light = 24 - 44 * squared // limit + random.randint(-8, 9, squared.shape, dtype=np.int64)
    colors = leaves + light[..., np.newaxis]
    _stamp(canvas, column - radius, row - radius, heights, colors)


def _park_cars(canvas: Canvas, random: np.random.RandomState) -> None:
    """Cars on the lanes of the streets along axis 0; none near a crossing."""
    along = streets()
    for middle in range(BLOCK, SIZE, BLOCK):
        lanes = (-9, -4, 1, 6) if along.avenue[middle] else (-5, 1)
        for place in range(0, SIZE, 14):
            lane = lanes[random.randint(len(lanes))]
            if random.randint(5) < 2 and 26 < place % BLOCK < BLOCK - 34:
                _park_car(canvas, middle + lane, place, random)


def _park_car(canvas: Canvas, west: int, south: int, random: np.random.RandomState) -> None:
    """A car four by nine texels: bonnet, cabin and boot."""
    body = np.array([METRE] * 3 + [METRE * 8 // 5] * 4 + [METRE] * 2)
    colors = np.full((9, 4, 3), CARS[random.randint(len(CARS))])
    colors[[2, 7]] = WINDSCREEN
    _stamp(canvas, west, south, np.repeat(body[:, np.newaxis], 4, axis=1), colors)

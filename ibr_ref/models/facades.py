"""Facade maps: the tiles that the method lays on steep walls. Row 0 is the top; the bottom row stands on the ground."""

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.int64]
"""One integer, or three for a colour in 0 … 255, for every pixel of a tile; the fronts are painted in place."""

FLOOR_PIXELS = 16
FLOORS = 16
BAYS = 16
STRIP_BAYS = 4
STRIP_PHASE = 2
"""A strip of one style is four bays wide and begins at bay 2, 6, 10 or 14: the grid of the city's lots."""

STRIP_WALLS = np.array([(190, 172, 146), (162, 104, 84), (208, 192, 162), (176, 180, 184)])
GLASS = np.array((58, 78, 102))
CURTAIN = np.array((186, 178, 160))
LAMPLIGHT = np.array((246, 214, 142))
AWNINGS = np.array([(168, 52, 46), (44, 96, 74), (206, 160, 60), (50, 78, 130)])

BRICK = np.array((150, 74, 56))
MORTAR = np.array((196, 186, 172))
FRAME = np.array((232, 230, 222))


def brick_facade() -> NDArray[np.float64]:
    """A brick wall with one window, (64, 64, 3) in [0, 1], for the box: eight courses, tileable both ways."""
    rows, columns = np.indices((64, 64))
    course = rows // 8
    shifted = columns + 8 * (course % 2)
    in_joint = (rows % 8 == 7) | (shifted % 16 == 15)
    wall: Image = np.where(in_joint[..., np.newaxis], MORTAR, _bricks(course, shifted // 16 % 4))
    _fill(wall, _rectangle(columns, rows, (18, 46), (12, 50)), FRAME)
    panes = _rectangle(columns, rows, (21, 31), (15, 47)) | _rectangle(columns, rows, (33, 43), (15, 47))
    _fill(wall, panes, GLASS + (47 - rows[panes])[:, np.newaxis])
    _fill(wall, _rectangle(columns, rows, (16, 48), (50, 54)), MORTAR)
    facade: NDArray[np.float64] = wall / 255
    return facade


def _bricks(course: Image, brick: Image) -> Image:
    """Colours (…, 3) of the bricks: no two neighbours alike, the same at every repetition of the tile."""
    tone = (course * 5 + brick * 3) % 7 * 5 - 15
    colors: Image = BRICK + tone[..., np.newaxis]
    return colors


def street_facade() -> NDArray[np.float64]:
    """The fronts of the city, (256, 256, 3) in [0, 1]: 16 bays wide, 16 floors high, shops on the ground floor.

    Strips of four bays differ in wall and windows; a city block repeats them in step with its lots.
    """
    rows, columns = np.indices((FLOORS * FLOOR_PIXELS, BAYS * FLOOR_PIXELS))
    up = len(rows) - 1 - rows
    floor, above = up // FLOOR_PIXELS, up % FLOOR_PIXELS
    bay, across = columns // FLOOR_PIXELS, columns % FLOOR_PIXELS
    strip = (bay + STRIP_PHASE) // STRIP_BAYS % len(STRIP_WALLS)
    front = STRIP_WALLS[strip]
    front[above == 0] -= 26
    front[above == 15] += 12
    _hang_windows(front, floor, bay, strip, across, above)
    _open_shops(front, floor, bay, across, above)
    facade: NDArray[np.float64] = np.clip(front, 0, 255) / 255
    return facade


def _hang_windows(front: Image, floor: Image, bay: Image, strip: Image, across: Image, above: Image) -> None:
    """The windows of every floor: single in brick, paired in sandstone, ribbons in concrete."""
    single = _rectangle(across, above, (3, 13), (3, 13))
    pair = _rectangle(across, above, (2, 7), (2, 13)) | _rectangle(across, above, (9, 14), (2, 13))
    ribbon = _rectangle(across, above, (0, 16), (4, 13))
    frames = np.choose(strip, [single, single, pair, ribbon])
    single_pane = _rectangle(across, above, (4, 12), (4, 12))
    pair_panes = _rectangle(across, above, (3, 6), (3, 12)) | _rectangle(across, above, (10, 13), (3, 12))
    ribbon_pane = _rectangle(across, above, (1, 15), (5, 12))
    panes = np.choose(strip, [single_pane, single_pane, pair_panes, ribbon_pane])
    _fill(front, frames, np.array((224, 222, 214)))
    _fill(front, panes, _window_colors(floor, bay, above)[panes])


def _window_colors(floor: Image, bay: Image, above: Image) -> Image:
    """Colours (…, 3) behind the panes: glass that reflects more sky higher up; some curtains, some lamps."""
    room = np.random.RandomState(16).randint(0, 100, (FLOORS, BAYS))[floor, bay, np.newaxis]
    glass = GLASS + (3 * above + 2 * floor)[..., np.newaxis]
    return np.where(room < 14, CURTAIN, np.where(room < 22, LAMPLIGHT, glass))


def _open_shops(front: Image, floor: Image, bay: Image, across: Image, above: Image) -> None:
    """The ground floor: shop windows between piers on a stone plinth, awnings in a colour for every second bay."""
    ground = floor == 0
    _fill(front, ground, np.where(above[ground] < 2, 150, 92)[:, np.newaxis] - np.array((0, 6, 14)))
    _fill(front, ground & _rectangle(across, above, (1, 15), (2, 11)), np.array((72, 82, 92)))
    awning = ground & _rectangle(across, above, (1, 15), (11, 14))
    stripes = np.where((across // 2 % 2 == 0)[..., np.newaxis], AWNINGS[bay // 2 % len(AWNINGS)], FRAME)
    _fill(front, awning, stripes[awning])


def _rectangle(across: Image, along: Image, columns: tuple[int, int], rows: tuple[int, int]) -> NDArray[np.bool_]:
    """Mask of the pixels in the half-open ranges of columns and rows."""
    return (columns[0] <= across) & (across < columns[1]) & (rows[0] <= along) & (along < rows[1])


def _fill(image: Image, mask: NDArray[np.bool_], color: Image) -> None:
    """Set the masked pixels of an image in place."""
    image[mask] = color

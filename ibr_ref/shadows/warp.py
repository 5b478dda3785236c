"""Stage warp: the map for a place of the object, between the nine prepared ones (section 3.2.2)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.pipeline import memory
from ibr_ref.shadows.draw import Image, draw
from ibr_ref.shadows.pace import cell_of, shares


class Nine(NamedTuple):
    """The nine maps."""

    texels: NDArray[np.generic]
    """(3, 3, S, S): bytes, or float64 where `levels` is None."""
    levels: Floats | None
    spans: NDArray[np.int32]
    """(3, 3, S, 2) where they may differ from `outside`."""
    controls: Floats
    """(3, 3, R, C, 2)."""
    outside: float
    """What is beside the caster: 0 or 1."""

    def image(self, j: int, i: int) -> Image:
        """The one at the positions' [j, i]."""
        return Image(self.texels[j, i].reshape(-1), self.levels, self.spans[j, i], self.controls[j, i])


class Warped(NamedTuple):
    """The arrays of the stage, for one place of the object."""

    cell: NDArray[np.int32]
    """(2,) cell of the 3 x 3 positions, x first."""
    fraction: Floats
    """(2,) s and t, the place within the cell."""
    shares: Floats
    """(3,) of the next map in the upper row and in the lower one, of the lower row: s, s, t, or the projective ones."""
    row_grids: Floats
    """(2, R, C, 2) lerps of G00 and G10, and of G01 and G11, by the first two shares."""
    rows: Floats
    """(2, S, S) top and bottom."""
    grid: Floats
    """(R, C, 2) lerp of the row grids by the third share."""
    image: Floats
    """(S, S)."""


def locate(positions: Floats, offset: Floats) -> tuple[NDArray[np.int32], Floats]:
    """The cell (2,) of the positions (3, 3, 2) that holds an offset, and the fractions in it; the upper cell on a line."""
    axes = positions[0, :, 0], positions[:, 0, 1]
    cell = np.array([int(o >= axis[1]) for axis, o in zip(axes, offset, strict=True)], np.int32)
    fraction = [(o - axis[i]) / (axis[i + 1] - axis[i]) for axis, o, i in zip(axes, offset, cell, strict=True)]
    return cell, np.array(fraction)


def between(first: Floats, second: Floats, share: float) -> Floats:
    """Two grids' lerp."""
    return first * (1.0 - share) + second * share


def shares_at(cell: NDArray[np.int32], fraction: Floats, depths: Floats | None) -> Floats:
    """The three shares of a place (`pace.shares`). depths (3, 3): the caster's in the nine maps; None: the even pace."""
    return shares(fraction, None if depths is None else cell_of(depths, *cell.tolist()))


def grids_at(controls: Floats, cell: NDArray[np.int32], three: Floats) -> tuple[Floats, Floats]:
    """The row grids (2, R, C, 2) and the grid (R, C, 2) of a place with these shares, from the controls (3, 3, R, C, 2)."""
    (i, j), (upper, lower, t) = cell.tolist(), three.tolist()
    rows = np.stack([between(controls[j + k, i], controls[j + k, i + 1], s) for k, s in enumerate((upper, lower))])
    return rows, between(rows[0], rows[1], t)


def warp_stage(nine: Nine, cell: NDArray[np.int32], fraction: Floats, depths: Floats | None, nearest: bool) -> Warped:
    """The map for a place within a cell. depths as in `shares_at`.

    nearest: each of the three warps takes the nearer image alone (section 3.2.2 speaks of three warps, as in bilinear
    interpolation); otherwise each mixes two, warped to one grid: six warps.
    """
    size = nine.texels.shape[2]
    (i, j), three = cell.tolist(), shares_at(cell, fraction, depths)
    row_grids, grid = grids_at(nine.controls, cell, three)
    s, t = three[:2].tolist(), float(three[2])
    rows, image = memory.arrays([(np.float64, (2, size, size)), (np.float64, (size, size))])
    pair = []
    for k in range(2):
        first, second = nine.image(j + k, i), nine.image(j + k, i + 1)
        drawn = _warp_pair(first, second, s[k], row_grids[k], nearest, nine.outside, rows[k])
        pair.append(Image(rows[k].reshape(-1), None, drawn, row_grids[k]))
    _warp_pair(pair[0], pair[1], t, grid, nearest, nine.outside, image)
    return Warped(cell, fraction, three, row_grids, rows, grid, image)


def _warp_pair(
    first: Image, second: Image, share: float, target: Floats, nearest: bool, outside: float, out: Floats
) -> NDArray[np.int32]:
    """Warp both and mix, or the nearer alone. Gives the spans of what is drawn."""
    if nearest:
        return draw(first if share < 0.5 else second, None, 0.0, target, outside, out)
    return draw(first, second, share, target, outside, out)

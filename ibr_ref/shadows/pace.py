"""How far along the way from one map to the next the caster's shadow has come, for a place of the object between them.

The paper takes the fraction of the way that the object has gone ("linear"). Under perspective a point at the depth w0 in
one map and w1 in the next has then gone s' = s w1 / ((1 - s) w0 + s w1) of its way in the maps ("projective"): exact for
what lies at the depth that is taken, the caster's centre's. Along x depths differ between the two rows of a cell, and so
do the shares; along y they are those between the ends of the two rows.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats


def share(fraction: float, w0: float, w1: float) -> float:
    """s' of a fraction s between depths w0 and w1 > 0: s itself where they are equal, but for rounding; 0 and 1 stay."""
    return fraction * w1 / ((1.0 - fraction) * w0 + fraction * w1)


def shares(fraction: Floats, around: Floats | None) -> Floats:
    """(3,) the next map's share in the upper row of a cell, in its lower row, and the lower row's share.

    fraction (2,): s and t; around (2, 2): depths at the cell's corners, [0, 1] the next along x; None: s, s, t.
    """
    s, t = fraction.tolist()
    if around is None:
        return np.array([s, s, t])
    (w00, w10), (w01, w11) = around.tolist()
    upper, lower = (1.0 - s) * w00 + s * w10, (1.0 - s) * w01 + s * w11
    return np.array([share(s, w00, w10), share(s, w01, w11), share(t, upper, lower)])


def cell_of(array: Floats, i: int, j: int) -> Floats:
    """(2, 2) the corners of cell (i, j), x first, of what is (3, 3)."""
    return array[j : j + 2, i : i + 2]


def weights(fractions: Floats, around: Floats | None) -> Floats:
    """(N, 4) how much of the maps 00, 10, 01, 11 is in the mix, for fractions (N, 2) in one cell."""
    s, t = fractions.T
    even = np.stack([(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t], axis=1)
    if around is None:
        return even
    weighed = even * around.reshape(4)
    total: Floats = weighed[:, 0] + weighed[:, 1] + weighed[:, 2] + weighed[:, 3]
    return np.asarray(weighed / total[:, None])

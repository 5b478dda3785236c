"""Heights in 16-bit steps that no lattice of the search meets.

The march compares the ray's height k / (N·2^M) with the height map. On a flat roof at such a height the comparison
ties over the whole roof and a rounding error decides it: two correct renderers may differ in every pixel of the roof.
The built-in models therefore keep their heights between the lattice points.
"""

import numpy as np
from numpy.typing import NDArray

HEIGHT_STEPS = 65535
"""Heights are whole multiples of 1 / HEIGHT_STEPS: a 16-bit height map holds them without loss."""

LATTICE = 38400
"""600·64: a multiple of N·2^M for M up to 6 and every N that divides 600 (10, 15, 20, 24, 25, 30, 40, 50, 100 …)."""


def clear_of_lattice(heights: NDArray[np.int64]) -> NDArray[np.int64]:
    """Heights (…) in steps of 1/65535, each raised by 0 to 3 steps until it is clear of the search's lattice.

    Clear is a distance of at least a quarter of 1 / `LATTICE` to every k / `LATTICE`: 6.5e-6, a hundred roundings of
    float32. The ground, 0, stays: the method treats it apart. Heights above 65532 may come out above 65535.
    """
    candidates = heights[..., np.newaxis] + np.arange(4)
    remainders = candidates * LATTICE % HEIGHT_STEPS
    clear = (4 * remainders >= HEIGHT_STEPS) & (4 * remainders <= 3 * HEIGHT_STEPS)
    # A step moves the remainder by 0.59 lattice steps, so one of four neighbours always is in the middle half.
    first_clear = np.argmax(clear, axis=-1)
    return np.where(heights > 0, heights + first_clear, 0)

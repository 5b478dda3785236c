"""What frames would cost if they did nothing but read texels: gathers made, times what one takes on this machine.

A gather is one texel of one channel read where arithmetic says, not side by side with the one before. The limit is
measured at the size of the scene's own map, on all threads: with coherent places, as neighbouring fragments read, each
thread a stretch of the map's rows.
"""

from __future__ import annotations

import time
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ibr_ref.displacement import Params, Scene

_ROUND = 2_000_000
"""Gathers of a measurement: some milliseconds."""
_BEST_OF = 7

FETCH = 4
"""Texels of a bilinear fetch."""
NORMAL, ALBEDO = 12, 12
"""Of a fragment's shading: the height map a texel to either side, four fetches that share texels; a fetch of colours."""


@cache
def per_second(texels: int) -> float:
    """Gathers a second from a map of so many float64 texels, row by row, the best of a few measurements."""
    texture = np.random.RandomState(0).uniform(0.0, 1.0, texels)
    indices, sums = np.linspace(0, texels - 1, _ROUND).astype(np.int32), np.empty(256)
    _gather(texture, indices, sums)
    best = np.inf
    for _ in range(_BEST_OF):
        start = time.perf_counter()
        _gather(texture, indices, sums)
        best = min(best, time.perf_counter() - start)
    return _ROUND / best


def _gather(texture: NDArray[np.float64], indices: NDArray[np.int32], sums: NDArray[np.float64]) -> None:
    from ibr_ref.bench.gather_kernel import gather_sums

    gather_sums(texture, indices, sums)


def of_displacement(scene: Scene, params: Params) -> int:
    """Texels that a frame of the protruded search asks for, fragment by fragment that is shown.

    Linear steps from the top of the volume to the stop, all of them that are below the highest height; M binary steps;
    normal and albedo. What the search leaps over is counted, what it reads for discarded fragments is not.
    """
    from ibr_ref import displacement

    frame = displacement.render(scene, params)
    hit, linear = frame.stages["march.hit_index"] >= 0, frame.stages["march.linear_index"]
    shown = int(hit.sum())
    steps = int(np.where(linear >= 0, linear + 1, params.linear_steps + 1)[hit].sum())
    halvings = params.binary_steps * int((hit & (linear > 0)).sum())
    return FETCH * (steps + halvings) + (NORMAL + ALBEDO) * shown


def beside(scene: Scene, params: Params, seconds: float) -> dict[str, Any]:
    """Columns of a bench: gathers made, milliseconds that they take at the limit, and the frame's time as a multiple."""
    made = of_displacement(scene, params)
    limit = per_second(max(np.asarray(polygon.height_map).size for polygon in scene.polygons))
    return {
        "gathers": made,
        "gathers_per_second": limit,
        "gathers_ms": 1e3 * made / limit,
        "beside_gathers": seconds * limit / made,
    }


def line(columns: dict[str, Any]) -> str:
    """The same in words."""
    return (
        f"{1e-6 * columns['gathers']:.1f} million gathers x {1e-6 * columns['gathers_per_second']:.0f} million a second = "
        f"{columns['gathers_ms']:.2f} ms; the frame takes {columns['beside_gathers']:.2f} of that"
    )

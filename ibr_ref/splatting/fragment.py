"""Stage resolve: the colour of each pixel's winner.

Points are lit in the vertex stage, as in the paper; here that is done for those alone that are seen, which gives the same
colours sooner.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.jit import device, kernel, prange
from ibr_ref.splatting.buffers import Lighting, Reference, View
from ibr_ref.splatting.vertex import vertex_color


@device
def _resolve_row(reference, normals, lighting, eye, first, winners, colors):
    count = len(reference.pixels)
    for column in range(len(winners)):
        i = winners[column] - first
        if 0 <= i < count:
            colors[column, 0], colors[column, 1], colors[column, 2] = vertex_color(
                reference, normals, lighting, eye, reference.pixels[i]
            )


@kernel
def _resolve(reference, normals, lighting, eye, first, splat, color):
    for row in prange(len(splat)):
        _resolve_row(reference, normals, lighting, eye, first, splat[row], color[row])


def resolve(
    reference: Reference,
    normals: NDArray[np.uint8],
    lighting: Lighting,
    view: View,
    first: int,
    splat: NDArray[np.int32],
    color: NDArray[np.float64],
) -> None:
    """Write the colours (H, W, 3) of the pixels whose winner (H, W) is a point of this image; `first` is its first one."""
    _resolve(reference, normals, lighting, view.eye, first, splat, color)

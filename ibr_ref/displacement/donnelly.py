"""Distance functions (Donnelly 2005): sphere tracing through a 3D texture of distances to the surface.

The texture's space is (u, v, d), each from 0 to 1, scaled alike. A voxel is solid if the surface reaches into it; any other
holds the distance from its centre to that of the nearest solid one (SciPy's Euclidean distance transform), so that positions
end within about a voxel of the surface. From C a fixed number of steps goes along the unit ray, each as far as the texture,
fetched trilinearly, says; where the last one ends is the hit, whether or not the surface is there.

Arrays: points (3, P), eye (4,), found and fetches (P,), one a point, as in `sought.Sought`; texels, of distances,
(layers * rows * columns,).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices, Whole, Wrap
from ibr_ref.displacement.below import keep, view_ray
from ibr_ref.displacement.buffers import Hits
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.sampling import clamped, footprint, lerp


def distance_texture(heights: NDArray[np.float64], layers: int, repeat: bool) -> NDArray[np.float64]:
    """Distances (layers, H, W) in units of the texture's space, from the top down; 0 in solid voxels."""
    from scipy.ndimage import distance_transform_edt

    rows, columns = heights.shape
    # The nearest of all copies of a repeated voxel is never farther than half a period along u or v.
    pad = (rows - rows // 2, columns - columns // 2) if repeat else (0, 0)
    padded = np.pad(heights, [(pad[0],) * 2, (pad[1],) * 2], mode="wrap") if repeat else heights
    bottoms = (np.arange(layers) + 1.0) / layers
    solid = bottoms[:, None, None] >= 1.0 - padded
    distances: NDArray[np.float64] = distance_transform_edt(~solid, sampling=(1.0 / layers, 1.0 / rows, 1.0 / columns))
    return np.ascontiguousarray(distances[:, pad[0] : pad[0] + rows, pad[1] : pad[1] + columns])


@device
def _layer(
    texels: Floats, offset: int, i00: np.uint32, i10: np.uint32, i01: np.uint32, i11: np.uint32, fx: float, fy: float
) -> float:
    """The bilinear mix of four texels of the layer that begins at `offset`."""
    top = lerp(texels[offset + i00], texels[offset + i10], fx)
    bottom = lerp(texels[offset + i01], texels[offset + i11], fx)
    return lerp(top, bottom, fy)


@device
def fetch_distance(
    texels: Floats, columns: float, rows: float, layers: int, repeat: Wrap, u: float, v: float, d: float
) -> float:
    """Trilinear fetch; clamped in d."""
    i00, i10, i01, i11, fx, fy = footprint(u, v, columns, rows, repeat)
    z = clamped(d * layers - 0.5, 0.0, layers - 1.0)
    upper = np.floor(z)
    lower = min(upper + 1.0, layers - 1.0)
    area: Whole = np.int64(columns) * np.int64(rows)
    return lerp(
        _layer(texels, np.int64(upper) * area, i00, i10, i01, i11, fx, fy),
        _layer(texels, np.int64(lower) * area, i00, i10, i01, i11, fx, fy),
        z - upper,
    )


@device
def _trace(
    repeat: Wrap, points: Floats, i: int, eye: Floats, texels: Floats, columns: float, rows: float, layers: int,
    steps: int, found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """The hit of a point."""
    u, v, along_u, along_v, seen = view_ray(points, i, eye)
    if not seen:
        return
    d = 0.0
    length = np.sqrt(along_u * along_u + along_v * along_v + 1.0)
    for _ in range(steps):
        d += fetch_distance(texels, columns, rows, layers, repeat, u - along_u * d, v - along_v * d, d) / length
    d = min(d, 1.0)
    fetches[i] = steps
    keep(found, i, steps, u - along_u * d, v - along_v * d, d, repeat is None)


@kernel
def donnelly_search(
    repeat: Wrap, points: Floats, eye: Floats, texels: Floats, columns: float, rows: float, layers: int, steps: int,
    found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """Hits of all points. steps: N."""
    for i in prange(len(fetches)):
        _trace(repeat, points, i, eye, texels, columns, rows, layers, steps, found, fetches)


def search(s: Sought) -> None:
    """Hits of a polygon."""
    layers, repeat = s.params.distance_layers, s.repeat is not None
    texels = s.prepared(("distances", layers), lambda: distance_texture(s.heights, layers, repeat)).reshape(-1)
    donnelly_search(
        s.repeat, s.points, s.constants.eye, texels, s.height.columns, s.height.rows, layers, s.params.linear_steps,
        *s.found,
    )  # fmt: skip

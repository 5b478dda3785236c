"""The passes of splatting, in order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import Frame
from ibr_ref.pipeline.points import Splats, Target, draw_splats, target_for
from ibr_ref.scene import Light
from ibr_ref.splatting import atlas
from ibr_ref.splatting.buffers import Law, Lighting, Vertices, View, vertices_for
from ibr_ref.splatting.fragment import resolve
from ibr_ref.splatting.inputs import Params, Scene
from ibr_ref.splatting.references import Prepared, prepare, view_of
from ibr_ref.splatting.vertex import color_vertices, place

BLOCK_POINTS = 1 << 17
"""Points that are placed and drawn at a time, about: their arrays stay in the cache, and memory does not grow with them."""

_BLOCK_ROWS = 4096


def render(scene: Scene, params: Params | None = None, *, stages: bool = True) -> Frame:
    """Draw reference images with depth as splats.

    With `stages` the frame holds every intermediate array (`splatting.__doc__` lists them); without, the same picture
    and depth sooner, and in memory that does not grow with the number of points. Raises ValueError for an atlas that does
    not fit, and for a law whose denominator is not positive for a point in view.
    """
    params = Params() if params is None else params
    references = [prepare(image) for image in scene.images]
    rects = atlas.pack([reference.size for reference in references], params.max_atlas_size)
    view, law, lighting = view_of(scene.camera), _law(params), _lighting(scene.light)
    target = target_for(scene.camera.width, scene.camera.height, stages)
    starts = np.cumsum([0] + [reference.points for reference in references]).tolist()
    vertices = vertices_for(starts[-1]) if stages else None
    for i, reference in enumerate(references):
        for first_row, last_row in _blocks(reference):
            base = starts[i] + int(reference.reference.row_starts[first_row])
            count = starts[i] + int(reference.reference.row_starts[last_row]) - base
            block = vertices_for(count) if vertices is None else Vertices(*(a[base : base + count] for a in vertices))
            if not place(reference.reference, view, law, first_row, last_row, block):
                raise ValueError(_unsound(params, i, first_row, last_row))
            draw_splats(Splats(*block), params.shape == "disc", base, target)
    color = np.empty((*target.splat.shape, 3))
    color[:] = scene.background
    for first, reference in zip(starts, references, strict=False):
        resolve(reference.reference, _normals(reference, lighting), lighting, view, first, target.splat, color)
    frame = Frame(color=color, depth=target.depth, stages={})
    if vertices is not None:
        frame.stages.update(_atlas_stages(references, rects))
        frame.stages.update(_vertex_stages(references, starts, vertices, lighting, view))
        frame.stages.update(_raster_stages(target))
    return frame


def _law(params: Params) -> Law:
    return Law(params.alpha, params.beta, params.gamma, params.delta, params.min_width, params.max_width)


def _lighting(light: Light | None) -> Lighting:
    if light is None:
        return Lighting(False, np.zeros(4), np.zeros(3), 0)
    phong = np.array([light.ambient, light.diffuse, light.specular])
    return Lighting(True, light.homogeneous, phong, light.exponent)


def _normals(reference: Prepared, lighting: Lighting) -> NDArray[np.uint8]:
    """The 8-bit normals where there is a light to see them by."""
    return reference.normals if lighting.lit else np.empty((0, 3), np.uint8)


def _blocks(reference: Prepared) -> Iterator[tuple[int, int]]:
    """Ranges of image rows with about BLOCK_POINTS points each."""
    row_starts, row = reference.reference.row_starts, 0
    while row < len(row_starts) - 1:
        stop = int(np.searchsorted(row_starts, row_starts[row] + BLOCK_POINTS, side="right")) - 1
        stop = min(max(stop, row + 1), row + _BLOCK_ROWS)
        if row_starts[stop] > row_starts[row]:
            yield row, stop
        row = stop


def _unsound(params: Params, image: int, first_row: int, last_row: int) -> str:
    law = f"{params.beta:g} d^2 + {params.gamma:g} d + {params.delta:g}"
    return (
        f"beta, gamma, delta: found {law}, not positive for a point in view (images[{image}], rows {first_row} to "
        f"{last_row - 1}), allowed: a law whose denominator is > 0 for every point in view"
    )


def _atlas_stages(references: Sequence[Prepared], rects: NDArray[np.int32]) -> dict[str, Any]:
    def pages(maps: Sequence[NDArray[np.generic]]) -> tuple[NDArray[np.generic], ...]:
        sizes = [reference.size for reference in references]
        return atlas.fill(rects, [m.reshape(h, w, *m.shape[1:]) for m, (w, h) in zip(maps, sizes, strict=True)])

    return {
        "atlas.rects": rects,
        "atlas.color": pages([_masked_color(reference) for reference in references]),
        "atlas.depth": pages([reference.reference.depth for reference in references]),
        "atlas.normal": pages([reference.normals for reference in references]),
    }


def _masked_color(reference: Prepared) -> NDArray[np.float64]:
    """The colours, 0 off the mask."""
    color, pixels = reference.reference.color, reference.reference.pixels
    if len(pixels) == len(color):
        return color
    masked = np.zeros_like(color)
    masked[pixels] = color[pixels]
    return masked


def _vertex_stages(
    references: Sequence[Prepared], starts: Sequence[int], vertices: Vertices, lighting: Lighting, view: View
) -> dict[str, Any]:
    colors, source = np.empty((starts[-1], 3)), np.empty((starts[-1], 3), np.int32)
    for i, reference in enumerate(references):
        part = slice(starts[i], starts[i + 1])
        color_vertices(reference.reference, _normals(reference, lighting), lighting, view, colors[part])
        source[part, 0] = i
        np.divmod(reference.reference.pixels, reference.reference.columns, out=(source[part, 1], source[part, 2]))
    return {
        "vertex.window": vertices.window,
        "vertex.depth": vertices.depth,
        "vertex.width": vertices.width,
        "vertex.color": colors,
        "vertex.source": source,
    }


def _raster_stages(target: Target) -> dict[str, Any]:
    return {
        "raster.splat": target.splat,
        "raster.depth": target.depth.copy(),
        "raster.overdraw": target.overdraw,
        "raster.margin": np.where(target.overdraw >= 2, target.second - target.depth, np.inf),
    }
